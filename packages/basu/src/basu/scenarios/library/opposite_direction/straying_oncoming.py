"""An oncoming vehicle strays over the middle line: NHTSA's "opposite direction, no maneuver"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.opposite_direction.out_of_lane import OutOfLane
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter

BACK_S = 1.6  # a driver that wakes up steers back in about this time


class StrayingOncoming(OutOfLane):
    """An oncoming driver strays over the middle of the street, and wakes up late.

    NHTSA pre-crash scenario 21, vehicles from opposite directions, no maneuver. It drifts into the ego's lane over
    some seconds and jerks back at a place of its own: an ego that has braked by then has not reached that place yet.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "suv", "van", "motorcycle"), "the straying vehicle"),
        Number("speed", 8.0, 5.0, 13.0, "m/s", "of the other"),
        Number("over", 2.2, 1.4, 3.2, "m", "to its left"),
        Number("drift", 2.0, 1.0, 4.0, "s", "for which it drifts until it is there"),
        Number("warning", 4.8, 3.5, 7.0, "s", "from when it begins to drift until they would meet"),
        Number("meets", 55.0, 45.0, 70.0, "m", "ahead of the trigger point: where it begins to go back"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 40.0, "sun_altitude_angle": -5.0}
    aliases: ClassVar[Sequence[str]] = ("InvadingTurn",)

    @property
    def out_m(self) -> float:
        """So that the ego has its warning."""
        return self.back_m + self.number("warning") * self.number("speed")

    @property
    def aside_m(self) -> float:
        """As given."""
        return self.number("over")

    @property
    def change_m(self) -> tuple[float, float]:
        """Slowly out, quickly back."""
        return self.number("drift") * self.number("speed"), BACK_S * self.number("speed")
