"""Checks for overlaps at one height: driving lanes of different streets, kerbs in driving lanes."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from shapely import STRtree, box

from linden.maps.opendrive.evaluate.pieces import F64, I64
from linden.maps.opendrive.mesh import RoadMesh, road_mesh
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType
from linden_maps.checks.finding import KERB_REACH_M, LAYER_M, OVERLAP_M, Finding, Severity, worst_of_each

_AT_ONCE = 20_000  # triangles, for the memory that pairs need


def overlaps(opendrive: OpenDrive) -> list[Finding]:
    """Find pairs of roads, or of junctions, with driving lanes that share ground, and the depth of it.

    The ways through one junction share ground by nature, and a road touches the junctions it leads into.
    """
    mesh = road_mesh(opendrive)
    driving = np.flatnonzero(_has_type(mesh, LaneType.DRIVING))
    lanes = mesh.lanes[mesh.lane_of_triangle[driving]]
    in_junction = lanes["junction"] >= 0
    owner = np.where(in_junction, -1 - lanes["junction"], lanes["road_id"])
    return _shared_ground(mesh, driving, owner, in_junction, alike=True, limit_m=OVERLAP_M)


def raised_ground(opendrive: OpenDrive) -> list[Finding]:
    """Find pavements and kerbs that reach into another road's driving lane, where wheels would climb them."""
    mesh = road_mesh(opendrive)
    chosen = np.flatnonzero(_has_type(mesh, LaneType.DRIVING | LaneType.SIDEWALK | LaneType.BORDER))
    lanes = mesh.lanes[mesh.lane_of_triangle[chosen]]
    is_driving = lanes["type_bits"] == int(LaneType.DRIVING)
    return _shared_ground(mesh, chosen, lanes["road_id"], is_driving, alike=False, limit_m=KERB_REACH_M)


def _has_type(mesh: RoadMesh, types: LaneType) -> NDArray[np.bool_]:
    has: NDArray[np.bool_] = mesh.lanes["type_bits"][mesh.lane_of_triangle] & int(types) != 0
    return has


def _shared_ground(
    mesh: RoadMesh,
    chosen: I64,
    owner: NDArray[np.int32],
    group: NDArray[np.bool_],
    *,
    alike: bool,
    limit_m: float,
) -> list[Finding]:
    """Return the deepest overlap of each two owners, between triangles of equal groups (or of different ones)."""
    corners = mesh.vertices[mesh.triangles[chosen]]  # (N, 3, 3)
    found: list[tuple[object, Finding]] = []
    for one, other in _near_pairs(corners, owner, group, alike=alike):
        depth_m = _depth_m(corners[one, :, :2], corners[other, :, :2])
        for nth in np.flatnonzero(depth_m > limit_m):
            pair = (int(chosen[one[nth]]), int(chosen[other[nth]]))
            owners = frozenset({int(owner[one[nth]]), int(owner[other[nth]])})
            found.append((owners, _finding(mesh, pair, float(depth_m[nth]))))
    return worst_of_each(found)


def _finding(mesh: RoadMesh, triangles: tuple[int, int], depth_m: float) -> Finding:
    lanes = mesh.lanes[mesh.lane_of_triangle[list(triangles)]]
    x_m, y_m = mesh.vertices[mesh.triangles[triangles[0]], :2].mean(axis=0)
    names = [
        f"{LaneType(int(lane['type_bits'])).name or 'unknown'} lane {lane['lane_id']} of road {lane['road_id']}".lower()
        + (f" in junction {lane['junction']}" if lane["junction"] >= 0 else "")
        for lane in lanes
    ]
    text = f"{names[0]} and {names[1]} share ground, {depth_m:.2f} m deep"
    road_id = int(lanes[0]["road_id"])
    return Finding(Severity.ERROR, "overlap", text, depth_m, road_id, x_m=float(x_m), y_m=float(y_m))


def _near_pairs(
    corners: F64, owner: NDArray[np.int32], group: NDArray[np.bool_], *, alike: bool
) -> Iterator[tuple[I64, I64]]:
    """Yield pairs of triangles of different owners with bounds that meet, at about the same height."""
    height_m = corners[:, :, 2].mean(axis=1)
    bounds = box(*corners[:, :, :2].min(axis=1).T, *corners[:, :, :2].max(axis=1).T)
    tree = STRtree(bounds)
    for start in range(0, len(bounds), _AT_ONCE):
        one, other = tree.query(bounds[start : start + _AT_ONCE])
        one += start
        kept = (owner[one] < owner[other]) if alike else (owner[one] != owner[other])
        kept &= (group[one] == group[other]) if alike else (group[one] & ~group[other])
        kept &= np.abs(height_m[one] - height_m[other]) < LAYER_M
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
