"""The leaderboard's three figures of a drive: route completion, infraction penalty, and their product.

Scenario timeouts and emergency vehicles that want to pass are judged by the scenarios of the drive. A drive without
such scenarios counts as one in which neither happened, and names both as not measured. Stop signs are judged by the
rule of ``metrics.stop_signs``: the leaderboard's needs the simulator's trigger volumes, which are no part of the
record; its threshold of 0.1 m/s is the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from basu.metrics.json_schema import integer, listing, mapping, number, record, text
from basu.metrics.leaderboard.ending import LeaderboardEnding, completion_percent, ending
from basu.metrics.leaderboard.infractions import collisions, outside_lanes, too_slow
from basu.metrics.leaderboard.rules import Kind, LeaderboardEvent, Version, penalty
from basu.metrics.leaderboard.scenario_events import cast_of, not_measured, scenario_events
from basu.metrics.path_following import has_arrived
from basu.metrics.red_lights import red_lights
from basu.metrics.registry import Column, Drive, Metric, register, shown
from basu.metrics.stop_signs import stop_signs

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from basu.metrics.registry import JudgedRun
    from basu.records.history import History


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaderboardScores:
    """A drive as one version of the leaderboard scores it."""

    version: Version
    driving: float  # 0..100, completion times penalty
    route_completion: float  # 0..100
    infraction_penalty: float  # 0..1
    events: tuple[LeaderboardEvent, ...]  # in order of time
    ended_by: Kind | None  # what would have ended the drive short of the end of the route
    not_measured: tuple[Kind, ...]  # counted as not having happened


def leaderboard_scores(history: History, scenarios: Sequence[Mapping[str, Any]] = ()) -> tuple[LeaderboardScores, ...]:
    """Return the scores of every version; ``scenarios`` are the drive's, as ``result.json`` has them."""
    return tuple(_scores(history, version, scenarios) for version in Version)


def _scores(history: History, version: Version, scenarios: Sequence[Mapping[str, Any]]) -> LeaderboardScores:
    """The scores of one version."""
    end = ending(history, version)
    counted = replace(
        history,
        frames=history.frames[: end.tick + 1],
        others=history.others[history.others["tick"] <= end.tick],
        collisions=tuple(event for event in history.collisions if event.tick <= end.tick),
        lane_invasions=tuple(event for event in history.lane_invasions if event.tick <= end.tick),
    )
    events = _events(counted, version, cast_of(scenarios))
    if version is not Version.V1_0:
        events = (*events, *scenario_events(counted, scenarios))
    if end.by is not None:
        events = (*events, LeaderboardEvent(kind=end.by, tick=end.tick))
    completion = _completion(counted, end, version)
    factor = penalty(version, events)
    return LeaderboardScores(
        version=version,
        driving=max(completion * factor, 0.0),
        route_completion=completion,
        infraction_penalty=factor,
        events=tuple(sorted(events, key=lambda event: (event.tick, event.kind.value))),
        ended_by=end.by,
        not_measured=() if version is Version.V1_0 else not_measured(scenarios),
    )


def _events(history: History, version: Version, cast: Collection[int]) -> tuple[LeaderboardEvent, ...]:
    """Everything that a version would have written down, without what ends a drive."""
    return (
        *collisions(history, version),
        *(LeaderboardEvent(kind=Kind.RED_LIGHT, tick=found.tick) for found in red_lights(history)),
        *(LeaderboardEvent(kind=Kind.STOP, tick=found.tick) for found in stop_signs(history)),
        *outside_lanes(history, version),
        *(() if version is Version.V1_0 else too_slow(history, cast)),
    )


def _completion(history: History, end: LeaderboardEnding, version: Version) -> float:
    """The share of the route in per cent; all of it where the drive ended at its end.

    A drive that the benchmark took for arrived, and ended, is let arrive: on a route of less than 100 m the leaderboard
    requires its last metre, and no drive had the time for it.
    """
    last = history.frames[-1]
    remaining_m = history.facts.route.length_m - float(last["route_s_m"])
    arrived = has_arrived(remaining_m, float(history.speed_mps()[-1]))
    if end.arrived or (end.by is None and arrived):
        return 100.0
    percent = float(completion_percent(history)[-1])
    return percent if version is Version.V1_0 else round(percent, 2)


COMPARED = ("driving", "route_completion", "infraction_penalty")  # what a series keeps of each version


@register
class Leaderboard(Metric):
    """The same drive as each version of the CARLA leaderboard scores it."""

    name = "leaderboard"
    title = "CARLA leaderboard"
    order = 90
    schema = mapping(
        record(
            driving=number(low=0, high=100),
            route_completion=number(low=0, high=100),
            infraction_penalty=number(low=0, high=1),
            ended_by=text(null=True),
            not_measured=listing(text()),
            events=listing(
                record(kind=text(), tick=integer(low=0), t_s=number("s", low=0), percentage=number(null=True))
            ),
        ),
        null=True,
        about="the same drive as each version of the CARLA leaderboard scores it",
    )

    def compute(self, drive: Drive) -> dict[str, Any]:
        """The scores of each version with what they come from."""
        found = leaderboard_scores(drive.history, drive.scenarios)
        return {scores.version.value: _row(drive.history, scores) for scores in found}

    def lines(self, result: JudgedRun) -> list[str]:
        """A line for each version."""
        return [
            f"leaderboard {version}   {scores['driving']:.2f} = {scores['route_completion']:.2f} % of the route "
            f"x {scores['infraction_penalty']:.3f}{_ended(scores)}"
            for version, scores in result.metrics[self.name].items()
        ]

    def series(self, value: Any) -> dict[str, Any]:  # noqa: ANN401 - as `schema` says
        """Return the scores of each version."""
        versions = (value or {}).items()
        return {"leaderboard": {version: {name: scores[name] for name in COMPARED} for version, scores in versions}}

    def columns(self, result: JudgedRun) -> list[Column]:
        """The driving score of version 2.1."""
        scores = (result.metrics[self.name] or {}).get("2.1", {})
        return [Column("leaderboard 2.1", shown(scores.get("driving"), "", 1))]


def _row(history: History, scores: LeaderboardScores) -> dict[str, Any]:
    """The scores of one version as plain values."""
    return {
        "driving": scores.driving,
        "route_completion": scores.route_completion,
        "infraction_penalty": scores.infraction_penalty,
        "ended_by": None if scores.ended_by is None else scores.ended_by.value,
        "not_measured": [kind.value for kind in scores.not_measured],
        "events": [
            {
                "kind": event.kind.value,
                "tick": event.tick,
                "t_s": float(history.frames["t_s"][event.tick]),
                "percentage": event.percentage,
            }
            for event in scores.events
        ],
    }


def _ended(scores: dict[str, Any]) -> str:
    """What ended the drive short of the end of the route, in words."""
    return f", ended by {scores['ended_by']}" if scores["ended_by"] is not None else ""
