"""The road as it is seen: every lane's surface as the wheels feel it, and the upright faces of its kerbs."""

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.meshes.mesh import FACE, NO_OBJECT, Material, Mesh, join
from linden.meshes.patches import Look, strips
from linden.opendrive.evaluate.strips import Strips, edges_of, strips_of
from linden.opendrive.evaluate.tables import Tables, tables_of
from linden.opendrive.mesh import RoadMesh
from linden.opendrive.model import OpenDrive
from linden.values.enums import LaneType, SemanticTag

F64 = NDArray[np.float64]

ASPHALT = (74, 74, 76)
WORN_ASPHALT = (84, 83, 81)  # where cars stand, not drive
CONCRETE = (168, 164, 156)
KERB_STONE = (150, 147, 140)
GRASS = (84, 112, 52)
GRAVEL = (128, 120, 110)
RED_ASPHALT = (112, 72, 62)

_LOOKS = {
    LaneType.SIDEWALK: (Material.CONCRETE, CONCRETE),
    LaneType.BORDER: (Material.CONCRETE, KERB_STONE),
    LaneType.NONE: (Material.GRASS, GRASS),
    LaneType.RESTRICTED: (Material.GRASS, GRASS),
    LaneType.MEDIAN: (Material.GRASS, GRASS),
    LaneType.TRAM: (Material.GRAVEL, GRAVEL),
    LaneType.RAIL: (Material.GRAVEL, GRAVEL),
    LaneType.BIKING: (Material.ASPHALT, RED_ASPHALT),
    LaneType.PARKING: (Material.ASPHALT, WORN_ASPHALT),
    LaneType.SHOULDER: (Material.ASPHALT, WORN_ASPHALT),
}
_ROAD = (Material.ASPHALT, ASPHALT)
_LEAST_STEP_M = 0.005
_SKIRT_M = 0.12
"""How far the outermost edge of a raised lane reaches down: to where the terrain touches it, and a little more."""


def is_paved(type_bits: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Return which lanes are of asphalt."""
    return np.array([_LOOKS.get(LaneType(bits), _ROAD)[0] is Material.ASPHALT for bits in type_bits.tolist()], bool)


def surface(mesh: RoadMesh) -> Mesh:
    """Return the surface of all lanes, triangle for triangle what the wheels roll on."""
    made = np.zeros(len(mesh.lanes), FACE)
    made["object"], made["tag"] = NO_OBJECT, mesh.lanes["tag"]
    for row, bits in enumerate(mesh.lanes["type_bits"].tolist()):
        material, colour = _LOOKS.get(LaneType(bits), _ROAD)
        made["material"][row], made["colour"][row] = material, colour
    return Mesh(mesh.vertices.astype(np.float32), mesh.triangles.astype(np.uint32), made[mesh.lane_of_triangle])


def kerbs(opendrive: OpenDrive) -> Mesh:
    """Return the upright faces between lanes of different heights, and round the outside of raised ones."""
    tables = tables_of(opendrive)
    laid = strips_of(tables)
    inner, outer = (points_from_opendrive(edge) for edge in edges_of(tables, laid))
    across = outer - inner
    across[:, 2] = 0.0
    beside = _outer_heights(tables, laid, outer)
    look = Look(Material.CONCRETE, SemanticTag.SIDEWALKS, KERB_STONE)
    road_z = inner[:, 2] - tables.heights_inner.value(laid.lane, laid.s_m, laid.probe_m)
    within = np.where(np.isnan(beside), road_z, beside)
    is_inside_of_another = np.isin(laid.lane, tables.lanes["inside"])
    raised = outer[:, 2] - road_z > _LEAST_STEP_M
    faces = [
        _between(laid, inner, within, inner[:, 2] - within > _LEAST_STEP_M, -across, look),
        _between(laid, inner, within, within - inner[:, 2] > _LEAST_STEP_M, across, look),
        _between(laid, outer, outer[:, 2] - _SKIRT_M, raised & ~is_inside_of_another, across, look),
    ]
    return join(faces)


def _outer_heights(tables: Tables, laid: Strips, outer: F64) -> F64:
    """Return the height of the outer edge of the lane inside of each, nan where there is none; all (P,)."""
    first = np.searchsorted(laid.lane, np.arange(len(tables.lanes)))
    inside = tables.lanes["inside"][laid.lane]
    nth = np.arange(len(laid.lane)) - first[laid.lane]
    return np.where(inside >= 0, outer[(first[inside] + nth) % len(outer), 2], np.nan)


def _between(laid: Strips, line: F64, other_z: F64, wanted: NDArray[np.bool_], towards: F64, look: Look) -> Mesh:
    """Return upright faces along ``line`` to the heights ``other_z`` where they are wanted at either end."""
    other = np.column_stack([line[:, :2], other_z])
    here = laid.continues & (wanted | np.append(wanted[1:], [False])[: len(wanted)])
    return strips(line, other, here, look, towards)
