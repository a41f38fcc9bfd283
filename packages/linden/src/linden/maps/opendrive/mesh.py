"""The road's surface as triangles, lane by lane, and a table that says what each lane is.

Lanes do not share vertices, so a pavement stands above its road by its <height>; the upright face between is left out,
for nothing rolls on it. Frame: CARLA's (x east, y south, z up).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.maps.opendrive.evaluate.pieces import F64, I64
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.limits import (
    HIGHEST_M,
    MOST_IN_A_PLACE,
    MOST_OVERLAPS,
    WIDEST_EXTENT_M,
    WIDEST_LANE_M,
    MapError,
    refuse_beyond,
)
from linden.maps.opendrive.model import OpenDrive
from linden.maps.records import LANES
from linden.protocol.values.enums import LaneType, SemanticTag
from linden.structured import StructuredArray

TAGS = {
    LaneType.SIDEWALK: SemanticTag.SIDEWALKS,
    LaneType.BORDER: SemanticTag.SIDEWALKS,  # the kerb belongs to the pavement, as in CARLA's towns
    LaneType.NONE: SemanticTag.TERRAIN,
    LaneType.RESTRICTED: SemanticTag.TERRAIN,
    LaneType.MEDIAN: SemanticTag.TERRAIN,
    LaneType.TRAM: SemanticTag.RAIL_TRACK,
    LaneType.RAIL: SemanticTag.RAIL_TRACK,
}
"""What lanes of these types are tagged; all others are roads."""
_SMALLEST_AREA_M2 = 1e-6


class RoadMesh(NamedTuple):
    """The surface. All triangles face up: (b - a) x (c - a) has a positive z."""

    vertices: F64  # (V, 3), m
    triangles: NDArray[np.int32]  # (T, 3)
    lane_of_triangle: NDArray[np.int32]  # (T,), row of ``lanes``
    lanes: StructuredArray  # of LANES; a lane with several speed limits has a row for each


def road_mesh(opendrive: OpenDrive) -> RoadMesh:
    """Return the surface of all lanes of a map, those inside junctions too.

    Raises:
        MapError: a lane is too far away, too high or too wide.
    """
    tables = tables_of(opendrive)
    if not len(tables.lanes):
        return RoadMesh(np.empty((0, 3)), np.empty((0, 3), np.int32), np.empty(0, np.int32), np.empty(0, LANES))
    strips = strips_of(tables)
    vertices = points_from_opendrive(np.concatenate(edges_of(tables, strips)))
    _refuse_beyond_limits(tables, strips.lane, vertices)
    quads = np.flatnonzero(strips.continues)
    speed_mps = tables.speeds.value(strips.lane[quads], strips.probe_m[quads])
    row_of_quad, lanes = _lane_table(tables, strips.lane[quads], speed_mps)
    triangles = _triangles(quads, len(strips.lane), tables.lanes["lane_id"][strips.lane[quads]] > 0)
    lane_of_triangle = np.repeat(row_of_quad, 2)
    a, b, c = (vertices[triangles[:, corner], :2] for corner in range(3))
    twice_area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    kept = np.abs(twice_area) > 2.0 * _SMALLEST_AREA_M2
    _refuse_overlaps(vertices[triangles[kept], :2])
    # inside a bend tighter than the lane is wide a strip folds over; its triangles are turned to face up again
    triangles[twice_area < 0.0] = triangles[twice_area < 0.0][:, [0, 2, 1]]
    return RoadMesh(vertices, triangles[kept].astype(np.int32), lane_of_triangle[kept].astype(np.int32), lanes)


def _refuse_beyond_limits(tables: Tables, lane: I64, vertices: F64) -> None:
    """Raise a MapError where polynomials or positions have run away; the inner edges come before the outer ones."""
    finite = np.isfinite(vertices).all(axis=1)
    near = np.abs(vertices[:, :2] - np.median(vertices[finite, :2], axis=0)) <= 0.5 * WIDEST_EXTENT_M
    width_m = np.hypot(*(vertices[: len(lane), :2] - vertices[len(lane) :, :2]).T)
    for wrong, what in (
        (~(finite & near.all(axis=1)), f"runs further than {0.5 * WIDEST_EXTENT_M:g} m from the map's middle"),
        (~(np.abs(vertices[:, 2]) <= HIGHEST_M), f"lies more than {HIGHEST_M:g} m high or deep"),
        (~(width_m <= WIDEST_LANE_M), f"is wider than {WIDEST_LANE_M:g} m"),
    ):
        if wrong.any():
            row = tables.lanes[lane[int(np.argmax(wrong)) % len(lane)]]
            road = tables.roads[row["road"]]
            raise MapError(
                f"lane {row['lane_id']} of road {road.id} {what}; look at its geometry, elevation and widths",
                road.source_line,
            )


def _refuse_overlaps(corners_m: F64) -> None:
    """Raise a MapError where many triangles (T, 3, 2) lie over each place: ``ground`` keeps them place by place."""
    if not len(corners_m):
        return
    low, high = corners_m.min(axis=1), corners_m.max(axis=1)
    size_m = np.maximum(high.max(axis=0) - low.min(axis=0), 1.0)
    place_m = max(1.0, float(np.sqrt(size_m.prod() / (2.0 * len(corners_m) + 64.0))))
    touched = (np.floor((high - low) / place_m) + 1.0).prod(axis=1).sum()
    refuse_beyond(touched / (len(corners_m) + 1000), MOST_OVERLAPS, "lanes over one another, on an average")
    column, row = np.floor((corners_m.mean(axis=1) - low.min(axis=0)) / place_m).astype(np.int64).T
    _, crowd = np.unique(column * (int(row.max()) + 1) + row, return_counts=True)
    crowded = float((crowd.astype(np.float64) ** 2).sum() / len(corners_m))
    refuse_beyond(crowded, MOST_IN_A_PLACE, "pieces of lanes in one place, on an average")


def _triangles(quads: I64, places: int, is_left: NDArray[np.bool_]) -> I64:
    """Return two triangles for each quad; on the left of the road the outer edge lies on the other hand."""
    inner, inner_next, outer, outer_next = quads, quads + 1, quads + places, quads + places + 1
    right = np.stack([inner, inner_next, outer_next, inner, outer_next, outer], axis=1)
    left = np.stack([inner, outer_next, inner_next, inner, outer, outer_next], axis=1)
    return np.where(is_left[:, None], left, right).reshape(-1, 3)


def _lane_table(tables: Tables, lane: I64, speed_mps: F64) -> tuple[I64, StructuredArray]:
    """Return the row of each quad and the rows: a new one where the lane or its speed limit changes."""
    same_speed = (speed_mps[1:] == speed_mps[:-1]) | (np.isnan(speed_mps[1:]) & np.isnan(speed_mps[:-1]))
    begins = np.concatenate([[True], (lane[1:] != lane[:-1]) | ~same_speed])
    source = tables.lanes[lane[begins]]
    rows = np.zeros(len(source), dtype=LANES)
    rows["road_id"] = np.asarray([road.id for road in tables.roads])[source["road"]]
    rows["junction"] = np.asarray([road.junction_id for road in tables.roads])[source["road"]]
    for name in ("section", "lane_id", "type_bits"):
        rows[name] = source[name]
    rows["speed_limit_mps"] = speed_mps[begins]
    rows["tag"] = [TAGS.get(LaneType(int(bits)), SemanticTag.ROADS) for bits in source["type_bits"]]
    return np.cumsum(begins) - 1, rows
