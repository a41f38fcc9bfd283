"""Vehicles that drive across the ego's way without giving way, and the lights of their junction."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, cast

from basu.errors import ScenarioError
from basu.routing import ControlKind
from basu.scenarios.actions import DriveAlong, Either, InTurn, ReachAtEgosArrival, SetLight, Together
from basu.scenarios.criteria import Arrives, InTime, NoCollision
from basu.scenarios.library.road_users import BLUEPRINTS, SETS_OFF_MPS2, run_up_m
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import crossing
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoPasses, TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.paths import Crossing
    from basu.scenarios.paths.crossings import Side
    from basu.scenarios.paths.lanes import Turn
    from basu.scenarios.place import Place


LIGHT = "1000001"  # the OpenDRIVE type of a signal for motor traffic
ONE_JUNCTION_M = 45.0  # lights this near to one another belong together


def green_for_ego(place: Place) -> Together:
    """The ego's next light is green and stays so; all others at that junction are red.

    Raises:
        ScenarioError: no light lies ahead on the route.
    """
    ahead = [c for c in place.route.controls if c.kind is ControlKind.TRAFFIC_LIGHT and c.s_m >= place.trigger_s_m]
    if not ahead:
        raise ScenarioError("no traffic light lies ahead on the ego's route; the case belongs before one")
    own = ahead[0]
    theirs = sorted(
        {  # a light is listed once more for each connecting road that refers to it
            landmark.id
            for landmark in place.carla_map.get_all_landmarks_of_type(LIGHT)
            if landmark.id != own.landmark_id
            and _away_m(landmark.transform.location, own.x_m, own.y_m) < ONE_JUNCTION_M
        }
    )
    lights = [SetLight(own.landmark_id, "Green"), *(SetLight(landmark_id, "Red") for landmark_id in theirs)]
    return Together(*lights, name="green for the ego")


def has_light(place: Place) -> bool:
    """Whether a light lies ahead on the route."""
    return any(c.kind is ControlKind.TRAFFIC_LIGHT and c.s_m >= place.trigger_s_m for c in place.route.controls)


def _away_m(location: object, x_m: float, y_m: float) -> float:
    return math.hypot(location.x - x_m, location.y - y_m)  # type: ignore[attr-defined]


OTHER = "other"
SETTLED_S = 1.8  # before they meet, the other has its speed and keeps it, whatever the ego does
NARROWLY = (0.75, 1.7)  # of its own speed: what it varies by to meet the ego, which may still speed up
SHUTTLE_MPS = 6.0  # its pace, a little less than the agents keep
LEAVES_M = 35.0  # of its way behind the junction, then it is out of sight


def due(ego_s_m: float, seconds: float) -> Behaviour:
    """The ego is so many seconds from a crossing, at its own speed or, where it slows down for it, at the shuttle's."""
    return Either(
        TimeToArrival(ego_s_m, seconds, "the crossing"),
        EgoPasses(ego_s_m - SHUTTLE_MPS * seconds, f"{SHUTTLE_MPS * seconds:.0f} m before the crossing"),
        name="ego is due at the crossing",
    )


class AcrossTheWay(Scenario):
    """The base: one vehicle, on a way through the ego's next junction, there when the ego is.

    Parameters that each has: ``kind``, ``speed``, ``notice``, ``lateness``.
    """

    group = Group.CROSSING_PATHS
    timeout_s = 60.0
    needs_m = 50.0
    needs_junction = True
    turn: Turn | None = None  # of the other; None: straight on where it can
    comes_before = False  # whether the other is there seconds before the ego, not at about the same time

    @property
    def side(self) -> Side:
        """From where it comes."""
        return cast("Side", self.choice("side"))

    @cached_property
    def crossing(self) -> Crossing:
        """Its way, and where that meets the ego's."""
        return crossing(self.place, self.side, self.turn, approach_m=self.run_up_m + 10.0, leave_m=LEAVES_M)

    @property
    def lateness_s(self) -> float:
        """When it gets to where they meet, after the ego would; negative: before it."""
        return self.number("lateness")

    @property
    def run_up_m(self) -> float:
        """Its way to where they meet, in the time that it has.

        One that comes seconds before the ego has less time than the ego: with the ego's it would be half as fast again
        as its parameter says. Where they arrive at about the same time, it varies its speed by a tenth.
        """
        return run_up_m(self.number("speed"), self.number("notice") + (self.lateness_s if self.comes_before else 0.0))

    def actors(self) -> Sequence[ActorSpec]:
        """The other, waiting for its moment up its street."""
        begin_m = self.crossing.meet_s_m - self.run_up_m
        return [ActorSpec(OTHER, BLUEPRINTS[self.choice("kind")], self.crossing.path.at(begin_m))]

    def trigger(self) -> Behaviour:
        """The ego is on its way to where they meet."""
        return due(self.crossing.ego_s_m, self.number("notice"))

    def conflict(self) -> Behaviour:
        """It drives through, and the ego has to let it."""
        speed_mps, way = self.number("speed"), self.crossing
        low, high = NARROWLY
        return InTurn(
            ReachAtEgosArrival(
                OTHER,
                way.path,
                way.meet_s_m,
                way.ego_s_m,
                self.lateness_s,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                settled_s=SETTLED_S,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(OTHER, way.path, speed_mps, at_end="vanish"),
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, and the ego goes on afterwards."""
        return [NoCollision(), Arrives(), InTime()]
