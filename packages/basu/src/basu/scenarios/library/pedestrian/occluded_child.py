"""A child runs out from behind a parked vehicle."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.scenarios.actions import WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedestrian.pedestrian_crossing import SWAY_M
from basu.scenarios.library.road_users import across, ego_is_due, facing_deg, walking_s
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import parked_m, pavement_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion


class Parked(NamedTuple):
    """What hides the child: its blueprint and half of its size."""

    blueprint: str
    half_length_m: float
    half_width_m: float


HIDING = {
    "van": Parked("vehicle.mercedes.sprinter", 2.96, 0.99),
    "car": Parked("vehicle.lincoln.mkz_2020", 2.45, 0.92),
}
BEFORE_IT_M = 0.7  # from the bumper of what hides it to the child's way
BEHIND_IT_M = 0.3  # its way begins so far within what hides it, as seen along the street: hidden from afar as well


class OccludedChild(Scenario):
    """A child runs into the street from behind a parked van, sees the ego and freezes in its lane.

    It waits close before the van's bonnet, so that a driver sees it only when it is past the van's side, ``sight``
    seconds before the ego would be there. It stands in the middle of the lane for a moment, then runs on. NHTSA 2007,
    scenario 12: pedestrian, no prior vehicle maneuver. The hard one of its group.
    """

    group = Group.PEDESTRIAN
    parameters = (
        Number("ahead", 60.0, 40.0, 90.0, "m", "from the trigger point to where it runs"),
        Number("speed", 3.0, 1.5, 4.5, "m/s", "of its run"),
        Number("sight", 1.6, 0.8, 3.0, "s", "from its coming into view to the ego's being there"),
        Number("freezes", 2.0, 0.0, 4.0, "s", "that it stands in the lane"),
        Choice("behind", ("van", "car"), "what it comes out from behind"),
    )
    needs_m = 100.0
    aliases = ("ParkingCrossingPedestrian",)

    @property
    def _parked(self) -> Parked:
        return HIDING[self.choice("behind")]

    @property
    def _from_m(self) -> float:
        stands_m = self.number("ahead") - BEFORE_IT_M - self._parked.half_length_m
        return parked_m(self.place, stands_m) + self._parked.half_width_m - BEHIND_IT_M

    def actors(self) -> Sequence[ActorSpec]:
        """The child on the pavement, and what hides it at the kerb."""
        ahead_m, parked = self.number("ahead"), self._parked
        stands_m = ahead_m - BEFORE_IT_M - parked.half_length_m
        return [
            ActorSpec("child", "walker.pedestrian.0012", self.place.at(ahead_m, self._from_m, facing_deg(1.0))),
            ActorSpec("parked", parked.blueprint, self.place.at(stands_m, parked_m(self.place, stands_m))),
        ]

    def trigger(self) -> Behaviour:
        """It will be seen so long before the ego is there."""
        ahead_m = self.number("ahead")
        side_m = parked_m(self.place, ahead_m) - self._parked.half_width_m
        hidden_s = walking_s(self._from_m - side_m, self.number("speed"))
        return ego_is_due(self.place, ahead_m, hidden_s + self.number("sight"), "where it runs")

    def conflict(self) -> Behaviour:
        """It runs out, freezes, and runs on."""
        ahead_m = self.number("ahead")
        way = across(self.place, ahead_m, self._from_m, pavement_m(self.place, ahead_m, "left"))
        return WalkAlong("child", way, self.number("speed"), pause_at_m=self._from_m, pause_s=self.number("freezes"))

    def criteria(self) -> Sequence[Criterion]:
        """The child is not touched or nearly so, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="child", while_moving=True), Arrives(), InTime()]
