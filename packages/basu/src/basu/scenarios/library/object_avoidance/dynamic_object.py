"""Scenario III of the thesis, dynamic: something comes out from behind a parked van and crosses."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, Meanwhile, ReachAtEgosArrival
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoArrives, TimeToArrival

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

OBJECT, VAN = "object", "van"
MODELS: dict[str, str] = {
    "bicycle": "vehicle.gazelle.omafiets",
    "moped": "vehicle.vespa.zx125",
    "motorcycle": "vehicle.kawasaki.ninja",
}
VAN_MODEL = "vehicle.volkswagen.t2"
VAN_HALF_M, VAN_WIDE_M = 2.3, 1.1  # half its length and width, rounded up
COMES_S = 4.5  # before the ego is there, it sets off
SURE_S = (
    2.2  # before the meeting it keeps its speed: it does not see the ego, and a stop at 3 m/s² takes that from 15 mph
)
ON_M = 14.0  # that it goes on behind the middle of the ego's lane


class DynamicObject(Scenario):
    """A bicycle or moped comes out from behind a parked van and crosses the ego's way.

    It sets off to be in the ego's lane when the ego gets there, and does not look. NHTSA pre-crash scenario:
    pedalcyclist without prior vehicle maneuver. Fair: it can be seen past the van for as long as a stop at 3 m/s² from
    15 mph takes; an ego that slows down at the sight of the van has more.
    """

    group = Group.PEDALCYCLIST
    aliases = ("DynamicObjectCrossing",)
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("object", tuple(MODELS), "what crosses"),
        Number("ahead", 45.0, 30.0, 60.0, "m", "from the trigger point to where it crosses"),
        Number("from_right", 5.5, 4.5, 8.0, "m", "from the middle of the lane to where it waits"),
        Number("speed", 3.0, 1.5, 6.0, "m/s", "of it at most"),
        Number("offset", 0.0, -1.0, 1.0, "s", "after the ego it would be at the meeting point"),
    )
    partner_choice = ("object", MODELS)
    timeout_s = 45.0
    needs_m = 75.0

    def actors(self) -> Sequence[ActorSpec]:
        """The crossing actor, and the van that hides it."""
        ahead_m = self.number("ahead")
        beside_m = self.place.width_m(ahead_m) / 2.0 + VAN_WIDE_M
        van = self.place.at(ahead_m - VAN_HALF_M - 2.0, beside_m)
        waits = self.place.at(ahead_m, self.number("from_right"), -90.0)
        return [ActorSpec(OBJECT, MODELS[self.choice("object")], waits), ActorSpec(VAN, VAN_MODEL, van)]

    @property
    def meets_m(self) -> float:
        """Where it crosses, along the ego's route."""
        return self.place.trigger_s_m + self.number("ahead")

    def way(self) -> Path:
        """Across the street."""
        start = self.place.at(self.number("ahead"), self.number("from_right"), -90.0)
        return Path.straight(start, self.number("from_right") + ON_M)

    def trigger(self) -> Behaviour:
        """The ego is some seconds away."""
        return TimeToArrival(self.meets_m, COMES_S, "where it crosses")

    def conflict(self) -> Behaviour:
        """It comes out to meet the ego."""
        return ReachAtEgosArrival(
            OBJECT,
            self.way(),
            self.number("from_right"),
            self.meets_m,
            self.number("offset"),
            low_mps=1.2,
            high_mps=self.number("speed"),
            settled_s=SURE_S,
        )

    def resolution(self) -> Behaviour:
        """It goes on, and the ego arrives."""
        return Meanwhile(EgoArrives(), DriveAlong(OBJECT, self.way(), self.number("speed"), at_end="vanish"))

    def criteria(self) -> Sequence[Criterion]:
        """No contact; half a metre beside a moving bicycle is near already."""
        return [NoCollision(), LeastDistance(0.5, to=OBJECT, while_moving=True), Arrives(), InTime()]
