"""The row of a drive in tables of many: `row_of` makes it of a result, for series, matrices and campaigns alike.

A series and a matrix keep the parts that their documents declare (`part_of`). A campaign keeps numbers, flags and texts
as columns (`basu.campaigns.columns`).
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.metrics.registry import built_in
from basu.metrics.success import not_exercised
from basu.output.report.tracks import track_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.metrics.result import Result


def row_of(result: Result) -> dict[str, Any]:
    """Return what tables keep of a drive: where it was, how it ended, scores, metrics, and the verdict of its case."""
    meta, case, status = result.meta, result.case, result.outcome.status
    row = {
        "route": meta.get("route"),
        "seed": meta.get("seed"),
        "own_route": result.has_own_route,
        "track": track_of(meta.get("access")),
        "status": status.value,
        "fault": status.fault.name.lower(),
        "message": "; ".join(result.success.reasons) or result.outcome.message,
        "passed": result.success.passed,
        "severity": severity(result),
        "not_exercised": not_exercised(result.scenarios if case is None else [case]),
        "scores": None if result.scores is None else result.scores._asdict(),
        "infractions": dict(sorted(Counter(found.kind.value for found in result.infractions).items())),
        "metrics": dict(result.metrics),
        "own": {name: own.value for name, own in result.own.items()},
        "margins": {},
        "simulated_s": float(meta.get("simulated_s", 0.0)),
        "wall_s": float(meta.get("wall_s", 0.0)),
    }
    for metric in built_in():
        row |= metric.series(result.metrics.get(metric.name))
    if case is not None:
        judged = ("verdict", "fault", "message", "assessment", "collisions", "margins", "simulated_s", "wall_s")
        row |= {name: case[name] for name in judged}
    return row if "access" not in meta else {**row, "access": meta["access"]}


def part_of(row: Mapping[str, Any], declared: type) -> dict[str, Any]:
    """Return the values of a row that a typed dict declares; what the row does not have is left out."""
    return {name: row[name] for name in declared.__annotations__ if name in row}


def severity(result: Result) -> float:
    """Return how bad a drive was, 0 (good) to 1 (failed): on a route by its score, in a case by the narrowest margin.

    The margin m, in s or m, counts as 1/(1 + m).
    """
    if result.success.passed is False or (result.case is None and result.scores is None):
        return 1.0
    if result.case is None:
        assert result.scores is not None, "it is not None here"
        return 1.0 - result.scores.driving
    known = [value for value in result.case["margins"].values() if value is not None]
    return max((1.0 / (1.0 + max(0.0, value)) for value in known), default=0.0)
