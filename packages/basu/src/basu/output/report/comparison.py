"""The comparison of runs: the scores of table 5.1 of the thesis, a column for each metric, and what sets runs apart."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.metrics.display import Column
from basu.output.report.console import score_cell, why_not_comparable
from basu.output.report.streets import bounds_of, union
from basu.output.report.templates import DASH, figure
from basu.output.report.tracks import apart, titled, track_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.result import Result
    from basu.output.report.documents import RunRecord
    from basu.output.report.streets import Bounds
    from basu.records.history import History


DIFFERENT_CONDITIONS = "These runs had different conditions, which alone may explain a difference"
COMPARED = frozenset({"basu", "carla"})  # programs of which another version may change a drive


class ComparedRun(NamedTuple):
    """What is compared of one run."""

    agent: str
    driving: float | None  # None where nothing was driven
    ended: str
    is_comparable: bool
    columns: tuple[Column, ...]
    track: str  # with a mark where no gate stood before the agent; empty where it is not known

    def cell(self, head: str) -> str:
        """Return the text under a head; a dash where this run does not have it."""
        return next((column.text for column in self.columns if column.head == head), DASH)


def heads(found: Sequence[ComparedRun]) -> tuple[str, ...]:
    """Return the heads of all rows, in the order in which they first occur; how a run ended comes last."""
    named = dict.fromkeys(column.head for row in found for column in row.columns if column.head != "ended")
    return (*named, "ended")


def rows(runs: Sequence[RunRecord]) -> list[ComparedRun]:
    """Return a row for each run; agents that appear twice are numbered."""
    names = Counter(run.agent for run in runs)
    seen: Counter[str] = Counter()
    found = []
    for run in runs:
        seen[run.agent] += 1
        name = run.agent if names[run.agent] == 1 else f"{run.agent} ({seen[run.agent]})"
        found.append(row(name, run.result))
    return found


def row(agent: str, result: Result) -> ComparedRun:
    """Return the row of a result: the scores of the thesis, then what each metric compares, users' metrics last."""
    scores = result.scores._asdict() if result.scores is not None else {}
    track = track_of(result.meta.get("access"))
    columns = [
        Column("agent", agent),
        *([Column("track", track)] if track else []),
        Column("driving score", score_cell(result)),
        Column("infraction score", figure(scores.get("infraction"))),
        Column("path following", figure(scores.get("path_following"))),
        *(column for each in result.shown() for column in each.columns(result)),
        Column("result", result.success.word),
        Column("ended", result.outcome.status.value),
    ]
    return ComparedRun(
        agent, scores.get("driving"), result.outcome.status.value, result.is_comparable, tuple(columns), track
    )


def tables(found: Sequence[ComparedRun]) -> dict[str, list[ComparedRun]]:
    """Return the rows of each track by its name: no table has scores of different tracks."""
    groups: dict[str, list[ComparedRun]] = {}
    for each in found:
        groups.setdefault(each.track, []).append(each)
    return groups


def text(found: Sequence[ComparedRun]) -> str:
    """Return the tables for a console, one for each track, which stands above it where there are several."""
    groups = tables(found)
    if len(groups) == 1:
        return _table(found)
    return "\n\n".join(f"{titled(track)}\n{_table(group)}" for track, group in groups.items())


def _table(found: Sequence[ComparedRun]) -> str:
    """One table: heads in two lines, numbers to the right."""
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


def reasons(runs: Sequence[RunRecord]) -> list[str]:
    """Return why each run that did not pass did not, a sentence for each run."""
    names = [each.agent for each in rows(runs)]
    asked = [run.result.success for run in runs]
    return [f"{name} {said.sentence}" for name, said in zip(names, asked, strict=True) if not said.passed]


def remarks(runs: Sequence[RunRecord], *, conditions: bool = True) -> list[str]:
    """Return the warnings of a comparison: runs that differ in conditions (if wanted), routes or rules."""
    found = _conditions(runs) if conditions else []
    routes = {f"{run.result.meta['route']} of {run.result.meta['town']}" for run in runs if run.result.meta}
    if len(routes) > 1 or not on_one_route(runs):
        named = f" ({', '.join(sorted(routes))})" if len(routes) > 1 else ""
        found.append(
            f"These runs are on different routes{named}: each map shows its own, and their scores do not answer which "
            "agent drives better."
        )
    compared = rows(runs)
    different = apart([each.agent for each in compared], {each.agent: each.track for each in compared})
    found += [different] if different else []
    incomparable = [(run.agent, why_not_comparable(run.result)) for run in runs if not run.result.is_comparable]
    if incomparable:
        named = "; ".join(f"{agent} ({reason})" for agent, reason in incomparable)
        found.append(f"The scores of these runs are not comparable: {named}.")
    if len({_rules(run.result.scoring) for run in runs}) > 1:
        found.append("These runs were scored with different penalties or weights; `basu score` scores them alike.")
    return found


def different_conditions(runs: Sequence[RunRecord]) -> dict[str, list[str]]:
    """Return the conditions in which the runs differ: the name of each, with its value in each run."""
    given = [_conditions_of(run.result.meta) for run in runs]
    names = [name for name in dict.fromkeys(name for each in given for name in each) if _differ(given, name)]
    return {name: [each.get(name, "none") for each in given] for name in names}


def _conditions(runs: Sequence[RunRecord]) -> list[str]:
    """Return a sentence that names each condition in which the runs differ; nothing if they differ in none."""
    agents = [each.agent for each in rows(runs)]
    parts = [
        f"{name} " + ", ".join(f"{value} ({agent})" for agent, value in zip(agents, values, strict=True))
        for name, values in different_conditions(runs).items()
    ]
    return [f"{DIFFERENT_CONDITIONS}: {'; '.join(parts)}."] if parts else []


def _differ(given: Sequence[Mapping[str, str]], name: str) -> bool:
    return len({each.get(name) for each in given}) > 1


def _conditions_of(meta: Mapping[str, Any] | None) -> dict[str, str]:
    """Return the conditions of a run by name, as `result.json` records them; versions are those of the benchmark."""
    if not meta:
        return {}
    traffic = meta.get("traffic") or {}
    found = {
        "vehicle": meta.get("vehicle"),
        "weather": meta.get("weather"),
        "seed": meta.get("seed"),
        "vehicles of the traffic": traffic.get("vehicles"),
        "walkers of the traffic": traffic.get("walkers"),
        "vehicles per km": traffic.get("density_per_km"),
        **{f"version of {name}": value for name, value in (meta.get("versions") or {}).items() if name in COMPARED},
    }
    return {name: str(value) for name, value in found.items() if value is not None}


def on_one_route(runs: Sequence[RunRecord]) -> bool:
    """Return whether all that was driven was driven on one plan."""
    plans = [history.facts.route.points_m for history in histories(runs)]
    return all(plan.shape == plans[0].shape and np.allclose(plan, plans[0]) for plan in plans[1:])


def histories(runs: Sequence[RunRecord]) -> list[History]:
    """Return the records of those runs in which something was driven."""
    return [run.history for run in runs if run.history is not None]


def shared_bounds(runs: Sequence[RunRecord]) -> Bounds | None:
    """Return the map that shows all of them; None where they are on different routes, or nothing was driven."""
    driven = histories(runs)
    return union([bounds_of(history) for history in driven]) if driven and on_one_route(runs) else None


def _rules(scoring: Mapping[str, Any]) -> tuple[object, ...]:
    """Return what made the scores, as something that can be compared."""
    rest = sorted((key, round(value, 9)) for key, value in scoring.items() if isinstance(value, float | int))
    return (*sorted(scoring["penalties"].items()), *rest)
