"""A railroad across the land: a bed of gravel, ties, two rails; across a street the rails lie in the asphalt."""

import numpy as np
from numpy.typing import NDArray

from linden.ground import Ground
from linden.meshes.mesh import Material, Mesh, join
from linden.meshes.patches import Look, polygons, strips
from linden.meshes.road import GRAVEL
from linden.values.enums import SemanticTag

F64 = NDArray[np.float64]

_STEP_M = 6.0
_TIE_SPACING_M = 0.6
_TIE_HALF_M = (1.3, 0.11)
_TOP_M, _FOOT_M, _BED_M = 1.7, 2.6, 0.28  # half widths of the bed above and below, and its height
_GAUGE_HALF_M, _RAIL_HALF_M, _RAIL_M = 0.7175 + 0.035, 0.035, 0.15
_TIE_BROWN, _RAIL_STEEL = (78, 66, 56), (122, 104, 92)
_HIGH_M = 1e6
_CLEAR_M = 3.2
_UP = np.array([0.0, 0.0, 1.0])


def railroad(line_m: F64, ground: Ground) -> Mesh:
    """Return the railroad along a line (N, 2)."""
    if len(line_m) < 2:
        return join([])
    line, left = _sampled(line_m, _STEP_M)
    z, on_road = _heights(line, left, ground)
    free = ~on_road
    open_pieces = free & np.append(free[1:], [False])
    gravel = Look(Material.GRAVEL, SemanticTag.RAIL_TRACK, GRAVEL)
    steel = Look(Material.METAL, SemanticTag.RAIL_TRACK, _RAIL_STEEL)
    all_pieces = np.append(np.ones(len(line) - 1, bool), [False])

    def at(aside_m: float, above_m: float | F64) -> F64:
        return np.column_stack([line + aside_m * left, z + above_m])

    up = np.broadcast_to(_UP, (len(line), 3))
    parts = [strips(at(_TOP_M, _BED_M), at(-_TOP_M, _BED_M), open_pieces, gravel, up)]
    for side in (-1.0, 1.0):
        parts.append(strips(at(side * _TOP_M, _BED_M), at(side * _FOOT_M, -0.3), open_pieces, gravel, up))
        # beside a street a rail stands on its tie; across a street only its head shows
        top = np.where(on_road, 0.008, _BED_M + _RAIL_M)
        inner, outer = side * (_GAUGE_HALF_M - _RAIL_HALF_M), side * (_GAUGE_HALF_M + _RAIL_HALF_M)
        parts.append(strips(at(inner, top), at(outer, top), all_pieces, steel, up))
        away = np.column_stack([side * left, np.zeros(len(left))])
        parts.append(strips(at(outer, top), at(outer, _BED_M), open_pieces, steel, away))
        parts.append(strips(at(inner, top), at(inner, _BED_M), open_pieces, steel, -away))
    return join([*parts, _ties(line_m, ground)])


def _ties(line_m: F64, ground: Ground) -> Mesh:
    line, left = _sampled(line_m, _TIE_SPACING_M)
    z, on_road = _heights(line, left, ground)
    line, left, z = line[~on_road], left[~on_road], z[~on_road]
    ahead = np.column_stack([left[:, 1], -left[:, 0]])
    wide, deep = _TIE_HALF_M
    corners = np.stack(
        [
            np.column_stack([line + a * wide * left + b * deep * ahead, z + _BED_M + 0.02])
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ],
        axis=1,
    )
    return polygons(corners, Look(Material.WOOD, SemanticTag.RAIL_TRACK, _TIE_BROWN), _UP)


def _sampled(line_m: F64, step_m: float) -> tuple[F64, F64]:
    """Return places along a line in equal steps, its corners rounded, and unit vectors across it."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line_m, axis=0).T))])
    fine = np.arange(0.0, along[-1], 1.0)
    dense = np.column_stack([np.interp(fine, along, line_m[:, axis]) for axis in range(2)])
    kernel = np.ones(61) / 61.0  # a minute's walk: rails do not bend at once
    padded = np.concatenate([np.repeat(dense[:1], 30, axis=0), dense, np.repeat(dense[-1:], 30, axis=0)])
    smooth = np.column_stack([np.convolve(padded[:, axis], kernel, mode="valid") for axis in range(2)])
    at = np.arange(0.0, fine[-1], step_m)
    line = np.column_stack([np.interp(at, fine, smooth[:, axis]) for axis in range(2)])
    ahead = np.gradient(line, axis=0)
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    return line, np.column_stack([ahead[:, 1], -ahead[:, 0]])


def _heights(line: F64, left: F64, ground: Ground) -> tuple[F64, NDArray[np.bool_]]:
    """Return the ground's heights along the line and whether a road lies there or close by."""
    found = [
        ground.surfaces_under(np.column_stack([line + aside * left, np.full(len(line), _HIGH_M)]))
        for aside in (0.0, _CLEAR_M, -_CLEAR_M)
    ]
    on_road: NDArray[np.bool_] = np.any([triangle >= 0 for _, triangle in found], axis=0)
    return found[0][0], on_road
