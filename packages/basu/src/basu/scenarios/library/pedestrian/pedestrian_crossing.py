"""A pedestrian walks across the street, seen from afar."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.road_users import across, ego_is_due, facing_deg, other_side, walking_s
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import pavement_m
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion

WALKERS = {"adult": "walker.pedestrian.0002", "child": "walker.pedestrian.0012"}
SWAY_M = 0.5  # by which a pedestrian may sway or stumble: passing nearer is luck


class PedestrianCrossing(Scenario):
    """A pedestrian walks across the street in front of the ego, in plain view.

    They stand on the pavement, set out so as to be in the middle of the ego's lane when the ego would be there, and
    walk on to the other pavement. NHTSA 2007, scenario 12: pedestrian, no prior vehicle maneuver. The clear one of its
    group: there are three seconds and more to see it.
    """

    group = Group.PEDESTRIAN
    parameters = (
        Number("ahead", 60.0, 40.0, 90.0, "m", "from the trigger point to where they cross"),
        Number("speed", 1.4, 0.8, 2.2, "m/s", "of the walk"),
        Number("early", 0.0, -1.5, 0.5, "s", "by which they are in the lane's middle before the ego"),
        Choice("side", ("right", "left"), "from which they come"),
        Choice("walker", ("adult", "child"), "the pedestrian"),
    )
    needs_m = 100.0

    @property
    def from_m(self) -> float:
        """Where they stand, to the right of the ego's lane."""
        return pavement_m(self.place, self.number("ahead"), self.choice("side"))

    def actors(self) -> Sequence[ActorSpec]:
        """The walker on the pavement, looking across."""
        pose = self.place.at(self.number("ahead"), self.from_m, facing_deg(self.from_m))
        return [ActorSpec("walker", WALKERS[self.choice("walker")], pose)]

    def trigger(self) -> Behaviour:
        """The ego will be there when they are."""
        due_s = walking_s(abs(self.from_m), self.number("speed")) + self.number("early")
        return ego_is_due(self.place, self.number("ahead"), due_s, "where they cross")

    def conflict(self) -> Behaviour:
        """They cross."""
        ahead_m = self.number("ahead")
        to_m = pavement_m(self.place, ahead_m, other_side(self.choice("side")))
        return WalkAlong("walker", across(self.place, ahead_m, self.from_m, to_m), self.number("speed"))

    def criteria(self) -> Sequence[Criterion]:
        """No contact and no near miss, and the ego goes on."""
        return [NoCollision(), LeastDistance(SWAY_M, to="walker", while_moving=True), Arrives(), InTime()]
