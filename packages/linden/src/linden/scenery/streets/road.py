"""The road as it is seen: every lane's surface as the wheels feel it, and the upright faces of its kerbs."""

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.maps.opendrive.mesh import TAGS
from linden.protocol.values.enums import LaneType, SemanticTag
from linden.scenery.mesh import FACE, NO_OBJECT, Material, Mesh, join
from linden.scenery.patches import PatchLook, strips
from linden.scenery.streets.simplified_lanes import SimplifiedLanes
from linden.structured import StructuredArray

F64 = NDArray[np.float64]

ASPHALT = (74, 74, 76)
WORN_ASPHALT = (84, 83, 81)  # where cars stand, not drive
CONCRETE = (156, 151, 141)
KERB_STONE = (142, 138, 130)
GRASS = (92, 107, 68)
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
_SMALLEST_AREA_M2 = 1e-6
_PROBE_M, _HIGH_M = 0.3, 1e6
_SKIRT_M = 0.12
"""How far an outermost edge reaches down: to where the terrain touches it, and a little more."""


def is_paved(type_bits: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Return which lanes are of asphalt."""
    return np.array([_LOOKS.get(LaneType(bits), _ROAD)[0] is Material.ASPHALT for bits in type_bits.tolist()], bool)


def surface(simplified_lanes: SimplifiedLanes) -> Mesh:
    """Return the surface of all lanes, within millimetres of what the wheels roll on."""
    rows, places = np.flatnonzero(simplified_lanes.continues), len(simplified_lanes.lane)
    halves = np.stack([rows, rows + 1, rows + 1 + places, rows, rows + 1 + places, rows + places], axis=1)
    triangles = halves.reshape(-1, 3)
    vertices = np.concatenate([simplified_lanes.inner, simplified_lanes.outer])
    a, b, c = (vertices[triangles[:, corner], :2] for corner in range(3))
    twice_area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    # each by itself: inside a bend tighter than the lane is wide a strip folds over
    triangles[twice_area < 0.0] = triangles[twice_area < 0.0][:, [0, 2, 1]]
    solid = np.abs(twice_area) > 2.0 * _SMALLEST_AREA_M2
    faces = np.repeat(_faces_of(simplified_lanes)[simplified_lanes.lane[rows]], 2)
    return Mesh(vertices.astype(np.float32), triangles[solid].astype(np.uint32), faces[solid])


def _faces_of(simplified_lanes: SimplifiedLanes) -> StructuredArray:
    """Return the face of each lane."""
    made = np.zeros(len(simplified_lanes.tables.lanes), FACE)
    made["object"] = NO_OBJECT
    in_junction = np.array([road.is_in_junction for road in simplified_lanes.tables.roads], bool)[
        simplified_lanes.tables.lanes["road"]
    ]
    for row, bits in enumerate(simplified_lanes.tables.lanes["type_bits"].tolist()):
        material, colour = _LOOKS.get(LaneType(bits), _ROAD)
        if material is Material.ASPHALT and in_junction[row]:
            colour = ASPHALT  # a junction is paved in one go
        made["material"][row], made["colour"][row] = material, colour
        made["tag"][row] = TAGS.get(LaneType(bits), SemanticTag.ROADS)
    return made


def kerbs(simplified_lanes: SimplifiedLanes, ground: Ground) -> Mesh:
    """Return the upright faces between lanes of different heights, and round the outside of all.

    Land lies millimetres below an outermost edge; without a face there, rays slip through from far away.
    """
    tables, inner, outer = simplified_lanes.tables, simplified_lanes.inner, simplified_lanes.outer
    across = outer - inner
    across[:, 2] = 0.0
    beside = _outer_heights(simplified_lanes)
    stone = PatchLook(Material.CONCRETE, SemanticTag.SIDEWALKS, KERB_STONE)
    asphalt = PatchLook(Material.ASPHALT, SemanticTag.ROADS, ASPHALT)  # so that none shows in a gap between turns
    road_z = inner[:, 2] - tables.heights_inner.value(
        simplified_lanes.lane, simplified_lanes.s_m, simplified_lanes.probe_m
    )
    within = np.where(np.isnan(beside), road_z, beside)
    is_outermost = ~np.isin(simplified_lanes.lane, tables.lanes["inside"])
    raised = outer[:, 2] - road_z > _LEAST_STEP_M
    is_last = is_outermost & ~raised & ~_beside_road(outer, across, ground)
    is_first = (tables.lanes["inside"][simplified_lanes.lane] < 0) & ~_beside_road(inner, -across, ground)
    faces = [
        _between(simplified_lanes, inner, within, inner[:, 2] - within > _LEAST_STEP_M, -across, stone),
        _between(simplified_lanes, inner, within, within - inner[:, 2] > _LEAST_STEP_M, across, stone),
        _between(simplified_lanes, outer, outer[:, 2] - _SKIRT_M, is_outermost & raised, across, stone),
        _between(simplified_lanes, outer, outer[:, 2] - _SKIRT_M, is_last, across, asphalt),
        _between(simplified_lanes, inner, inner[:, 2] - _SKIRT_M, is_first, -across, asphalt),
    ]
    return join(faces)


def _beside_road(edge: F64, away: F64, ground: Ground) -> NDArray[np.bool_]:
    """Return where along an edge (P, 3) a road lies close by on its far side."""
    beyond = edge + _PROBE_M * away / np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-6)[:, None]
    beyond[:, 2] += _HIGH_M
    found: NDArray[np.bool_] = ground.surfaces_under(beyond)[1] >= 0
    return found


def _outer_heights(simplified_lanes: SimplifiedLanes) -> F64:
    """Return the height of the outer edge of the lane inside of each, nan where there is none; all (P,)."""
    lanes, outer = simplified_lanes.tables.lanes, simplified_lanes.outer
    first = np.searchsorted(simplified_lanes.lane, np.arange(len(lanes)))
    inside = lanes["inside"][simplified_lanes.lane]
    nth = np.arange(len(simplified_lanes.lane)) - first[simplified_lanes.lane]
    return np.where(inside >= 0, outer[(first[inside] + nth) % max(len(outer), 1), 2], np.nan)


def _between(
    simplified_lanes: SimplifiedLanes, line: F64, other_z: F64, wanted: NDArray[np.bool_], towards: F64, look: PatchLook
) -> Mesh:
    """Return upright faces along ``line`` to the heights ``other_z`` where they are wanted at either end."""
    other = np.column_stack([line[:, :2], other_z])
    here = simplified_lanes.continues & (wanted | np.append(wanted[1:], [False])[: len(wanted)])
    return strips(line, other, here, look, towards)
