"""A pedestrian walks across the street that the ego turns into."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import InTurn, WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.pedestrian.pedestrian_crossing import SWAY_M, WALKERS
from basu.scenarios.library.road_users import across, ego_is_due, facing_deg, other_side, walking_s
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import next_junction, pavement_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoPasses

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

BEFORE_M = 4.0  # the ego has slowed down for its turn when it is so near to the junction


class PedestrianTurn(Scenario):
    """A pedestrian crosses the street that the ego turns into, just behind the corner.

    They set out when the ego begins to turn, so as to be in its lane when it comes out of the turn. NHTSA 2007,
    scenario 11: pedestrian, prior vehicle maneuver. An ego that never steers does not even reach them: it fails by
    leaving its way. An ego that follows the route blindly runs them over.
    """

    group = Group.PEDESTRIAN
    parameters = (
        Number("beyond", 3.0, 1.0, 8.0, "m", "from the end of the junction to where they cross"),
        Number("speed", 1.3, 0.8, 2.2, "m/s", "of the walk"),
        Number("early", -0.5, -2.0, 0.5, "s", "by which they are in the lane's middle before the ego"),
        Choice("side", ("right", "left"), "from which they come, seen from behind the turn"),
        Choice("walker", ("adult", "child"), "the pedestrian"),
    )
    needs_m = 60.0
    aliases = ("VehicleTurningRoutePedestrian",)

    @property
    def _ahead_m(self) -> float:
        return next_junction(self.place).to_m + self.number("beyond")

    @property
    def _from_m(self) -> float:
        return pavement_m(self.place, self._ahead_m, self.choice("side"))

    def actors(self) -> Sequence[ActorSpec]:
        """The walker on the pavement behind the corner."""
        pose = self.place.at(self._ahead_m, self._from_m, facing_deg(self._from_m))
        return [ActorSpec("walker", WALKERS[self.choice("walker")], pose)]

    def trigger(self) -> Behaviour:
        """The ego has come to the corner, and will be there when they are."""
        begins_m = self.place.trigger_s_m + next_junction(self.place).from_m - BEFORE_M
        due_s = walking_s(abs(self._from_m), self.number("speed")) + self.number("early")
        return InTurn(
            EgoPasses(begins_m, "the corner"), ego_is_due(self.place, self._ahead_m, due_s, "where they cross")
        )

    def conflict(self) -> Behaviour:
        """They cross."""
        to_m = pavement_m(self.place, self._ahead_m, other_side(self.choice("side")))
        return WalkAlong("walker", across(self.place, self._ahead_m, self._from_m, to_m), self.number("speed"))

    def criteria(self) -> Sequence[Criterion]:
        """No contact and no near miss, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="walker", while_moving=True), Arrives(), InTime()]
