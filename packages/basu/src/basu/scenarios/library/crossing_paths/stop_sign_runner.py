"""A vehicle does not stop at a stop sign: NHTSA's "running stop sign"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.crossing_paths.from_the_side import AcrossTheWay
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import crossings, next_junction

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths.crossings import Side


class StopSignRunner(AcrossTheWay):
    """The ego has the right of way, and a vehicle from the side drives past a stop sign.

    NHTSA pre-crash scenario 5, running stop sign. The ego's street has no sign, the side street has; the other drives
    on as if it had none, straight on or, where the side street ends, to the left.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "van", "suv", "motorcycle"), "the other vehicle"),
        Number("speed", 6.5, 4.0, 11.0, "m/s", "of the other"),
        Number("lateness", -0.5, -1.5, 1.0, "s", "after the ego at the place where they meet; negative: before it"),
        Number("notice", 5.5, 4.0, 7.0, "s", "before the ego's arrival, when the other sets off"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 70.0, "sun_altitude_angle": 25.0}
    aliases: ClassVar[Sequence[str]] = ("OppositeVehicleTakingPriority",)

    @property
    def side(self) -> Side:
        """From the right where a street comes from there, else from the left: a side street may end here."""
        there = {way.side for way in crossings(self.place, next_junction(self.place))}
        return "right" if "right" in there else "left"
