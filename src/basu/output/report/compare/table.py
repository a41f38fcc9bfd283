"""The table of a comparison: the columns of table 5.1 of the thesis, and those that it had no need of."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.output.report.markup import figure
from basu.output.report.streets import bounds_of, union

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.output.report.reading import RunRecord
    from basu.output.report.streets import Bounds
    from basu.records.history import History

HEADS = (
    "agent",
    "collisions",
    "stop signs",
    "red lights",
    "speeding",
    "infraction score",
    "path following",
    "driving score",
    "leaderboard 2.1",
    "passengers",
    "ended",
)


class Row(NamedTuple):
    """What is compared; scores are None where nothing was driven."""

    agent: str
    collisions: int
    stop_signs: int
    red_lights: int
    speeding: int
    infraction: float | None
    path_following: float | None
    driving: float | None
    leaderboard: float | None  # driving score of version 2.1, 0..100
    passengers: str  # passed, failed, or a dash
    ended: str

    def cells(self) -> list[str]:
        """As text, in the order of ``HEADS``."""
        counts = (self.collisions, self.stop_signs, self.red_lights, self.speeding)
        scores = (self.infraction, self.path_following, self.driving)
        return [
            self.agent,
            *map(str, counts),
            *map(figure, scores),
            figure(self.leaderboard, 1),
            self.passengers,
            self.ended,
        ]


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


def row(agent: str, document: dict[str, Any]) -> Row:
    """The row of a result."""
    counts = Counter(infraction["kind"] for infraction in document["infractions"])
    scores = document["scores"] or {}
    passengers = document.get("passengers")
    return Row(
        agent=agent,
        collisions=sum(number for kind, number in counts.items() if kind.startswith("collision_")),
        stop_signs=counts["stop_sign"],
        red_lights=counts["red_light"],
        speeding=counts["speeding"],
        infraction=scores.get("infraction"),
        path_following=scores.get("path_following"),
        driving=scores.get("driving"),
        leaderboard=((document.get("leaderboard") or {}).get("2.1") or {}).get("driving"),
        passengers="\u2013" if not passengers else "passed" if passengers["passed"] else "failed",
        ended=document["status"],
    )


def text(found: Sequence[Row]) -> str:
    """The table for a console: heads in two lines, numbers to the right."""
    lines = [[head.rpartition(" ")[0] for head in HEADS], [head.rpartition(" ")[2] for head in HEADS]]
    lines += [each.cells() for each in found]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEADS))]
    written = [
        "  ".join(
            cell.ljust(width) if column in {0, len(HEADS) - 1} else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([*written[:2], "-" * (sum(widths) + 2 * (len(widths) - 1)), *written[2:]])


def remarks(runs: Sequence[RunRecord]) -> list[str]:
    """What has to be said before these runs are compared: other routes, other rules."""
    found = []
    routes = {
        f"{run.result['meta']['route']} of {run.result['meta']['town']}" for run in runs if run.result.get("meta")
    }
    if len(routes) > 1 or not on_one_route(runs):
        named = f" ({', '.join(sorted(routes))})" if len(routes) > 1 else ""
        found.append(
            f"These runs are on different routes{named}: each map shows its own, and their scores do not answer which "
            "agent drives better."
        )
    if len({_rules(run.result["scoring"]) for run in runs}) > 1:
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


def _rules(scoring: dict[str, Any]) -> tuple[object, ...]:
    """What made the scores, as something that can be compared."""
    rest = sorted((key, round(value, 9)) for key, value in scoring.items() if isinstance(value, float | int))
    return (*sorted(scoring["penalties"].items()), *rest)
