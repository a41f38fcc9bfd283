"""Trends between versions of an agent: figures of the runs of each version under the same conditions."""

from __future__ import annotations

import statistics
from typing import TYPE_CHECKING, NamedTuple

from basu.outcome import Fault, Status

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from basu.output.report.index.found import IndexedRun

AGENTS_END = ("none", Fault.AGENT.name.lower())  # runs that ended for another reason say nothing of the agent


class VersionFigures(NamedTuple):
    """The runs of one version of an agent, and the means of their scores."""

    version: str
    first: str  # when the first of them started
    runs: int
    passed: int
    judged: int
    driving: float  # mean, 0 for a run that the agent did not complete
    change: float | None  # of the mean to the version before; None for the first version
    infractions_per_km: float | None  # None where nothing was driven
    comfort: float | None  # mean over the runs with a comfort score
    seeds: tuple[int, ...]


class Trend(NamedTuple):
    """An agent under the same conditions."""

    agent: str
    subject: str
    track: str
    conditions: tuple[str, ...]
    versions: tuple[VersionFigures, ...]  # in the order of their first runs

    @property
    def seeds_differ(self) -> bool:
        """Whether the versions were driven with different seeds."""
        return len({version.seeds for version in self.versions}) > 1


def trends(runs: Sequence[IndexedRun]) -> list[Trend]:
    """Return a trend for each agent, subject, track and set of conditions, in the order of their first runs.

    A run that the agent did not complete counts as 0. A run that simulator, set-up or `--stop-after` ended is left out,
    and so is a run that had no gate or drove a route of the agent's own.
    """
    kinds: dict[tuple[str, ...], list[IndexedRun]] = {}
    for run in sorted(runs, key=lambda each: each.started):
        is_of_agent = run.row["fault"] in AGENTS_END and run.row["status"] != Status.STOPPED.value
        if is_of_agent and run.is_comparable:
            kinds.setdefault(run.kind, []).append(run)
    return [
        Trend(
            alike[0].agent, alike[0].subject, str(alike[0].row["track"]), alike[0].conditions, tuple(_versions(alike))
        )
        for alike in kinds.values()
    ]


def _versions(runs: Iterable[IndexedRun]) -> list[VersionFigures]:
    """Return the figures of each version."""
    groups: dict[str, list[IndexedRun]] = {}
    for run in runs:
        groups.setdefault(run.version, []).append(run)
    found: list[VersionFigures] = []
    for version, group in groups.items():
        driving = statistics.fmean(run.driving or 0.0 for run in group)
        comforts = [run.comfort for run in group if run.comfort is not None]
        driven_km = sum(run.row["driven_m"] for run in group) / 1000.0
        infractions = sum(sum(run.row["infractions"].values()) for run in group)
        found.append(
            VersionFigures(
                version=version,
                first=group[0].started,
                runs=len(group),
                passed=sum(run.row["passed"] is True for run in group),
                judged=sum(run.row["passed"] is not None for run in group),
                driving=driving,
                change=driving - found[-1].driving if found else None,
                infractions_per_km=infractions / driven_km if driven_km > 0.0 else None,
                comfort=statistics.fmean(comforts) if comforts else None,
                seeds=tuple(sorted({run.seed for run in group})),
            )
        )
    return found
