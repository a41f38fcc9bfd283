"""A door opens before a cyclist; the cyclist ends up at rest in the ego's lane."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival, Together, Wait
from basu.scenarios.criteria import Arrives, InTime, KeepsLane, LeastDistance, NoCollision
from basu.scenarios.library.pedalcyclist.bicycles import BICYCLE, HINGE_M, SWAY_M, car_with_door, opens_and_shuts
from basu.scenarios.library.road_users import FRONT_M, ego_is_due
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import Path, parked_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.stage import Pose

RIDES_S = 5.0  # from setting out to the door
EDGE_M = 2.2  # to the right of the ego's lane, where the cyclist rides
INTO_M = 0.2  # to the right of the lane's middle, where the cyclist comes to rest
DODGE_M = 4.0  # the way from the edge to there
SHORT_M = 2.0  # before the door's hinge, where the cyclist comes to rest
BRAKES_MPS2 = 5.0
BACK_M = 14.0  # the way back to the edge


class Dooring(Scenario):
    """A door opens right before a cyclist; the cyclist dodges it and comes to rest in the ego's lane.

    The ego comes up from behind, faster than the cyclist. It must stop, and wait until the cyclist rides on and the
    door is shut. NHTSA 2007, scenario 14: pedalcyclist, no prior vehicle maneuver. In ``cyclist_swerves`` the cyclist
    has room to ride round the door; here there is none. The door is a sheet of its size, as in ``bicycles``.
    """

    group = Group.PEDALCYCLIST
    parameters = (
        Number("ahead", 60.0, 45.0, 90.0, "m", "from the trigger point to the door's hinge"),
        Number("speed", 4.0, 2.5, 5.5, "m/s", "of the cyclist"),
        Number("notice", 3.0, 2.0, 5.0, "s", "that the ego needs to the cyclist's place when the door opens"),
        Number("stays", 4.0, 3.0, 8.0, "s", "that the door stays open, and the cyclist at rest"),
        Number("kerb", 0.0, -0.2, 0.3, "m", "that the car stands farther out into the street than the lane's middle"),
    )
    needs_m = 110.0
    aliases = ("VehicleOpensDoorTwoWays",)

    @property
    def _car(self) -> Pose:
        at_m = self.number("ahead") - HINGE_M
        return self.place.at(at_m, parked_m(self.place, at_m) - self.number("kerb"))

    @property
    def _rests_m(self) -> float:
        """Where the cyclist comes to rest, ahead of the trigger point."""
        return self.number("ahead") - SHORT_M

    @property
    def _begin_m(self) -> float:
        """Where the cyclist waits for the ego, likewise."""
        return max(5.0, self._dodge_m - RIDES_S * self.number("speed"))

    @property
    def _dodge_m(self) -> float:
        """Where the cyclist is when the door opens: as far from rest as braking takes, and the dodge."""
        return self._rests_m - max(DODGE_M, self.number("speed") ** 2 / (2.0 * 0.8 * BRAKES_MPS2))

    @cached_property
    def _way(self) -> Path:
        """At the edge, out into the lane, and back to the edge behind the door."""
        place = self.place
        edge = Path.of_route(place.route, place.trigger_s_m + self._begin_m)
        out = edge.swerved(self._dodge_m - self._begin_m, DODGE_M, EDGE_M, INTO_M)
        return out.swerved(self._rests_m - self._begin_m + 2.0 * SHORT_M, BACK_M, 0.0, EDGE_M - INTO_M)

    def actors(self) -> Sequence[ActorSpec]:
        """The cyclist at the edge, the parked car, and its door."""
        return [ActorSpec("cyclist", BICYCLE, self._way.at(0.0)), *car_with_door(self._car)]

    def trigger(self) -> Behaviour:
        """The ego will be near when the cyclist comes to the car."""
        return ego_is_due(self.place, self._dodge_m, RIDES_S + self.number("notice") + 1.0, "the cyclist")

    def conflict(self) -> Behaviour:
        """The cyclist rides up, the door opens, the cyclist dodges and stands; the door shuts, the cyclist rides on."""
        speed_mps, stays_s, dodge_m = self.number("speed"), self.number("stays"), self._dodge_m - self._begin_m
        rests_m = self._rests_m - self._begin_m
        on_m = rests_m + 2.0 * SHORT_M + BACK_M + 5.0
        return InTurn(
            ReachAtEgosArrival(
                "cyclist",
                self._way,
                dodge_m,
                self.place.trigger_s_m + self._dodge_m - FRONT_M,
                -self.number("notice"),
                low_mps=0.7 * speed_mps,
                high_mps=1.4 * speed_mps,
                settled_s=1.0,
            ),
            Together(
                opens_and_shuts(self._car, stays_s),
                InTurn(
                    DriveAlong("cyclist", self._way, speed_mps, to_m=rests_m, brake_mps2=BRAKES_MPS2),
                    Wait(stays_s),
                    DriveAlong("cyclist", self._way, speed_mps, to_m=on_m),
                    name="the cyclist",
                ),
            ),
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact, no near miss of the cyclist; the ego stays on the street, and goes on."""
        apart = LeastDistance(SWAY_M, to="cyclist", while_moving=True)
        return [NoCollision(), apart, KeepsLane(passing=True), Arrives(), InTime()]
