"""Scenario III of the thesis, static: something stands in the ego's lane and has to be gone round."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.criteria import Arrives, InTime, KeepsLane, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoBeyond, EgoNear

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

OBJECT = "object"
MODELS: dict[str, str] = {
    "car": "vehicle.nissan.micra",
    "van": "vehicle.volkswagen.t2",
    "motorcycle": "vehicle.kawasaki.ninja",
    "container": "static.prop.container",
    "barrier": "static.prop.streetbarrier",
    "bin": "static.prop.trashcan01",
}
SEEN_M = 30.0  # from the ego to it, when the conflict begins
PAST_M = 1.0  # behind it, when it is over


class StaticObject(Scenario):
    """Something stands in the ego's lane: a broken-down car, a container, a barrier.

    The ego has to go round it through the other lane, which is free, and reach its target. Objects are not among the
    nine groups of NHTSA's typology; a vehicle that stands in the lane is its pre-crash scenario "lead vehicle
    stopped", and so this is counted.
    """

    group = Group.REAR_END
    aliases = ("StationaryObjectCrossing",)
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("object", tuple(MODELS), "what stands there"),
        Number("ahead", 50.0, 30.0, 65.0, "m", "from the trigger point to its middle"),
        Number("right", 0.2, -0.8, 1.5, "m", "of the middle of the lane"),
        Number("turned", 0.0, -90.0, 90.0, "°", "from the direction of the lane, clockwise"),
    )
    partner_choice = ("object", MODELS)
    timeout_s = 45.0
    needs_m = 95.0

    def actors(self) -> Sequence[ActorSpec]:
        """What stands there."""
        pose = self.place.at(self.number("ahead"), self.number("right"), self.number("turned"))
        return [ActorSpec(OBJECT, MODELS[self.choice("object")], pose)]

    def trigger(self) -> Behaviour:
        """The ego comes near."""
        return EgoNear(OBJECT, SEEN_M)

    def conflict(self) -> Behaviour:
        """The ego goes round it."""
        return EgoBeyond(OBJECT, PAST_M)

    def criteria(self) -> Sequence[Criterion]:
        """It is not touched, nor passed nearer than 0.3 m, which a mirror needs; and the road is not left."""
        return [
            NoCollision(),
            LeastDistance(0.3, to=OBJECT, while_moving=True),
            KeepsLane(0.0, passing=True),
            Arrives(),
            InTime(),
        ]
