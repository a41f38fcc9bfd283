"""Boxes of vehicles and walkers from above: contact, time to contact, and distance to points.

A box is a row of five numbers: centre x, y in m, heading in rad, half length, half width in m. CARLA's frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.records.structured import StructuredArray

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import Facts

    Boxes = NDArray[np.float64]


UNKNOWN_M = (0.25, 0.25)  # half sizes of an actor without a recorded size: a person on foot


def boxes(x_m: NDArray[np.float64], y_m: NDArray[np.float64], yaw_rad: NDArray[np.float64], half_m: Boxes) -> Boxes:
    """(N, 5) from columns; ``half_m`` is (N, 2)."""
    return np.column_stack([x_m, y_m, yaw_rad, half_m])


def own_boxes(facts: Facts, frames: StructuredArray) -> Boxes:
    """(T, 5) of the vehicle under test: its box need not lie around its origin."""
    vehicle, yaw_rad = facts.vehicle, frames["yaw_rad"]
    middle_m = (vehicle.front_m - vehicle.rear_m) / 2.0
    half_m = np.broadcast_to([(vehicle.front_m + vehicle.rear_m) / 2.0, vehicle.width_m / 2.0], (len(frames), 2))
    x_m = frames["x_m"] + middle_m * np.cos(yaw_rad)
    return boxes(x_m, frames["y_m"] + middle_m * np.sin(yaw_rad), yaw_rad, half_m)


def other_boxes(facts: Facts, others: StructuredArray) -> Boxes:
    """(M, 5) of rows of OTHER."""
    half_m = np.array([facts.actor_sizes.get(int(key), UNKNOWN_M) for key in others["id"]], dtype=np.float64)
    return boxes(others["x_m"], others["y_m"], others["yaw_rad"], half_m.reshape(-1, 2))


def touching(a: Boxes, b: Boxes) -> NDArray[np.bool_]:
    """(N,) whether the boxes of each pair overlap: separating axes, Gottschalk, Lin and Manocha 1996, section 4."""
    gap, reach = _on_axes(a, b)
    return np.asarray(np.all(np.abs(gap) <= reach, axis=1))


def time_to_touch_s(a: Boxes, b: Boxes, approach_mps: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N,) seconds until each pair touches if ``approach_mps`` (N, 2), b's velocity less a's, stays; inf for never.

    Along each separating axis the shadows meet at one time and part at another; the boxes touch once all shadows do.
    """
    gap, reach = _on_axes(a, b)
    speed = np.einsum("nkd,nd->nk", _axes(a, b), approach_mps)
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = (-gap - np.sign(speed) * reach) / speed, (-gap + np.sign(speed) * reach) / speed
    still, apart = speed == 0.0, np.abs(gap) > reach
    begin = np.where(still, np.where(apart, np.inf, -np.inf), first).max(axis=1)
    end = np.where(still, np.where(apart, -np.inf, np.inf), last).min(axis=1)
    meets = (begin <= end) & (end >= 0.0)
    return np.where(meets, np.maximum(begin, 0.0), np.inf)


def distance_m(points_m: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.float64]:
    """(K,) from each of (K, 2) points to one box (5,), 0 inside."""
    cos, sin = np.cos(box[2]), np.sin(box[2])
    dx, dy = points_m[:, 0] - box[0], points_m[:, 1] - box[1]
    beyond_x = np.maximum(np.abs(dx * cos + dy * sin) - box[3], 0.0)
    beyond_y = np.maximum(np.abs(dy * cos - dx * sin) - box[4], 0.0)
    away: NDArray[np.float64] = np.hypot(beyond_x, beyond_y)
    return away


def _axes(a: Boxes, b: Boxes) -> NDArray[np.float64]:
    """(N, 4, 2) the directions of the sides of both boxes."""
    sides = [(np.cos(box[:, 2]), np.sin(box[:, 2])) for box in (a, b)]
    return np.stack([np.stack(v, axis=-1) for cos, sin in sides for v in ((cos, sin), (-sin, cos))], axis=1)


def _on_axes(a: Boxes, b: Boxes) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N, 4) between the centres along each axis, and how far both shadows reach together."""
    axes = _axes(a, b)
    gap = np.einsum("nkd,nd->nk", axes, b[:, :2] - a[:, :2])
    reach = np.zeros_like(gap)
    for box in (a, b):
        along = np.stack([np.cos(box[:, 2]), np.sin(box[:, 2])], axis=-1)
        aside = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        reach += np.abs(np.einsum("nkd,nd->nk", axes, along)) * box[:, 3:4]
        reach += np.abs(np.einsum("nkd,nd->nk", axes, aside)) * box[:, 4:5]
    return gap, reach
