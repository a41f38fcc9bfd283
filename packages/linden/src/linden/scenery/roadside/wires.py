"""Utility poles with their cross-arms and the wires between them, and shelters at stops."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes, prisms
from linden.scenery.scene.utility_poles import PANEL_HALF_M, POLE_HALF_M, POLE_HEIGHT_M, SHELTER_HALF_M

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_WOOD, _WIRE, _STEEL, _GLASS, _BENCH = (104, 86, 68), (26, 26, 26), (70, 78, 84), (176, 196, 202), (120, 92, 64)
_ARM_M = 0.95
_WIRES_M = ((-0.85, -0.15), (0.85, -0.15), (0.0, -2.2))
"""Where they hang: along the arm, and how far below the pole's top; the lowest is the telephone's."""
_LONGEST_SPAN_M = 75.0
_SAG = 0.018
_PIECES = 2
_WIRE_HALF_M = 0.012


def utility_poles(frames: PatchFrames, objects: I32) -> Mesh:
    """Return wooden poles with arms along x, transformers on some, and wires from each to the next if that is near."""
    wood = PatchLook(Material.WOOD, SemanticTag.POLES, _WOOD, objects)
    up = np.array([0.0, 0.0, 1.0])
    top = frames.base_m + POLE_HEIGHT_M * up
    third = np.flatnonzero(np.arange(len(frames)) % 3 == 0)
    can = frames.of(third).world(np.broadcast_to(np.array([0.0, 0.4, POLE_HEIGHT_M - 2.0]), (len(third), 1, 3)))[:, 0]
    steel = PatchLook(Material.METAL, SemanticTag.POLES, _STEEL, objects).of(third)
    return join(
        [
            prisms(frames.base_m - 0.4 * up, top, (POLE_HALF_M, 0.7 * POLE_HALF_M), 6, wood, lid=False),
            boxes(frames, (0.0, 0.0, POLE_HEIGHT_M - 0.25), (_ARM_M, 0.05, 0.06), wood, ALL_SIDES),
            prisms(can, can + 0.9 * up, (0.22, 0.22), 7, steel, lid=False),
            _wires(frames),
        ]
    )


def _wires(frames: PatchFrames) -> Mesh:
    """Return wires that sag, three-sided, in pieces."""
    apart = np.hypot(*np.diff(frames.base_m[:, :2], axis=0).T) if len(frames) > 1 else np.empty(0)
    spans = np.flatnonzero((apart > 1.0) & (apart < _LONGEST_SPAN_M))
    look = PatchLook(Material.RUBBER, SemanticTag.POLES, _WIRE)
    parts = []
    for along, below in _WIRES_M:
        place = np.broadcast_to(np.array([along, 0.0, POLE_HEIGHT_M + below]), (len(frames), 1, 3))
        hung = frames.world(place)[:, 0]
        begin, end = hung[spans], hung[spans + 1]
        nodes = [
            begin + share * (end - begin) - np.outer(4.0 * share * (1.0 - share) * _SAG * apart[spans], (0.0, 0.0, 1.0))
            for share in np.linspace(0.0, 1.0, _PIECES + 1)
        ]
        parts += [
            prisms(first, second, (_WIRE_HALF_M, _WIRE_HALF_M), 3, look, lid=False) for first, second in pairwise(nodes)
        ]
    return join(parts)


def shelters(frames: PatchFrames, first: I32) -> Mesh:
    """Return shelters of four boxes each, counted from ``first``: back, two ends, roof; with a bench inside."""
    x, y, z = SHELTER_HALF_M
    tag = SemanticTag.STATIC
    parts = []
    panels = (
        ((x - PANEL_HALF_M, 0.0, z), (PANEL_HALF_M, y, z), 0),
        ((0.0, -(y - PANEL_HALF_M), z), (x, PANEL_HALF_M, z), 1),
        ((0.0, y - PANEL_HALF_M, z), (x, PANEL_HALF_M, z), 2),
    )
    for centre, half, nth in panels:
        objects = first + np.int32(nth)
        glass, steel = PatchLook(Material.GLASS, tag, _GLASS, objects), PatchLook(Material.METAL, tag, _STEEL, objects)
        parts.append(boxes(frames, centre, (half[0], half[1], z - 0.3), glass, ALL_SIDES))
        parts.append(boxes(frames, (centre[0], centre[1], 0.15), (half[0] + 0.01, half[1] + 0.01, 0.15), steel))
        parts += [_posts(frames, centre, half, steel)]
    roof = PatchLook(Material.METAL, tag, _STEEL, first + np.int32(3))
    parts.append(boxes(frames, (-0.15, 0.0, 2.0 * z), (x + 0.2, y + 0.1, 0.06), roof, ALL_SIDES))
    bench = PatchLook(Material.WOOD, tag, _BENCH, first)
    parts.append(boxes(frames, (x - 0.3, 0.0, 0.45), (0.2, 0.8 * y, 0.03), bench, ALL_SIDES))
    return join(parts)


def _posts(
    frames: PatchFrames, centre: tuple[float, float, float], half: tuple[float, float, float], look: PatchLook
) -> Mesh:
    """Return two posts at the ends of a panel."""
    x, y, z = centre
    along = (half[0], 0.0) if half[0] > half[1] else (0.0, half[1])
    size = (0.035, 0.035, z)
    return join([boxes(frames, (x + s * along[0], y + s * along[1], z), size, look) for s in (-1.0, 1.0)])
