"""The order at stop signs where several ways stop: the vehicle that stopped first drives first.

A vehicle that stands at its line, or crosses the junction behind it, tells `LINE X Y AGO`. X and Y are the place of the
line in m, AGO is the time since its stop in s. Another vehicle at a line of the same junction that stopped later lets
it go first. Where both stopped at about the same time, neither text counts. Then the rule of sight decides
(`basu.agents.builtin.rules.right_of_way`).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

SAME_JUNCTION_M = 38.0
"""Between two lines of one junction. Of Linden's 53 pairs of stop signs at one junction 52 are nearer. So are four
pairs of signs at neighbouring junctions. There a vehicle may wait without need while the other one crosses."""
CLEAR_S = 0.5  # stops less apart than this are at the same time
KEPT_S = 0.6  # a text; it comes each 0.2 s
YIELDS_S = 10.0  # after this time at the line the vehicle yields no more: the other one cannot go
HEAD = "LINE"


class StoppedVehicle(NamedTuple):
    """A vehicle that stands at a line or crosses behind it."""

    x_m: float
    y_m: float
    stopped_s: float  # the world's time at which it stopped


def line_text(standing: StoppedVehicle, now_s: float) -> str:
    """Return what a vehicle tells of its stop."""
    return f"{HEAD} {standing.x_m:.1f} {standing.y_m:.1f} {now_s - standing.stopped_s:.2f}"


class StopOrder:
    """What others have told of their stops."""

    def __init__(self) -> None:
        """Know of no other vehicle."""
        self._heard: dict[
            tuple[float, float], tuple[StoppedVehicle, float]
        ] = {}  # by the line, with the time of the text

    def hear(self, texts: Sequence[str], now_s: float) -> None:
        """Take in what was heard, and forget what is too old."""
        for text in texts:
            words = text.split()
            if words[:1] != [HEAD]:
                continue
            try:
                x_m, y_m, ago_s = map(float, words[1:])
            except ValueError:
                continue
            if math.isfinite(x_m + y_m + ago_s):
                self._heard[x_m, y_m] = StoppedVehicle(x_m, y_m, now_s - ago_s), now_s
        self._heard = {line: each for line, each in self._heard.items() if now_s - each[1] <= KEPT_S}

    def is_before(self, own: StoppedVehicle, now_s: float) -> bool:
        """Return whether a vehicle that stopped earlier at another line of the junction is not through yet."""
        if now_s - own.stopped_s > YIELDS_S:
            return False
        return any(
            0.5 < math.hypot(each.x_m - own.x_m, each.y_m - own.y_m) < SAME_JUNCTION_M
            and each.stopped_s < own.stopped_s - CLEAR_S
            for each, _ in self._heard.values()
        )
