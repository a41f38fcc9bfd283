"""The ego crosses a street that has the right of way: NHTSA's "straight crossing paths"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.crossing_paths.stream import LEAVES_M, Lane, Stream
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import crossing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths.crossings import Side

SECOND_ROW_S = 0.8  # after the first row


class StraightCrossingPaths(Stream):
    """The ego comes from a stop sign and goes straight across traffic that does not stop.

    NHTSA pre-crash scenario 30, straight crossing paths at a junction without lights. An ego that drives past
    the sign meets the first car; an ego that takes too short a gap meets the next.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", ("left", "right", "both"), "from which they come"),
        Number("cars", 5.0, 3.0, 6.0, "", "how many from a side, rounded"),
        Number("speed", 8.0, 5.0, 11.0, "m/s", "of all of them"),
        Number("headway", 2.2, 1.6, 3.0, "s", "from one to the next"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 30.0, "sun_altitude_angle": 45.0}

    def ways(self) -> Sequence[Lane]:
        """Straight on, from one side or both."""
        if self.choice("side") != "both":
            side: Side = "left" if self.choice("side") == "left" else "right"
            return [Lane(crossing(self.place, side, approach_m=self.back_m, leave_m=LEAVES_M), 0.0, side)]
        left = crossing(self.place, "left", approach_m=self.back_m + 20.0, leave_m=LEAVES_M)
        right = crossing(self.place, "right", approach_m=self.back_m + 20.0, leave_m=LEAVES_M)
        return [Lane(left, 0.0, "left"), Lane(right, SECOND_ROW_S, "right")]
