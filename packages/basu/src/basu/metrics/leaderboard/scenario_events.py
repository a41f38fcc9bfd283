"""The leaderboard's infractions that only scenarios show: a scenario timeout, and not yielding to emergency vehicles.

Sources: ``ScenarioTimeoutTest`` and ``YieldToEmergencyVehicleTest`` in ``atomic_criteria.py`` and ``ScenarioTimeout``
in ``atomic_behaviors.py`` of carla-simulator/scenario_runner, branch leaderboard-2.0. There, a scenario that obstructs
the route has a time, and an agent that has not mastered it by then pays for the timeout. Here every scenario has a
time of its own (``timeout_s``, mostly 60 s), so every one counts. The emergency vehicle must be in front of the agent
when its scenario ends; `basu.scenarios.criteria.YieldsToEmergencyVehicle` judges that by the same rule.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.metrics.leaderboard.rules import Kind, LeaderboardEvent
from basu.outcome import Status

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from basu.records.history import History

YIELDS = "yields to the emergency vehicle"
"""The name of the criterion that judges the leaderboard's infraction."""


def scenario_events(history: History, scenarios: Sequence[Mapping[str, Any]]) -> tuple[LeaderboardEvent, ...]:
    """Return the events of a drive's scenarios that ended within the record, in their order.

    Args:
        history: the record, as far as it counts.
        scenarios: rows of ``result.json``: those of the route, or the case of the drive.
    """
    return tuple(
        LeaderboardEvent(kind=kind, tick=tick)
        for row in scenarios
        if (tick := _end_tick(row, history)) is not None
        for kind in _kinds(row)
    )


def not_measured(scenarios: Sequence[Mapping[str, Any]]) -> tuple[Kind, ...]:
    """Return the kinds that no scenario of the drive could show."""
    timed = any(_timed_out(row) is not None for row in scenarios)
    yields = any(_judged(row) is not None for row in scenarios)
    return (*(() if timed else (Kind.SCENARIO_TIMEOUT,)), *(() if yields else (Kind.YIELD_EMERGENCY,)))


def cast_of(scenarios: Sequence[Mapping[str, Any]]) -> frozenset[int]:
    """Return the ids of all actors that the scenarios of a drive brought."""
    return frozenset(actor["id"] for row in scenarios for actor in row.get("actors", ()))


def _kinds(row: Mapping[str, Any]) -> Iterator[Kind]:
    """Yield what a scenario shows against the agent."""
    if _timed_out(row):
        yield Kind.SCENARIO_TIMEOUT
    if _judged(row) is False:
        yield Kind.YIELD_EMERGENCY


def _timed_out(row: Mapping[str, Any]) -> bool | None:
    """Return whether the scenario's time was used up; None where it was not reached or an older version wrote it."""
    if "status" in row:  # a case: its drive ends with it
        return bool(row["status"] == Status.SCENARIO_TIMEOUT.value)
    return bool(row["timed_out"]) if row.get("reached") and "timed_out" in row else None


def _judged(row: Mapping[str, Any]) -> bool | None:
    """Return what the criterion said; None where the scenario has none, or it had nothing to judge by."""
    return next((each["passed"] for each in row.get("judgements", ()) if each["criterion"] == YIELDS), None)


def _end_tick(row: Mapping[str, Any], history: History) -> int | None:
    """Return the frame in which a scenario ended, the last one where it lasted longer; None beyond the record."""
    last, ended_s = len(history.frames) - 1, row.get("ended_s")
    tick = last if ended_s is None else round(ended_s / history.facts.step_s)
    return tick if tick <= last else None
