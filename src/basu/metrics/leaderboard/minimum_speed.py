"""Whether the vehicle kept up with the traffic around it: leaderboard 2.0 and 2.1.

Source: ``MinimumSpeedRouteTest`` in ``atomic_criteria.py`` of carla-simulator/scenario_runner, branch leaderboard-2.0,
with the four check points that ``route_scenario.py`` gives it. On each quarter of the route the vehicle's mean speed is
compared with the mean speed of all background vehicles; what is below 100 % is an infraction by its percentage. A drive
without traffic has none. The leaderboard asks the whole world for its background vehicles; the record has the sixteen
nearest within 60 m, so these count, and of them the ones that moved at all (a parked car is no traffic).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.leaderboard.ending import passed_m
from basu.metrics.leaderboard.rules import Event, Kind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

CHECKPOINTS = 4
LAST_AT = 0.95  # of the route: a drive that ends beyond it has its last quarter judged
MOVED_MPS = 0.1


def too_slow(history: History) -> tuple[Event, ...]:
    """One event for each quarter of the route on which the vehicle was slower than the traffic."""
    route, frames = history.facts.route, history.frames
    farthest_m = passed_m(history)
    quarter_m = route.length_m / CHECKPOINTS
    traffic_mps = _traffic_mps(history)
    speed_mps = history.speed_mps()
    first, begun_m = 0, 0.0
    found = []
    while first < len(frames):
        beyond = np.flatnonzero(farthest_m[first:] - begun_m > quarter_m)
        if len(beyond) == 0:
            break
        end = first + int(beyond[0])
        found.append(_judged(traffic_mps[first:end], speed_mps[first:end], end))
        first, begun_m = end, float(farthest_m[end])
    if float(farthest_m[-1]) / route.length_m > LAST_AT:
        found.append(_judged(traffic_mps[first:], speed_mps[first:], len(frames) - 1))
    return tuple(event for event in found if event is not None)


def _judged(traffic_mps: NDArray[np.float64], speed_mps: NDArray[np.float64], tick: int) -> Event | None:
    """What comes of one stretch; frames without traffic do not count."""
    with_traffic = np.isfinite(traffic_mps)
    mean_mps = float(traffic_mps[with_traffic].mean()) if with_traffic.any() else 0.0
    if mean_mps == 0.0:
        return None
    percentage = round(float(speed_mps[with_traffic].mean()) / mean_mps * 100.0, 2)
    return Event(kind=Kind.MIN_SPEED, tick=tick, percentage=percentage) if percentage < 100.0 else None


def _traffic_mps(history: History) -> NDArray[np.float64]:
    """(T,) mean speed of the vehicles near in each frame, nan where there are none."""
    others = history.others
    speed_mps = np.hypot(others["velocity_x_mps"], others["velocity_y_mps"])
    vehicles = [actor for actor, what in history.facts.actor_types.items() if what.startswith("vehicle.")]
    traffic = np.isin(others["id"], np.unique(others["id"][speed_mps > MOVED_MPS])) & np.isin(others["id"], vehicles)
    count = np.bincount(others["tick"][traffic], minlength=len(history.frames))
    summed = np.bincount(others["tick"][traffic], weights=speed_mps[traffic], minlength=len(history.frames))
    mean_mps: NDArray[np.float64] = np.divide(summed, count, out=np.full(len(count), np.nan), where=count > 0)
    return mean_mps
