"""Frame and cause of a recorded drive's end by the CARLA leaderboard's criteria, and the route completion per frame.

Sources: ``RouteCompletionTest``, ``InRouteTest`` and ``ActorBlockedTest`` in ``atomic_criteria.py``, and
``RouteTimeoutBehavior`` in ``timer.py`` of carla-simulator/scenario_runner, branches leaderboard-1.0 and -2.0;
``route_scenario.py`` of carla-simulator/leaderboard, branch leaderboard-1.0, for the time limit of 1.0. What happened
later does not enter its scores.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.delays import BLOCKED_MPS, BLOCKED_S
from basu.metrics.leaderboard.rules import Kind, Version
from basu.metrics.stretches import stretches
from basu.metrics.validity import LOST_M

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

ARRIVED_PERCENT, ARRIVED_M = 99.0, 10.0  # farther along than this, and this near to the end
FAR_M, FAR_PERCENT = 15.0, 30.0  # far from the route for too much of it; `LOST_M` off it ends the drive at once
GIVEN_S, GIVEN_SPM = 5.0, 0.8  # 1.0: time for a route of no length, and for each metre
LEAST_S, SLOWEST_SHARE = 300.0, 0.1  # 2.x: time for a route of no length, and of the limit for each metre made


class LeaderboardEnding(NamedTuple):
    """The end of a drive in the leaderboard's eyes."""

    tick: int  # the last that counts
    arrived: bool
    by: Kind | None  # what ended it short of the end of the route; None where it arrived or the record ends


def completion_percent(history: History) -> NDArray[np.float64]:
    """(T,) how much of the route has been passed in each frame."""
    return 100.0 * passed_m(history) / history.facts.route.length_m


def passed_m(history: History) -> NDArray[np.float64]:
    """(T,) the place along the route of the last of its points that lies behind: the leaderboard counts by points."""
    route = history.facts.route
    passed = np.searchsorted(route.s_m, np.maximum.accumulate(history.frames["route_s_m"]), side="right") - 1
    return route.s_m[np.clip(passed, 0, None)]


def made_m(history: History) -> NDArray[np.float64]:
    """(T,) how much of the way along the plan was made in each frame, by its points."""
    return np.diff(passed_m(history), prepend=0.0)


def ending(history: History, version: Version) -> LeaderboardEnding:
    """The first frame in which one of its criteria ends the drive, or the last one there is."""
    last = len(history.frames) - 1
    first: list[tuple[int, Kind | None]] = [
        (tick, kind)
        for tick, kind in (
            (_first(_arrived(history)), None),
            (_first(_off_route(history)), Kind.ROUTE_DEVIATION),
            (_blocked(history), Kind.BLOCKED),
            (_first(_out_of_time(history, version)), Kind.ROUTE_TIMEOUT),
        )
        if tick is not None
    ]
    if not first:
        return LeaderboardEnding(last, arrived=False, by=None)
    tick, by = min(first, key=lambda end: end[0])
    return LeaderboardEnding(tick, arrived=by is None, by=by)


def _first(holds: NDArray[np.bool_]) -> int | None:
    """The first frame in which something holds."""
    return int(np.argmax(holds)) if holds.any() else None


def _arrived(history: History) -> NDArray[np.bool_]:
    """(T,) nearly all of the route passed, and near its end."""
    end_x_m, end_y_m = history.facts.route.points_m[-1, :2]
    to_end_m = np.hypot(history.frames["x_m"] - end_x_m, history.frames["y_m"] - end_y_m)
    there: NDArray[np.bool_] = (completion_percent(history) > ARRIVED_PERCENT) & (to_end_m < ARRIVED_M)
    return there


def _off_route(history: History) -> NDArray[np.bool_]:
    """(T,) too far from the route, or far from it for too much of its length."""
    away_m = np.abs(history.frames["lateral_m"])
    far_m = np.cumsum(np.where(away_m >= FAR_M, made_m(history), 0.0))
    off: NDArray[np.bool_] = (away_m >= LOST_M) | (100.0 * far_m / history.facts.route.length_m > FAR_PERCENT)
    return off


def _blocked(history: History) -> int | None:
    """The frame in which the vehicle has been at rest for too long."""
    most = int(BLOCKED_S / history.facts.step_s)
    rests = stretches(history.speed_mps() < BLOCKED_MPS)
    return next((first + most for first, end in rests if end - first > most), None)


def _out_of_time(history: History, version: Version) -> NDArray[np.bool_]:
    """(T,) more time gone than there is; where the simulator posts no limit, 2.x gives no time for the way made."""
    route, frames = history.facts.route, history.frames
    if version is Version.V1_0:
        given: NDArray[np.bool_] = frames["t_s"] > int(GIVEN_SPM * route.length_m + GIVEN_S)
        return given
    limit_mps = frames["speed_limit_mps"]
    pace_mps = np.where(limit_mps > 0.0, SLOWEST_SHARE * limit_mps, np.inf)
    spent: NDArray[np.bool_] = frames["t_s"] > LEAST_S + np.cumsum(made_m(history) / pace_mps)
    return spent
