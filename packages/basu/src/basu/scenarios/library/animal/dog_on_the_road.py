"""A dog stands on the street, and goes when it likes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.actions import InTurn, Wait, WalkAlong
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.library.road_users import across, animal, ego_is_due, facing_deg
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import pavement_m
from basu.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.stage import ActorSpec

NEAR_M = 0.5


class DogOnTheRoad(Scenario):
    """A dog stands in the ego's lane from the outset, and trots off a while after the ego has come near.

    The ego must stop for it and wait. NHTSA 2007, scenario 10: animal, no prior vehicle maneuver. The clear one of its
    group. A dog of 32 kg, 0.6 m high; on the original CARLA, which has no animals, a walker of a child's size stands
    in its place.
    """

    group = Group.ANIMAL
    parameters = (
        Number("ahead", 60.0, 40.0, 90.0, "m", "from the trigger point to where it stands"),
        Number("right", 0.2, -0.9, 0.9, "m", "of the lane's middle"),
        Number("stays", 8.0, 5.0, 15.0, "s", "that it stands on when the ego is near"),
        Number("speed", 1.8, 0.8, 5.0, "m/s", "at which it trots off"),
        Choice("side", ("right", "left"), "to which it goes"),
    )
    needs_m = 100.0

    def actors(self) -> Sequence[ActorSpec]:
        """The dog in the lane, across it."""
        return [animal("dog", "dog", self.place.at(self.number("ahead"), self.number("right"), facing_deg(-1.0)))]

    def trigger(self) -> Behaviour:
        """The ego is four seconds away."""
        return ego_is_due(self.place, self.number("ahead"), 4.0, "the dog")

    def conflict(self) -> Behaviour:
        """It stands on, then goes."""
        ahead_m = self.number("ahead")
        to_m = pavement_m(self.place, ahead_m, self.choice("side"))
        way = across(self.place, ahead_m, self.number("right"), to_m)
        return InTurn(Wait(self.number("stays")), WalkAlong("dog", way, self.number("speed")))

    def criteria(self) -> Sequence[Criterion]:
        """It is not touched or nearly so, and the ego goes on."""
        return [NoCollision(), LeastDistance(NEAR_M, to="dog", while_moving=True), Arrives(), InTime()]
