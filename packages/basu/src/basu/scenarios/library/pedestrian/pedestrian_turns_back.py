"""A pedestrian crosses the ego's lane and turns back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import InTurn, WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedestrian.pedestrian_crossing import SWAY_M
from basu.scenarios.library.road_users import across, ego_is_due, facing_deg, walking_s
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Number
from basu.scenarios.paths import pavement_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

EARLY_S = 4.5  # they are across so long before an ego of steady speed is there


class PedestrianTurnsBack(Scenario):
    """A pedestrian crosses the ego's lane and turns back into it.

    They walk over in good time, stand in the other lane, as if something was dropped, and turn back when the ego is
    ``notice`` seconds away. NHTSA 2007, scenario 12: pedestrian, no prior vehicle maneuver. Hard for a driver that
    expects pedestrians to go on as they went.
    """

    group = Group.PEDESTRIAN
    parameters = (
        Number("ahead", 70.0, 50.0, 90.0, "m", "from the trigger point to where they cross"),
        Number("speed", 1.5, 0.8, 2.5, "m/s", "of the walk, there and back"),
        Number("beyond", 2.3, 1.8, 3.5, "m", "from the middle of the ego's lane to where they turn"),
        Number("notice", 2.0, 1.2, 4.0, "s", "that the ego needs to them when they turn"),
    )
    needs_m = 110.0

    def _from_m(self) -> float:
        return pavement_m(self.place, self.number("ahead"), "right")

    def actors(self) -> Sequence[ActorSpec]:
        """The walker on the right-hand pavement."""
        pose = self.place.at(self.number("ahead"), self._from_m(), facing_deg(1.0))
        return [ActorSpec("walker", "walker.pedestrian.0003", pose)]

    def trigger(self) -> Behaviour:
        """The ego will find them across."""
        due_s = walking_s(self._from_m() + self.number("beyond"), self.number("speed")) + EARLY_S
        return ego_is_due(self.place, self.number("ahead"), due_s, "where they cross")

    def conflict(self) -> Behaviour:
        """Over, a halt, and back."""
        ahead_m, speed_mps, from_m, to_m = (
            self.number("ahead"),
            self.number("speed"),
            self._from_m(),
            -self.number("beyond"),
        )
        return InTurn(
            WalkAlong("walker", across(self.place, ahead_m, from_m, to_m), speed_mps),
            ego_is_due(self.place, ahead_m, self.number("notice"), "them"),
            WalkAlong("walker", across(self.place, ahead_m, to_m, from_m), speed_mps),
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact and no near miss, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="walker", while_moving=True), Arrives(), InTime()]
