"""The table of a comparison: the scores of table 5.1 of the thesis, and a column for each metric that has one."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.metrics.registry import Column, built_in
from basu.output.report.console import NOT_COMPARABLE, written
from basu.output.report.markup import DASH, figure
from basu.output.report.streets import bounds_of, union

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.result import Result
    from basu.output.report.reading import RunRecord
    from basu.output.report.streets import Bounds
    from basu.records.history import History


class Row(NamedTuple):
    """What is compared of one run."""

    agent: str
    driving: float | None  # None where nothing was driven
    ended: str
    is_comparable: bool
    columns: tuple[Column, ...]

    def cell(self, head: str) -> str:
        """The text under a head; a dash where this run does not have it."""
        return next((column.text for column in self.columns if column.head == head), DASH)


def heads(found: Sequence[Row]) -> tuple[str, ...]:
    """The heads of all rows, in the order in which they first occur; how a run ended comes last."""
    named = dict.fromkeys(column.head for row in found for column in row.columns if column.head != "ended")
    return (*named, "ended")


def rows(runs: Sequence[RunRecord]) -> list[Row]:
    """A row for each run; agents that appear twice are told apart by number."""
    names = Counter(run.agent for run in runs)
    seen: Counter[str] = Counter()
    found = []
    for run in runs:
        seen[run.agent] += 1
        name = run.agent if names[run.agent] == 1 else f"{run.agent} ({seen[run.agent]})"
        found.append(row(name, run.result))
    return found


def row(agent: str, result: Result) -> Row:
    """The row of a result: the scores of the thesis, then what each metric compares, users' metrics last."""
    scores = result.scores._asdict() if result.scores is not None else {}
    driving = f"{figure(scores.get('driving'))}{'' if result.is_comparable else f' {NOT_COMPARABLE}'}"
    columns = [
        Column("agent", agent),
        Column("driving score", driving),
        Column("infraction score", figure(scores.get("infraction"))),
        Column("path following", figure(scores.get("path_following"))),
        *(column for metric in built_in() for column in metric.columns(result)),
        *(Column(own.title, written(own.value, own.unit, own.digits)) for own in result.own.values()),
        Column("ended", result.outcome.status.value),
    ]
    return Row(agent, scores.get("driving"), result.outcome.status.value, result.is_comparable, tuple(columns))


def text(found: Sequence[Row]) -> str:
    """The table for a console: heads in two lines, numbers to the right."""
    named = heads(found)
    lines = [[head.rpartition(" ")[0] for head in named], [head.rpartition(" ")[2] for head in named]]
    lines += [[each.cell(head) for head in named] for each in found]
    widths = [max(len(line[column]) for line in lines) for column in range(len(named))]
    rows_written = [
        "  ".join(
            cell.ljust(width) if column in {0, len(named) - 1} else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([*rows_written[:2], "-" * (sum(widths) + 2 * (len(widths) - 1)), *rows_written[2:]])


def remarks(runs: Sequence[RunRecord]) -> list[str]:
    """What has to be said before these runs are compared: other routes, other rules."""
    found = []
    routes = {f"{run.result.meta['route']} of {run.result.meta['town']}" for run in runs if run.result.meta}
    if len(routes) > 1 or not on_one_route(runs):
        named = f" ({', '.join(sorted(routes))})" if len(routes) > 1 else ""
        found.append(
            f"These runs are on different routes{named}: each map shows its own, and their scores do not answer which "
            "agent drives better."
        )
    ended = [f"{run.agent} ({run.result.outcome.status.value})" for run in runs if not run.result.is_comparable]
    if ended:
        found.append(f"These runs were ended by a failure, and their scores are not comparable: {', '.join(ended)}.")
    if len({_rules(run.result.scoring) for run in runs}) > 1:
        found.append("These runs were scored with different penalties or weights; `basu score` scores them alike.")
    return found


def on_one_route(runs: Sequence[RunRecord]) -> bool:
    """Whether all that was driven was driven on one plan."""
    plans = [history.facts.route.points_m for history in histories(runs)]
    return all(plan.shape == plans[0].shape and np.allclose(plan, plans[0]) for plan in plans[1:])


def histories(runs: Sequence[RunRecord]) -> list[History]:
    """The records of those runs in which something was driven."""
    return [run.history for run in runs if run.history is not None]


def shared_bounds(runs: Sequence[RunRecord]) -> Bounds | None:
    """The map that shows all of them; None where they are on different routes, or nothing was driven."""
    driven = histories(runs)
    return union([bounds_of(history) for history in driven]) if driven and on_one_route(runs) else None


def _rules(scoring: Mapping[str, Any]) -> tuple[object, ...]:
    """What made the scores, as something that can be compared."""
    rest = sorted((key, round(value, 9)) for key, value in scoring.items() if isinstance(value, float | int))
    return (*sorted(scoring["penalties"].items()), *rest)
