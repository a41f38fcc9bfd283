"""Path following (equations 5.2 and 5.3 of the thesis), arrival at the route's end, and served stops.

A vehicle has arrived within 1 m of the end of its route, or at rest within 5 m of it. A service stop is served where
the vehicle comes to rest within 3 m of it along the route. At rest is below 0.1 m/s, the CARLA leaderboard's figure.
The leaderboard's own end of a route (`metrics.leaderboard.ending`) is part of the leaderboard's rules, not of ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.stretches import chords, path_m, total_m

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History


AT_END_M, PARKED_M = 1.0, 5.0
SERVED_M = 3.0
AT_REST_MPS = 0.1


def has_arrived(left_m: float, speed_mps: float, *, slack_m: float = 0.0, slack_mps: float = 0.0) -> bool:
    """Whether a vehicle with ``left_m`` of its route ahead has arrived; the slacks widen the end and the rest."""
    return left_m <= AT_END_M + slack_m or (left_m <= PARKED_M and speed_mps < AT_REST_MPS + slack_mps)


def arrivals(history: History, *, slack_m: float = 0.0, slack_mps: float = 0.0) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle has arrived, as `has_arrived` has it."""
    left_m = history.facts.route.length_m - history.frames["route_s_m"]
    at_rest = history.speed_mps() < AT_REST_MPS + slack_mps
    there: NDArray[np.bool_] = (left_m <= AT_END_M + slack_m) | ((left_m <= PARKED_M) & at_rest)
    return there


def arrival_tick(history: History, *, slack_m: float = 0.0, slack_mps: float = 0.0) -> int | None:
    """The first frame in which the vehicle has arrived; None where it never has."""
    there = arrivals(history, slack_m=slack_m, slack_mps=slack_mps)
    return int(np.argmax(there)) if there.any() else None


def completion(history: History) -> float:
    """The share of the route that was driven, 0 to 1; 1 for a drive that arrived."""
    if arrival_tick(history) is not None:
        return 1.0
    return min(1.0, max(0.0, float(history.frames["route_s_m"].max(initial=0.0))) / history.facts.route.length_m)


def serves(left_m: float, speed_mps: float) -> bool:
    """Whether a vehicle with ``left_m`` to a service stop, negative beyond it, serves the stop now."""
    return abs(left_m) <= SERVED_M and abs(speed_mps) < AT_REST_MPS


def near_stop(history: History, stop_s_m: float) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle is near enough to a service stop to serve it."""
    near: NDArray[np.bool_] = np.abs(history.frames["route_s_m"] - stop_s_m) <= SERVED_M
    return near


def serving(history: History, stop_s_m: float) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle rests at a service stop: the stop is served where there is one."""
    return near_stop(history, stop_s_m) & (history.speed_mps() < AT_REST_MPS)


class PathFollowing(NamedTuple):
    """The two lengths and what comes of them."""

    driven_m: float  # L_A
    planned_m: float  # L_I
    score: float  # in [0, 1]


def path_following(history: History) -> PathFollowing:
    """Score the driven against the planned length."""
    progress_m = float(history.frames["route_s_m"].max(initial=0.0))
    return compared(arc_length_m(path_m(history.frames)), progress_m, history.facts.route.length_m)


def compared(driven_m: float, progress_m: float, planned_m: float) -> PathFollowing:
    """Equation 5.3, which assumes that both paths end at the same place.

    Where a run ends early, farther from the end than a vehicle may park, that does not hold, and driving in circles
    would add length; then no more than the progress along the plan counts as driven.
    """
    if planned_m - progress_m > PARKED_M:
        driven_m = min(driven_m, progress_m)
    return PathFollowing(driven_m, planned_m, min(1.0, driven_m / planned_m))


def arc_length_m(points_m: NDArray[np.float64]) -> float:
    """Length of the polyline through ``points_m`` (T, 2), equation 5.2 by chords."""
    return total_m(chords(points_m).length_m)
