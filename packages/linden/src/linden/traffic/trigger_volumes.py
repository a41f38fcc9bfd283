"""Which light's or sign's trigger volume a vehicle touches: a grid over the volumes, then box against box.

As in CARLA the vehicle's whole box counts, not its middle: a volume is 3 m long and ends 1.5 m before the stop line, so
a front bumper reaches it while there is still room to stop.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.protocol.values.space import BoundingBox

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

REACH_M = 8.0
"""No vehicle's corner lies further from the middle of its box; the longest, a bus, has 5.5 m."""

LEAST_CELL_M = 32.0
MOST_CELLS_A_SIDE = 256


class TriggerGrid(NamedTuple):
    """Trigger volumes in the world (B boxes), and for every cell the boxes that a vehicle in it may touch (K cells)."""

    centre_m: F64
    """(B, 3)"""
    half_m: F64
    """(B, 3)"""
    yaw_rad: F64
    """(B,)"""
    owner: I32
    """(B,) index of the light or sign; it may have a volume on each of several lanes."""
    corner_m: F64
    """(2,) least x and y of the grid."""
    cell_m: float
    side: int
    """Cells along x, and along y: K = side²."""
    first: I32
    """(K + 1,) where each cell's boxes begin in ``members``."""
    members: I32
    """Boxes, cell after cell."""


def trigger_grid(volumes: Sequence[tuple[int, BoundingBox]]) -> TriggerGrid:
    """Return the grid of volumes in the world, each with the index of its owner. Only their yaw counts."""
    count = len(volumes)
    centre_m = np.array([box.location for _, box in volumes], np.float64).reshape(count, 3)
    half_m = np.array([box.extent for _, box in volumes], np.float64).reshape(count, 3)
    yaw_rad = np.radians(np.array([box.rotation.yaw for _, box in volumes], np.float64))
    owner = np.array([owner for owner, _ in volumes], np.int32)
    reach_m = np.hypot(half_m[:, 0], half_m[:, 1])[:, None] + REACH_M
    low_m, high_m = centre_m[:, :2] - reach_m, centre_m[:, :2] + reach_m
    corner_m = low_m.min(axis=0) if count else np.zeros(2)
    size_m = float((high_m.max(axis=0) - corner_m).max()) if count else 0.0
    cell_m = max(LEAST_CELL_M, size_m / MOST_CELLS_A_SIDE)
    side = int(size_m / cell_m) + 1
    cells: list[list[int]] = [[] for _ in range(side * side)]
    for box in range(count):
        left, top = ((low_m[box] - corner_m) / cell_m).astype(int)
        right, bottom = ((high_m[box] - corner_m) / cell_m).astype(int)
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                cells[row * side + column].append(box)
    first = np.concatenate([[0], np.cumsum([len(cell) for cell in cells])]).astype(np.int32)
    members = np.array([box for cell in cells for box in cell], np.int32)
    return TriggerGrid(centre_m, half_m, yaw_rad, owner, corner_m, cell_m, side, first, members)


@kernel
def boxes_touch(
    dx: float, dy: float, yaw_a: float, half_ax: float, half_ay: float, yaw_b: float, half_bx: float, half_by: float
) -> bool:  # pragma: no cover - compiled
    """Whether two boxes in the plane touch, the second's middle being (dx, dy) m from the first's.

    Separating axes: Ericson, Real-Time Collision Detection, section 4.4.1.
    """
    c, s = abs(math.cos(yaw_b - yaw_a)), abs(math.sin(yaw_b - yaw_a))
    cosine, sine = math.cos(yaw_a), math.sin(yaw_a)
    along, across = cosine * dx + sine * dy, cosine * dy - sine * dx
    if abs(along) > half_ax + half_bx * c + half_by * s or abs(across) > half_ay + half_bx * s + half_by * c:
        return False
    cosine, sine = math.cos(yaw_b), math.sin(yaw_b)
    along, across = cosine * dx + sine * dy, cosine * dy - sine * dx
    return abs(along) <= half_bx + half_ax * c + half_ay * s and abs(across) <= half_by + half_ax * s + half_ay * c


@kernel
def owners_over(
    grid: TriggerGrid, position_m: F64, rotation_rad: F64, box_centre_m: F64, half_extent_m: F64, slots: I32
) -> I32:  # pragma: no cover - compiled
    """Return for each of ``slots`` (V,) the owner of the nearest volume that the body touches, -1 for none.

    The columns are those of the bodies, (N, 3): the origin, pitch, yaw and roll, and the box in the body's frame.
    Boxes touch where they do so in the plane and in height.
    """
    found = np.full(len(slots), -1, np.int32)
    for i in range(len(slots)):
        slot = slots[i]
        cosine, sine = math.cos(rotation_rad[slot, 1]), math.sin(rotation_rad[slot, 1])
        x = position_m[slot, 0] + cosine * box_centre_m[slot, 0] - sine * box_centre_m[slot, 1]
        y = position_m[slot, 1] + sine * box_centre_m[slot, 0] + cosine * box_centre_m[slot, 1]
        z = position_m[slot, 2] + box_centre_m[slot, 2]
        column, row = (x - grid.corner_m[0]) / grid.cell_m, (y - grid.corner_m[1]) / grid.cell_m
        if not (0.0 <= column < grid.side and 0.0 <= row < grid.side):  # also where a place is no number
            continue
        cell = int(row) * grid.side + int(column)
        nearest = math.inf
        for member in range(grid.first[cell], grid.first[cell + 1]):
            box = grid.members[member]
            dx, dy = grid.centre_m[box, 0] - x, grid.centre_m[box, 1] - y
            if dx * dx + dy * dy >= nearest:
                continue
            if abs(grid.centre_m[box, 2] - z) > grid.half_m[box, 2] + half_extent_m[slot, 2]:
                continue
            yaw_rad, half_x, half_y = rotation_rad[slot, 1], half_extent_m[slot, 0], half_extent_m[slot, 1]
            box_x, box_y = grid.half_m[box, 0], grid.half_m[box, 1]
            if not boxes_touch(dx, dy, yaw_rad, half_x, half_y, grid.yaw_rad[box], box_x, box_y):
                continue
            nearest = dx * dx + dy * dy
            found[i] = grid.owner[box]
    return found
