"""Path following (equations 5.2 and 5.3 of the thesis), arrival at the route's end, and served stops.

A vehicle has arrived within 1 m of the end of its route, or at rest within 5 m of it, if it drove the route there. A
service stop is served where the vehicle comes to rest within 3 m of it along the route. At rest is below 0.1 m/s, the
CARLA leaderboard's figure. Both need a frame that counts (`basu.metrics.validity`). The leaderboard's own end of a
route (`metrics.leaderboard.ending`) is part of the leaderboard's rules, not of ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.stretches import chords, path_m, total_m
from basu.metrics.validity import counts_at, validity
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History


AT_END_M, PARKED_M = 1.0, 5.0
SERVED_M = 3.0


def has_arrived(left_m: float, speed_mps: float, slack_m: float = 0.0, slack_mps: float = 0.0) -> bool:
    """Whether a vehicle on its route with ``left_m`` ahead has arrived; the slacks widen the end and the rest."""
    return left_m <= AT_END_M + slack_m or (left_m <= PARKED_M and speed_mps < AT_REST_MPS + slack_mps)


def arrivals(history: History, *, slack_m: float = 0.0, slack_mps: float = 0.0) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle has arrived, as `has_arrived` has it, by driving its route."""
    left_m = history.facts.route.length_m - history.frames["route_s_m"]
    at_rest = history.speed_mps() < AT_REST_MPS + slack_mps
    there: NDArray[np.bool_] = (left_m <= AT_END_M + slack_m) | ((left_m <= PARKED_M) & at_rest)
    if not there.any():
        return there
    found = validity(history)
    return there & found.valid & found.unbroken


def arrival_tick(history: History, *, slack_m: float = 0.0, slack_mps: float = 0.0) -> int | None:
    """The first frame in which the vehicle has arrived; None where it never has."""
    there = arrivals(history, slack_m=slack_m, slack_mps=slack_mps)
    return int(np.argmax(there)) if there.any() else None


def completion(history: History) -> float:
    """The share of the route that was validly driven, 0 to 1; 1 for a drive that arrived."""
    return 1.0 if arrival_tick(history) is not None else validity(history).share


def serves(left_m: float, speed_mps: float) -> bool:
    """Whether a vehicle on its route with ``left_m`` to a service stop, negative beyond it, serves the stop now."""
    return abs(left_m) <= SERVED_M and abs(speed_mps) < AT_REST_MPS


def near_stop(history: History, stop_s_m: float) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle is near enough to a service stop to serve it."""
    near: NDArray[np.bool_] = np.abs(history.frames["route_s_m"] - stop_s_m) <= SERVED_M
    return near


def serving(history: History, stop_s_m: float) -> NDArray[np.bool_]:
    """(T,) the frames in which the vehicle, on its route, rests at a stop: the stop is served where there is one."""
    rests = near_stop(history, stop_s_m) & (history.speed_mps() < AT_REST_MPS)
    ticks = np.flatnonzero(rests)
    rests[ticks] = counts_at(history, ticks)
    return rests


class PathFollowing(NamedTuple):
    """The lengths and what comes of them."""

    driven_m: float  # L_A, all that was driven
    valid_m: float  # of the route, that was validly driven
    planned_m: float  # L_I
    score: float  # in [0, 1]


def path_following(history: History) -> PathFollowing:
    """Score the driven against the planned length."""
    driven_m = validity(history).driven_m
    valid_m = float(driven_m[-1]) if len(driven_m) else 0.0
    return compared(arc_length_m(path_m(history.frames)), valid_m, history.facts.route.length_m)


def compared(driven_m: float, valid_m: float, planned_m: float) -> PathFollowing:
    """Equation 5.3, which assumes that both paths follow the route to its end.

    If more of the route was not validly driven than a vehicle may leave at the end, that does not hold. Then no more
    than the valid progress along the plan counts: driving in circles or beside the route would add length.
    """
    counted_m = driven_m if planned_m - valid_m <= PARKED_M else min(driven_m, valid_m)
    return PathFollowing(driven_m, valid_m, planned_m, min(1.0, counted_m / planned_m))


def arc_length_m(points_m: NDArray[np.float64]) -> float:
    """Length of the polyline through ``points_m`` (T, 2), equation 5.2 by chords."""
    return total_m(chords(points_m).length_m)
