"""The leaderboard's three figures of a drive: route completion, infraction penalty, and their product.

What the leaderboard sees through its scenarios cannot be in a record without them: scenario timeouts and emergency
vehicles that want to pass count as not having happened, and are named as not measured. Stop signs are judged by the
rule of ``metrics.stop_signs``: the leaderboard's needs the simulator's trigger volumes, which are no part of the
record; its threshold of 0.1 m/s is the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from basu.metrics.leaderboard.contacts import collisions
from basu.metrics.leaderboard.ending import Ending, completion_percent, ending
from basu.metrics.leaderboard.lanes import outside_lanes
from basu.metrics.leaderboard.minimum_speed import too_slow
from basu.metrics.leaderboard.rules import SCENARIOS_ONLY, Event, Kind, Version, penalty
from basu.metrics.red_lights import red_lights
from basu.metrics.stop_signs import stop_signs

if TYPE_CHECKING:
    from basu.records.history import History

ARRIVED_M, PARKED_M, PARKED_MPS = 1.0, 5.0, 0.1  # the benchmark's own end of a route, where it ends the drive


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaderboardScores:
    """A drive as one version of the leaderboard scores it."""

    version: Version
    driving: float  # 0..100, completion times penalty
    route_completion: float  # 0..100
    infraction_penalty: float  # 0..1
    events: tuple[Event, ...]  # in order of time
    ended_by: Kind | None  # what would have ended the drive short of the end of the route
    not_measured: tuple[Kind, ...]  # counted as not having happened


def leaderboard_scores(history: History) -> tuple[LeaderboardScores, ...]:
    """The scores of every version, from the record alone."""
    return tuple(_scores(history, version) for version in Version)


def _scores(history: History, version: Version) -> LeaderboardScores:
    """The scores of one version."""
    end = ending(history, version)
    counted = replace(
        history,
        frames=history.frames[: end.tick + 1],
        others=history.others[history.others["tick"] <= end.tick],
        collisions=tuple(event for event in history.collisions if event.tick <= end.tick),
        lane_invasions=tuple(event for event in history.lane_invasions if event.tick <= end.tick),
    )
    events = _events(counted, version)
    if end.by is not None:
        events = (*events, Event(kind=end.by, tick=end.tick))
    completion = _completion(counted, end, version)
    factor = penalty(version, events)
    return LeaderboardScores(
        version=version,
        driving=max(completion * factor, 0.0),
        route_completion=completion,
        infraction_penalty=factor,
        events=tuple(sorted(events, key=lambda event: (event.tick, event.kind.value))),
        ended_by=end.by,
        not_measured=() if version is Version.V1_0 else SCENARIOS_ONLY,
    )


def _events(history: History, version: Version) -> tuple[Event, ...]:
    """Everything that a version would have written down, without what ends a drive."""
    return (
        *collisions(history, version),
        *(Event(kind=Kind.RED_LIGHT, tick=found.tick) for found in red_lights(history)),
        *(Event(kind=Kind.STOP, tick=found.tick) for found in stop_signs(history)),
        *outside_lanes(history, version),
        *(() if version is Version.V1_0 else too_slow(history)),
    )


def _completion(history: History, end: Ending, version: Version) -> float:
    """The share of the route in per cent; all of it where the drive ended at its end.

    A drive that the benchmark took for arrived, and ended, is let arrive: on a route of less than 100 m the leaderboard
    asks for its last metre, which nobody was given the time for.
    """
    last = history.frames[-1]
    remaining_m = history.facts.route.length_m - float(last["route_s_m"])
    parked = remaining_m <= PARKED_M and float(history.speed_mps()[-1]) < PARKED_MPS
    if end.arrived or (end.by is None and (remaining_m <= ARRIVED_M or parked)):
        return 100.0
    percent = float(completion_percent(history)[-1])
    return percent if version is Version.V1_0 else round(percent, 2)
