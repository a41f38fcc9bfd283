"""Road departure in a bend: the road is wet, and the steering is pulled towards the outside."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from basu.errors import ScenarioError
from basu.scenarios.actions import InTurn, Meanwhile, PullSteering, SetFriction, Together
from basu.scenarios.criteria import Arrives, InTime, KeepsLane, NoCollision, Regains
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoPasses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

BENT_1PM = 1.0 / 40.0  # a route that bends more tightly than this is in a bend
LEAST_RAD = math.radians(10.0)  # a bend turns by at least this
JOINED_M = 6.0  # two bends to one side nearer than this are one
BEFORE_M = 5.0  # the road is slippery from so far before the bend
PATCH_M = 3.0  # radius of a slippery place
LONGEST_S = 20.0  # of the pull, however slowly the ego drives through the bend
RAIN: dict[str, float] = {
    "cloudiness": 90.0,
    "precipitation": 80.0,
    "precipitation_deposits": 70.0,
    "wetness": 100.0,
    "fog_density": 15.0,
    "sun_altitude_angle": 25.0,
}


class BendDeparture(Scenario):
    """A bend is wet, and the steering is pulled towards its outside while the ego is in it.

    The tyres have little friction from before the bend until behind it: an ego that comes in too fast slides out, and a
    pull towards the outside has to be held against. NHTSA pre-crash scenario: road edge departure without prior vehicle
    maneuver, on a curve. Fair: the friction is enough for the bend at the sideways acceleration that passengers bear.
    """

    group = Group.ROAD_DEPARTURE
    parameters: ClassVar[Sequence[Parameter]] = (
        Number("friction", 0.3, 0.15, 1.0, "", "of the tyres in the bend; a dry road has 1.1 for the shuttle"),
        Number("pull", 0.1, 0.0, 0.3, "", "share of the full steering, towards the outside of the bend"),
    )
    weather: ClassVar[Mapping[str, float]] = RAIN
    timeout_s = 50.0
    needs_m = 50.0

    @cached_property
    def bend(self) -> tuple[float, float, float]:
        """Where the next bend begins and ends along the ego's route, and 1.0 if it is to the right, -1.0 if not.

        Raises:
            ScenarioError: there is none behind the trigger point outside of junctions.
        """
        route = self.place.route
        yaw_rad = np.unwrap(route.yaw_rad)
        curvature = np.gradient(yaw_rad, route.s_m)
        bent = (np.abs(curvature) > BENT_1PM) & ~route.is_junction & (route.s_m > self.place.trigger_s_m)
        places = np.flatnonzero(bent)
        groups = np.split(places, np.flatnonzero(np.diff(route.s_m[places]) > JOINED_M) + 1)
        for group in groups:
            if len(group) and abs(yaw_rad[group[-1]] - yaw_rad[group[0]]) >= LEAST_RAD:
                sign = math.copysign(1.0, float(yaw_rad[group[-1]] - yaw_rad[group[0]]))
                return float(route.s_m[group[0]]), float(route.s_m[group[-1]]), sign
        raise ScenarioError("the ego's route has no bend behind the trigger point; BendDeparture needs one")

    def setup(self) -> Behaviour:
        """The slippery road, as overlapping places along the lane."""
        begin_m, end_m, _ = self.bend
        count = 1 + round((end_m - begin_m + BEFORE_M) / PATCH_M)
        ahead_m = [begin_m - BEFORE_M + PATCH_M * number - self.place.trigger_s_m for number in range(count)]
        friction = self.number("friction")
        return Together(*(SetFriction(self.place.at(m), PATCH_M, friction) for m in ahead_m), name="slippery bend")

    def trigger(self) -> Behaviour:
        """The ego comes into the bend."""
        return EgoPasses(self.bend[0], "the beginning of the bend")

    def conflict(self) -> Behaviour:
        """The steering is off until the bend is over."""
        _, end_m, sign = self.bend
        return InTurn(
            Meanwhile(
                EgoPasses(end_m, "the end of the bend"),
                PullSteering(-sign * self.number("pull"), LONGEST_S),
                name="pulled towards the outside",
            )
        )

    def criteria(self) -> Sequence[Criterion]:
        """The middle stays in the lane, and is back in the middle of it soon after the bend."""
        return [KeepsLane(0.0), Regains(), NoCollision(), Arrives(), InTime()]
