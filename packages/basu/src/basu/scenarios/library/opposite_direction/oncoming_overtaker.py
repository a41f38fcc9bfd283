"""An oncoming vehicle overtakes towards the ego: NHTSA's "opposite direction, making a maneuver"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, Meanwhile
from basu.scenarios.library.opposite_direction.out_of_lane import OTHER, OutOfLane
from basu.scenarios.library.road_users import BLUEPRINTS, HALF_LENGTH_M
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import lanes_apart_m, oncoming
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter

SLOW = "slow"
CLEAR_M = 3.0  # between the bumpers when it goes back in front of the slow vehicle
OUT_S, BACK_S = 1.6, 1.4
CAR_HALF_M = HALF_LENGTH_M["car"]


class OncomingOvertaker(OutOfLane):
    """An oncoming vehicle overtakes a slow one and gets back into its lane late.

    NHTSA pre-crash scenario 20, vehicles from opposite directions, one making a maneuver. The overtaker is fully in
    the ego's lane until it is past the slow one, and not before: an ego that keeps up its speed meets it there.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("slow", ("bicycle", "van", "truck"), "the slow vehicle"),
        Number("speed", 9.0, 8.0, 14.0, "m/s", "of the overtaker"),
        Number("slow_speed", 4.0, 2.0, 4.0, "m/s", "of the overtaken"),
        Number("warning", 5.0, 4.0, 7.0, "s", "from when it begins to get out until they would meet"),
        Number("meets", 55.0, 45.0, 70.0, "m", "ahead of the trigger point: where it begins to go back"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 20.0, "sun_altitude_angle": 70.0}

    def choice(self, name: str) -> str:
        """The overtaker is a car."""
        return "car" if name == "kind" else super().choice(name)

    @property
    def out_m(self) -> float:
        """So that the ego has its warning."""
        return self.back_m + self.number("warning") * self.number("speed")

    @property
    def aside_m(self) -> float:
        """The whole way over."""
        return lanes_apart_m(self.place, self.back_m)

    @property
    def change_m(self) -> tuple[float, float]:
        """Out and back at the same pace."""
        return OUT_S * self.number("speed"), BACK_S * self.number("speed")

    @property
    def passed_m(self) -> float:
        """Where the slow one is when the overtaker goes back."""
        return self.back_m + CAR_HALF_M + HALF_LENGTH_M[self.choice("slow")] + CLEAR_M

    def actors(self) -> Sequence[ActorSpec]:
        """The overtaker, and the slow one where it has to be."""
        slow_from_m = self.passed_m + self.number("slow_speed") * self.notice_s
        path = oncoming(self.place, slow_from_m, self.back_m)
        return [*super().actors(), ActorSpec(SLOW, BLUEPRINTS[self.choice("slow")], path.at(0.0))]

    def conflict(self) -> Behaviour:
        """Both come; the slow one drives on at its speed."""
        slow_from_m = self.passed_m + self.number("slow_speed") * self.notice_s
        path = oncoming(self.place, slow_from_m + 5.0, -10.0)
        drives = DriveAlong(SLOW, path, self.number("slow_speed"), accelerate_mps2=8.0, minds=(OTHER,), at_end="vanish")
        return Meanwhile(self.comes(), drives, name="both come")
