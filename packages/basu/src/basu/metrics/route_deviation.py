"""Route deviation: how much of the driven way lay outside the plan, by arc length.

As equation 5.3 of the thesis compares lengths after equation 5.2, so does this: the deviation is L_O / L_A, the length
of the driven path that lies farther than a threshold from the planned line, over the length of all of it. The threshold
is adjustable; by default it is 2 m, which is beyond the edge of a lane of 3.5 m: a vehicle with its middle there is out
of the planned lane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.metrics.infraction import Incident
from basu.metrics.json_schema import number
from basu.metrics.registry import Drive, Metric, register
from basu.metrics.scoring import THRESHOLD_M
from basu.metrics.stretches import Share, share_line, share_of, share_record, share_row

if TYPE_CHECKING:
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteDeviation:
    """How much of the way lay outside the plan."""

    outside: Share
    threshold_m: float
    largest_m: float  # distance from the planned line


def route_deviation(history: History, threshold_m: float = THRESHOLD_M) -> RouteDeviation:
    """Measure the way beyond ``threshold_m`` of the planned line, one event for each stretch of it."""
    away_m = np.abs(history.frames["lateral_m"])

    def words(first: int, end: int) -> str:
        side = "right" if history.frames["lateral_m"][first] > 0.0 else "left"
        return f"up to {away_m[first:end].max():.1f} m to the {side} of the plan,"

    return RouteDeviation(
        outside=share_of(history, away_m > threshold_m, Incident.ROUTE_DEVIATION, words),
        threshold_m=threshold_m,
        largest_m=float(away_m.max(initial=0.0)),
    )


@register
class DeviationFromRoute(Metric):
    """How much of the way lay outside the plan."""

    name = "route_deviation"
    title = "outside the plan"
    order = 60
    schema = share_record("driven outside the plan", threshold_m=number("m", low=0), largest_m=number("m", low=0))

    def compute(self, drive: Drive) -> dict[str, Any]:
        """Way, share, time and stretches."""
        found = route_deviation(drive.history, drive.scoring.route_deviation_m)
        return {**share_row(found.outside), "threshold_m": found.threshold_m, "largest_m": found.largest_m}

    def lines(self, result: JudgedRun) -> list[str]:
        """A line where it happened."""
        return share_line(self.title, result.metrics[self.name])
