"""Blocked and out of time: how long the vehicle stood, and how its time compares with what the route allows.

Both end a run. Blocked is a vehicle at rest for 180 s (the leaderboard's ``ActorBlockedTest`` has the same figures).
The time for a route is a start, its length at a walking pace, and a time for each service stop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.metrics.infraction import Evidence, Incident, evidence, row_of
from basu.metrics.json_schema import EVIDENCE, listing, number, record
from basu.metrics.registry import Drive, Metric, register
from basu.metrics.stretches import stretches

if TYPE_CHECKING:
    from basu.records.history import History
    from basu.routing import Route

BLOCKED_S, BLOCKED_MPS = 180.0, 0.1
ALLOWANCE_S, SLOWEST_MPS, STOP_S = 120.0, 1.5, 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Delays:
    """How long a drive stood and took."""

    longest_rest_s: float
    blocked: tuple[Evidence, ...]  # one for each rest of ``BLOCKED_S``
    time_s: float
    time_limit_s: float
    timeouts: tuple[Evidence, ...]  # one where the time was used up


def time_limit_s(route: Route) -> float:
    """Simulated time that a route may take."""
    return ALLOWANCE_S + route.length_m / SLOWEST_MPS + STOP_S * len(route.stops)


def delays(history: History) -> Delays:
    """Measure rests and time."""
    step_s, speed_mps = history.facts.step_s, history.speed_mps()
    rests = stretches(speed_mps < BLOCKED_MPS)
    blocked = tuple(
        evidence(
            history,
            Incident.BLOCKED,
            first,
            speed_mps=float(speed_mps[first]),
            other=None,
            detail=f"stood still for {(end - first) * step_s:.0f} s",
        )
        for first, end in rests
        if (end - first) * step_s > BLOCKED_S
    )
    time_s, limit_s = float(history.frames["t_s"][-1]), time_limit_s(history.facts.route)
    reached_m, length_m = float(history.frames["route_s_m"].max()), history.facts.route.length_m
    detail = f"{reached_m:.0f} m of {length_m:.0f} m after {limit_s:.0f} s"
    last = len(history.frames) - 1
    out_of_time = evidence(
        history, Incident.ROUTE_TIMEOUT, last, speed_mps=float(speed_mps[last]), other=None, detail=detail
    )
    return Delays(
        longest_rest_s=max(((end - first) * step_s for first, end in rests), default=0.0),
        blocked=blocked,
        time_s=time_s,
        time_limit_s=limit_s,
        timeouts=(out_of_time,) if time_s > limit_s else (),
    )


@register
class RestsAndTime(Metric):
    """How long a drive stood and took."""

    name = "delays"
    title = "rests and time"
    order = 80
    schema = record(
        null_=True,
        about_="rests and time",
        longest_rest_s=number("s", low=0),
        time_s=number("s", low=0),
        time_limit_s=number("s", low=0),
        events=listing(EVIDENCE),
    )

    def compute(self, drive: Drive) -> dict[str, Any]:
        """The times, and each rest that was too long."""
        found = delays(drive.history)
        return {
            "longest_rest_s": found.longest_rest_s,
            "time_s": found.time_s,
            "time_limit_s": found.time_limit_s,
            "events": [row_of(event) for event in (*found.blocked, *found.timeouts)],
        }
