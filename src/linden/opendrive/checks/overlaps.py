"""Surfaces that lie in one another: driving lanes of different streets, or of different junctions, at one height."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from linden.opendrive.checks.finding import LAYER_M, OVERLAP_M, Finding, Severity, worst_of_each
from linden.opendrive.evaluate.pieces import F64, I64
from linden.opendrive.mesh import RoadMesh, road_mesh
from linden.opendrive.model import OpenDrive
from linden.values.enums import LaneType

_CELL_M = 12.0


def overlaps(opendrive: OpenDrive) -> list[Finding]:
    """Find pairs of roads, or of junctions, whose driving lanes share ground, with the depth of it."""
    mesh = road_mesh(opendrive)
    driving = np.flatnonzero(mesh.lanes["type_bits"][mesh.lane_of_triangle] == int(LaneType.DRIVING))
    corners = mesh.vertices[mesh.triangles[driving]]  # (N, 3, 3)
    lanes = mesh.lanes[mesh.lane_of_triangle[driving]]
    in_junction = lanes["junction"] >= 0
    owner = np.where(in_junction, -1 - lanes["junction"], lanes["road_id"]).astype(np.int64)
    found: list[tuple[object, Finding]] = []
    for first, second in _near_pairs(corners, owner, in_junction):
        depth = _depth_m(corners[first, :, :2], corners[second, :, :2])
        for nth in np.flatnonzero(depth > OVERLAP_M):
            one, other = int(first[nth]), int(second[nth])
            found.append(
                (frozenset({int(owner[one]), int(owner[other])}), _finding(mesh, driving, one, other, depth[nth]))
            )
    return worst_of_each(found)


def _finding(mesh: RoadMesh, driving: I64, one: int, other: int, depth_m: float) -> Finding:
    lanes = mesh.lanes[mesh.lane_of_triangle[driving[[one, other]]]]
    x_m, y_m = mesh.vertices[mesh.triangles[driving[one]], :2].mean(axis=0)
    names = [
        f"lane {lane['lane_id']} of road {lane['road_id']}"
        + (f" in junction {lane['junction']}" if lane["junction"] >= 0 else "")
        for lane in lanes
    ]
    text = f"{names[0]} and {names[1]} share ground, {depth_m:.2f} m deep"
    road_id = int(lanes[0]["road_id"])
    return Finding(Severity.ERROR, "overlap", text, float(depth_m), road_id, x_m=float(x_m), y_m=float(y_m))


def _near_pairs(corners: F64, owner: I64, in_junction: NDArray[np.bool_]) -> Iterator[tuple[I64, I64]]:
    """Yield pairs of triangles of different owners in the same square, at about the same height."""
    low = np.floor(corners[:, :, :2].min(axis=1) / _CELL_M).astype(np.int64)
    high = np.floor(corners[:, :, :2].max(axis=1) / _CELL_M).astype(np.int64)
    span = high - low + 1
    count = span[:, 0] * span[:, 1]
    triangle = np.repeat(np.arange(len(corners)), count)
    nth = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    column, row = low[triangle, 0] + nth % span[triangle, 0], low[triangle, 1] + nth // span[triangle, 0]
    order = np.lexsort((triangle, row, column))
    begins = np.flatnonzero(np.diff(column[order], prepend=np.nan) != 0) if len(order) else order
    begins = np.union1d(begins, np.flatnonzero(np.diff(row[order], prepend=np.nan) != 0)) if len(order) else begins
    height = corners[:, :, 2].mean(axis=1)
    for members in np.split(triangle[order], begins[1:]):
        if len(members) < 2 or (owner[members] == owner[members[0]]).all():
            continue
        one, other = np.triu_indices(len(members), 1)
        one, other = members[one], members[other]
        kept = (owner[one] != owner[other]) & (in_junction[one] == in_junction[other])
        kept &= np.abs(height[one] - height[other]) < LAYER_M
        if kept.any():
            yield one[kept], other[kept]


def _depth_m(first: F64, second: F64) -> F64:
    """Return how deep pairs of triangles (P, 3, 2) reach into each other, 0 where they do not.

    Separating axes: Ericson, Real-Time Collision Detection, section 5.2.1: the least overlap along any edge's normal.
    """
    depth = np.full(len(first), np.inf)
    for triangles in (first, second):
        for corner in range(3):
            edge = triangles[:, (corner + 1) % 3] - triangles[:, corner]
            length = np.maximum(np.linalg.norm(edge, axis=1), 1e-9)
            normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / length[:, None]
            one = np.einsum("pij,pj->pi", first, normal)
            other = np.einsum("pij,pj->pi", second, normal)
            reach = np.minimum(one.max(axis=1), other.max(axis=1)) - np.maximum(one.min(axis=1), other.min(axis=1))
            depth = np.minimum(depth, reach)
    clamped: F64 = np.maximum(depth, 0.0)
    return clamped
