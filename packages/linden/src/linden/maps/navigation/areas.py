"""Walkable surfaces of a map as triangles with a kind: lanes, crosswalks and ramps to the sidewalks."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.navigation.raster import CROSSWALK, EDGE, ROAD, SIDEWALK
from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.outlines import ring_of
from linden.protocol.values.enums import LaneType

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

_BETWEEN = LaneType.NONE | LaneType.BORDER | LaneType.MEDIAN | LaneType.RESTRICTED
LONGEST_RAMP_M = 4.0
"""How far from a crosswalk's end a pavement may begin and still be led to: the width of a kerb and a broad verge."""
_PROBES_M = np.arange(-0.5, LONGEST_RAMP_M, 0.1)
_NEARLY = 0.8  # of half a crosswalk's width: where beside the middle a pavement is looked for
_LANDING_M = 1.0  # how far onto the pavement a ramp goes on; what is pavement stays pavement
_OVERLAP_M = 3.0  # how far back a ramp begins, for a crosswalk's end may be slanted


class Surfaces(NamedTuple):
    """Triangles (T, 3, 3) in m, and what each is to a walker (T,), as in ``raster``; crosswalks come last."""

    corners_m: F64
    kinds: U8


def surfaces_of(opendrive: OpenDrive, ground: Ground, lane_of_triangle: I32, lane_type: NDArray[np.uint32]) -> Surfaces:
    """Return the walkable triangles of a map. The ground knows the lane of each triangle; the lane has type bits."""
    kind_of_lane = np.full(len(lane_type), ROAD, np.uint8)
    kind_of_lane[(lane_type & int(_BETWEEN)) != 0] = EDGE
    kind_of_lane[(lane_type & int(LaneType.SIDEWALK)) != 0] = SIDEWALK
    corners_m = _corners(ground)
    crossings = [
        _triangles(part) for shape in crosswalks(opendrive, ground, lane_of_triangle, lane_type) for part in shape
    ]
    kinds = [kind_of_lane[lane_of_triangle], np.full(sum(map(len, crossings)), CROSSWALK, np.uint8)]
    return Surfaces(np.concatenate([corners_m, *crossings]), np.concatenate(kinds))


def _corners(ground: Ground) -> F64:
    """Return the corners (T, 3, 3) of the ground's triangles, out of their barycentric gradients."""
    planes = ground.planes
    determinant = planes[:, 2] * planes[:, 5] - planes[:, 3] * planes[:, 4]
    first = np.column_stack([planes[:, 5], -planes[:, 4]]) / determinant[:, None]
    second = np.column_stack([-planes[:, 3], planes[:, 2]]) / determinant[:, None]
    corners_m = np.empty((len(planes), 3, 3))
    for corner, aside in enumerate((np.zeros_like(first), first, second)):
        corners_m[:, corner, :2] = planes[:, :2] + aside
        corners_m[:, corner, 2] = planes[:, 6] + (planes[:, 7:9] * aside).sum(axis=1)
    return corners_m


def crosswalks(
    opendrive: OpenDrive, ground: Ground, lane_of_triangle: I32, lane_type: NDArray[np.uint32]
) -> list[list[F64]]:
    """Return every crosswalk's outline (N, 3) and those of its ramps, in CARLA's frame."""
    tables = tables_of(opendrive)
    found = []
    for index, road in enumerate(opendrive.roads):
        for thing in road.objects:
            if not thing.is_crosswalk:
                continue
            outline_m = ring_of(tables, index, thing) * (1.0, -1.0, 1.0)
            if len(outline_m) < 3:
                continue
            found.append([outline_m, *_ramps(outline_m, ground, lane_of_triangle, lane_type)])
    return found


def crosswalk_outlines(opendrive: OpenDrive) -> list[tuple[int, list[tuple[float, float]]]]:
    """Return the road and the outline of every crosswalk in OpenDRIVE's frame, m."""
    tables = tables_of(opendrive)
    outlines = [
        (road.id, ring_of(tables, index, thing))
        for index, road in enumerate(opendrive.roads)
        for thing in road.objects
        if thing.is_crosswalk
    ]
    return [
        (road_id, [(float(x_m), float(y_m)) for x_m, y_m in outline_m[:, :2]])
        for road_id, outline_m in outlines
        if len(outline_m) >= 3
    ]


def _ramps(outline_m: F64, ground: Ground, lane_of_triangle: I32, lane_type: NDArray[np.uint32]) -> list[F64]:
    """Return the rectangles from a crosswalk's ends to the pavements, along the axis that has more pavements to reach.

    The axes are those of the smallest rectangle round the outline; of two that reach as many the longer one is meant.
    """
    centre, axes, half_m = _rectangle(outline_m[:, :2])
    z_m = float(outline_m[:, 2].mean())
    best: tuple[int, float, list[F64]] = (0, 0.0, [])
    for along, across in ((0, 1), (1, 0)):
        side = half_m[across] * axes[across]
        ramps = []
        for way in (-1.0, 1.0):
            end = centre + way * half_m[along] * axes[along]
            starts = np.array([end - _NEARLY * side, end, end + _NEARLY * side])
            points = starts[:, None] + way * _PROBES_M[:, None] * axes[along]
            reached = _on_pavement(points.reshape(-1, 2), z_m, ground, lane_of_triangle, lane_type).reshape(3, -1)
            if reached.any():
                far_m = float(_PROBES_M[reached.argmax(axis=1)][reached.any(axis=1)].max()) + _LANDING_M
                begin, far = end - way * min(_OVERLAP_M, half_m[along]) * axes[along], end + way * far_m * axes[along]
                ramp = np.array([begin - side, begin + side, far + side, far - side])
                ramps.append(np.column_stack([ramp, np.full(4, z_m)]))
        if (len(ramps), half_m[along]) > best[:2]:
            best = (len(ramps), float(half_m[along]), ramps)
    return best[2]


def _on_pavement(
    points_m: F64, z_m: float, ground: Ground, lane_of_triangle: I32, lane_type: NDArray[np.uint32]
) -> NDArray[np.bool_]:
    """Return which points (N, 2) lie on a pavement, ``z_m`` being about its height."""
    _, triangle = ground.surfaces_under(np.column_stack([points_m, np.full(len(points_m), z_m)]))
    on_pavement: NDArray[np.bool_] = triangle >= 0
    on_pavement[on_pavement] = lane_type[lane_of_triangle[triangle[on_pavement]]] & int(LaneType.SIDEWALK) != 0
    return on_pavement


def _rectangle(points_m: F64) -> tuple[F64, F64, F64]:
    """Return centre (2,), axes (2, 2) and half sizes (2,) of the smallest rectangle along one of the shape's sides."""
    best_area, best = math.inf, (points_m.mean(axis=0), np.eye(2), np.zeros(2))
    for side in np.roll(points_m, -1, axis=0) - points_m:
        length_m = float(np.hypot(*side))
        if length_m < 1e-6:
            continue
        axis = side / length_m
        axes = np.array([axis, (-axis[1], axis[0])])
        places = points_m @ axes.T
        low, high = places.min(axis=0), places.max(axis=0)
        area = float(np.prod(high - low))
        if area < best_area * (1.0 - 1e-9):
            best_area, best = area, (0.5 * (low + high) @ axes, axes, 0.5 * (high - low))
    return best


def _triangles(outline_m: F64) -> F64:
    """Return the fan (N - 2, 3, 3) of a convex outline."""
    count = len(outline_m) - 2
    return np.stack([np.repeat(outline_m[:1], count, axis=0), outline_m[1:-1], outline_m[2:]], axis=1)
