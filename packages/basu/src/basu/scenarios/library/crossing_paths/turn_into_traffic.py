"""The ego turns right from a stop sign into traffic: NHTSA's "turning at a non-signalised junction"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.crossing_paths.stream import LEAVES_M, Lane, Stream
from basu.scenarios.parameters import Number
from basu.scenarios.paths import crossing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter


class TurnIntoTraffic(Stream):
    """The ego turns right from a stop sign, into a street where cars come from the left.

    NHTSA pre-crash scenario 31, turning at a non-signalised junction. The lane that the ego wants is taken until the
    last car has gone by, or a gap is long enough to get up to speed in.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Number("cars", 5.0, 3.0, 6.0, "", "how many, rounded"),
        Number("speed", 8.0, 5.0, 11.0, "m/s", "of all of them"),
        Number("headway", 2.2, 1.6, 3.0, "s", "from one to the next"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 100.0, "precipitation": 30.0, "wetness": 60.0}
    aliases: ClassVar[Sequence[str]] = ("NonSignalizedJunctionRightTurn",)

    def ways(self) -> Sequence[Lane]:
        """From the left, straight on."""
        return [Lane(crossing(self.place, "left", "straight", approach_m=self.back_m, leave_m=LEAVES_M), 0.0, "left")]
