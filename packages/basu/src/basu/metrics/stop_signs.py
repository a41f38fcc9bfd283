"""Stop signs: did the vehicle come to rest before the line, and how slow did it get?

A driver has stopped when its speed fell below 0.1 m/s (the CARLA leaderboard's threshold) while the front bumper was in
the approach zone: from 3 m before the line, as near as a service stop is served, to 1 m beyond it, an overhang that the
leaderboard's trigger volumes forgive as well. A wider zone would not notice a line that is 4 m from its place. A stop
counts only on the route (`basu.metrics.validity`). The sign is passed, and judged, when the vehicle's middle crosses
the line, in whichever lane and however far beside the route. Signs that the run did not get to are not judged.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from basu.metrics.incremental import ControlsWatcher, away_from
from basu.metrics.infraction import DEFAULT_PENALTIES, Evidence, Infraction, evidence
from basu.metrics.json_schema import flag, listing, number, record, text
from basu.metrics.registry import Column, Drive, Metric, TimedMark, register
from basu.metrics.validity import counts_at
from basu.routing import ControlKind
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.metrics.registry import JudgedRun, Watcher
    from basu.metrics.scoring import Scoring
    from basu.records.history import History
    from basu.routing import RouteControl

ZONE_BEFORE_M, ZONE_BEYOND_M = 3.0, 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SignPassed:
    """What the vehicle did at one stop sign."""

    sign: RouteControl
    lowest_speed_mps: float  # in the approach zone
    front_to_line_m: float  # at the lowest speed, from the front bumper to the line, negative beyond it
    tick: int  # of the crossing
    speed_mps: float  # at the crossing
    stopped: bool


def signs_passed(history: History) -> tuple[SignPassed, ...]:
    """Every stop sign on the route that the vehicle passed, in order."""
    vehicle, frames = history.facts.vehicle, history.frames
    centre_s_m = frames["route_s_m"] + (vehicle.front_m - vehicle.rear_m) / 2.0
    front_s_m = frames["route_s_m"] + vehicle.front_m
    speed_mps = history.speed_mps()
    found = []
    for sign in history.facts.route.controls:
        if sign.kind is not ControlKind.STOP_SIGN:
            continue
        crossing = _crossing(centre_s_m, sign.s_m)
        if crossing is None:
            continue
        ahead_m = sign.s_m - front_s_m[: crossing + 1]
        zone = np.flatnonzero(in_zone(ahead_m))
        zone = zone[counts_at(history, zone)]
        slowest = int(zone[np.argmin(speed_mps[zone])]) if len(zone) else crossing
        found.append(
            SignPassed(
                sign=sign,
                lowest_speed_mps=float(speed_mps[slowest]),
                front_to_line_m=float(ahead_m[slowest]),
                tick=crossing,
                speed_mps=float(speed_mps[crossing]),
                stopped=bool(speed_mps[slowest] < AT_REST_MPS),
            )
        )
    return tuple(found)


def in_zone(ahead_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether a stop counts where the front bumper has ``ahead_m`` to the line, negative beyond it."""
    within: NDArray[np.bool_] = (ahead_m <= ZONE_BEFORE_M) & (ahead_m >= -ZONE_BEYOND_M)
    return within


def stops_at(ahead_m: Any, speed_mps: Any, in_lane: Any) -> Any:  # noqa: ANN401 - numbers or arrays
    """Return whether a vehicle stops at a line: ``ahead_m`` from the front bumper, ``in_lane`` if on its route."""
    return in_zone(ahead_m) & (speed_mps < AT_REST_MPS) & in_lane


def stop_signs(history: History) -> tuple[Evidence, ...]:
    """One infraction for each stop sign that was run."""
    return tuple(
        evidence(
            history,
            Infraction.STOP_SIGN,
            passed.tick,
            speed_mps=passed.speed_mps,
            other=f"stop sign {passed.sign.landmark_id}",
            detail=(
                f"crossed the line of stop sign {passed.sign.landmark_id} at {passed.speed_mps:.2f} m/s; "
                f"the lowest speed before it was {passed.lowest_speed_mps:.2f} m/s"
            ),
        )
        for passed in signs_passed(history)
        if not passed.stopped
    )


def _crossing(centre_s_m: NDArray[np.float64], line_s_m: float) -> int | None:
    """Return the first frame in which the vehicle's middle has crossed the line; None if it did not cross."""
    beyond = np.flatnonzero(centre_s_m > line_s_m)
    if len(beyond) == 0 or beyond[0] == 0:
        return None
    return int(beyond[0])


def _no_sign(history: History) -> NDArray[np.bool_]:
    """No stop sign's approach zone has the vehicle in it."""
    return away_from(history, ControlKind.STOP_SIGN, ZONE_BEFORE_M, 0.0)


@register
class StopSigns(Metric):
    """What the vehicle did at each stop sign."""

    name = "stop_signs"
    title = "stop signs"
    order = 20
    timeline_row = "stop signs"
    schema = listing(
        record(
            id=text(),
            route_s_m=number("m"),
            t_s=number("s", low=0),
            lowest_speed_mps=number("m/s", low=0),
            front_to_line_m=number("m"),
            stopped=flag(),
        ),
        "every stop sign of the route that was passed",
    )
    nothing: ClassVar[list[Any]] = []
    penalties: ClassVar[dict[str, float]] = {Infraction.STOP_SIGN.value: DEFAULT_PENALTIES[Infraction.STOP_SIGN]}

    def compute(self, drive: Drive) -> list[dict[str, Any]]:
        """A row for each sign."""
        t_s = drive.history.frames["t_s"]
        return [
            {
                "id": passed.sign.landmark_id,
                "route_s_m": passed.sign.s_m,
                "t_s": float(t_s[passed.tick]),
                "lowest_speed_mps": passed.lowest_speed_mps,
                "front_to_line_m": passed.front_to_line_m,
                "stopped": passed.stopped,
            }
            for passed in signs_passed(drive.history)
        ]

    def watch(self, scoring: Scoring) -> Watcher:  # noqa: ARG002 - no rule of scoring changes them
        """Return what finds the events while a drive lasts."""
        return ControlsWatcher(stop_signs, _no_sign)

    def find(self, drive: Drive) -> tuple[Evidence, ...]:
        """Each sign that was run."""
        return stop_signs(drive.history)

    def lines(self, result: JudgedRun) -> list[str]:
        """How many signs were obeyed, and the slowest speed before any line at most."""
        signs = result.metrics[self.name]
        if not signs:
            return []
        stopped, slowest = sum(sign["stopped"] for sign in signs), max(sign["lowest_speed_mps"] for sign in signs)
        obeyed = f"{stopped} of {len(signs)} obeyed"
        return [f"stop signs        {obeyed}; slowest speed before any line at most {slowest:.3f} m/s"]

    def moments(self, result: JudgedRun, history: History) -> list[TimedMark]:  # noqa: ARG002 - of the value
        """Return each sign that was passed: a tick where the vehicle stopped, a cross where it did not."""
        return [
            TimedMark(
                sign["t_s"],
                None,
                f"stop sign {sign['id']} {'stopped at' if sign['stopped'] else 'run'}, passed at {sign['t_s']:.1f} s, "
                f"lowest speed {sign['lowest_speed_mps']:.2f} m/s",
                "\N{CHECK MARK}" if sign["stopped"] else "\N{BALLOT X}",
                "at passed" if sign["stopped"] else "at passed run",
            )
            for sign in result.metrics[self.name]
        ]

    def columns(self, result: JudgedRun) -> list[Column]:
        """Return the number of stop signs that were run."""
        return [Column("stop signs", str(sum(not sign["stopped"] for sign in result.metrics[self.name])))]
