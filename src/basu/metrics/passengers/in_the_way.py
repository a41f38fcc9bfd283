"""Who was in the strip of road that the vehicle was about to sweep: boxes, moving on, against its corridor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers.boxes import distance_m, other_boxes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from basu.records.history import History

MARGIN_M = 0.3  # beside the vehicle
SPACING_M = 0.5
HORIZON_S, LOOK_S = 3.0, 0.25  # how far ahead others are moved on, and how finely
SLACK_S = 2.0  # who is at a place within this of the vehicle's own arrival is in its way
OFF_ROUTE_M = 2.0  # beyond this the vehicle is taken to go straight on


class InTheWay(NamedTuple):
    """Somebody ahead."""

    name: str  # blueprint id and actor id
    away_m: float  # from the front bumper along the corridor
    speed_mps: float  # along it, not below 0


def in_the_way(history: History, tick: int, reach_m: float) -> Iterator[InTheWay]:
    """All who stood or were about to be in the corridor within ``reach_m``, in the frame ``tick``."""
    facts, frame = history.facts, history.frames[tick]
    path_m = _corridor(history, frame, reach_m)
    near = history.others[history.others["tick"] == frame["tick"]]
    speed_mps = max(0.5, math.hypot(frame["velocity_x_mps"], frame["velocity_y_mps"]))
    arrival_s = np.arange(len(path_m)) * SPACING_M / speed_mps
    for row, box in zip(near, other_boxes(facts, near), strict=True):
        for after_s in np.arange(0.0, HORIZON_S + LOOK_S / 2.0, LOOK_S).tolist():
            moved = box + np.array([row["velocity_x_mps"], row["velocity_y_mps"], 0.0, 0.0, 0.0]) * after_s
            blocked = distance_m(path_m, moved) <= facts.vehicle.width_m / 2.0 + MARGIN_M
            if after_s > 0.0:
                blocked &= np.abs(arrival_s - after_s) <= SLACK_S
            if blocked.any():
                first = int(np.argmax(blocked))
                yield InTheWay(
                    name=f"{facts.actor_types.get(int(row['id']), 'somebody')} (actor {int(row['id'])})",
                    away_m=first * SPACING_M,
                    speed_mps=_along(path_m, first, float(row["velocity_x_mps"]), float(row["velocity_y_mps"])),
                )
                break


def _corridor(history: History, frame: np.void, reach_m: float) -> NDArray[np.float64]:
    """(K, 2) the middle of the way ahead of the front bumper: the route, as far beside it as the vehicle is."""
    route, front_m = history.facts.route, history.facts.vehicle.front_m
    ahead_m = np.arange(0.0, reach_m + SPACING_M, SPACING_M)
    if abs(float(frame["lateral_m"])) > OFF_ROUTE_M:
        yaw_rad, along_m = float(frame["yaw_rad"]), front_m + ahead_m
        heading = np.array([math.cos(yaw_rad), math.sin(yaw_rad)])
        straight: NDArray[np.float64] = np.array([frame["x_m"], frame["y_m"]]) + along_m[:, None] * heading
        return straight
    s_m = np.minimum(float(frame["route_s_m"]) + front_m + ahead_m, route.length_m)
    points_m = np.column_stack([np.interp(s_m, route.s_m, route.points_m[:, axis]) for axis in (0, 1)])
    yaw_rad = np.interp(s_m, route.s_m, np.unwrap(route.yaw_rad))
    beside: NDArray[np.float64] = np.column_stack([-np.sin(yaw_rad), np.cos(yaw_rad)]) * float(frame["lateral_m"])
    return points_m + beside


def _along(path_m: NDArray[np.float64], index: int, velocity_x_mps: float, velocity_y_mps: float) -> float:
    """The part of a velocity that goes the corridor's way, not below 0: who comes towards one is as good as a wall."""
    first = min(index, len(path_m) - 2)
    ahead = path_m[first + 1] - path_m[first]
    length_m = float(np.hypot(*ahead))
    if length_m == 0.0:
        return 0.0
    return max(0.0, float(ahead[0] * velocity_x_mps + ahead[1] * velocity_y_mps) / length_m)
