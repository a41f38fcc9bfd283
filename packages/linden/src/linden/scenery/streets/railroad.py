"""A railroad across the land: a bed of gravel, ties, two rails; across a street the rails lie in the asphalt."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import PatchLook, polygons, strips
from linden.scenery.streets.road import GRAVEL

F64 = NDArray[np.float64]

_STEP_M = 6.0
_TIE_SPACING_M = 0.6
_TIE_HALF_M = (1.3, 0.11)
_TOP_M, _FOOT_M, _BED_M = 1.7, 2.6, 0.28  # half widths of the bed above and below, and its height
_GAUGE_HALF_M, _RAIL_HALF_M, _RAIL_M = 0.7175 + 0.035, 0.035, 0.15
_TIE_BROWN, _RAIL_STEEL = (78, 66, 56), (122, 104, 92)
_RAMP_M = 30.0  # before a crossing in which the bed comes down to the street
_PANEL, _PANEL_HALF_M, _PANEL_M = (88, 84, 80), 1.4, 0.005  # of rubber and planks, between the rails and beside them
_HIGH_M = 1e6
_CLEAR_M = 3.2
_UP = np.array([0.0, 0.0, 1.0])


def railroad(line_m: F64, roads: Ground, lawn: Ground) -> Mesh:
    """Return the railroad along a line (N, 2); its bed sinks into the ground towards the streets that it crosses."""
    if len(line_m) < 2:
        return join([])
    track = _track(line_m, _STEP_M, roads, lawn)
    line, left, on_road = track.line, track.left, track.on_road
    open_pieces = ~(on_road | np.append(on_road[1:], [True]))
    across = on_road & np.append(on_road[1:], [False])
    gravel = PatchLook(Material.GRAVEL, SemanticTag.RAIL_TRACK, GRAVEL)
    steel = PatchLook(Material.METAL, SemanticTag.RAIL_TRACK, _RAIL_STEEL)
    panel = PatchLook(Material.CONCRETE, SemanticTag.ROADS, _PANEL)
    all_pieces = np.append(np.ones(len(line) - 1, bool), [False])

    def at(aside_m: float, above_m: float | F64) -> F64:
        return np.column_stack([line + aside_m * left, track.z_m + above_m])

    up = np.broadcast_to(_UP, (len(line), 3))
    bed, rail = track.bed_m, track.bed_m + _RAIL_M * track.bed_m / _BED_M
    parts = [
        strips(at(_TOP_M, bed), at(-_TOP_M, bed), open_pieces, gravel, up),
        strips(at(_PANEL_HALF_M, _PANEL_M), at(-_PANEL_HALF_M, _PANEL_M), across, panel, up),
    ]
    for side in (-1.0, 1.0):
        parts.append(strips(at(side * _TOP_M, bed), at(side * _FOOT_M, -0.3), open_pieces, gravel, up))
        # beside a street a rail stands on its tie; across a street only its head shows
        top = np.where(on_road, _PANEL_M + 0.004, rail)
        inner, outer = side * (_GAUGE_HALF_M - _RAIL_HALF_M), side * (_GAUGE_HALF_M + _RAIL_HALF_M)
        parts.append(strips(at(inner, top), at(outer, top), all_pieces, steel, up))
        away = np.column_stack([side * left, np.zeros(len(left))])
        parts.append(strips(at(outer, top), at(outer, bed), open_pieces, steel, away))
        parts.append(strips(at(inner, top), at(inner, bed), open_pieces, steel, -away))
    return join([*parts, _ties(_track(line_m, _TIE_SPACING_M, roads, lawn))])


class _Track(NamedTuple):
    """Places along the railroad in equal steps."""

    line: F64  # (N, 2), m
    left: F64  # (N, 2), across it, length 1
    z_m: F64  # (N,) the ground
    bed_m: F64  # (N,) the bed's height above it
    on_road: NDArray[np.bool_]  # whether a road lies there or close by


def _track(line_m: F64, step_m: float, roads: Ground, lawn: Ground) -> _Track:
    line, left = _sampled(line_m, step_m)
    on_road = np.zeros(len(line), bool)
    for aside in (0.0, _CLEAR_M, -_CLEAR_M):
        points = np.column_stack([line + aside * left, np.full(len(line), _HIGH_M)])
        height, triangle = roads.surfaces_under(points)
        on_road |= triangle >= 0
        if aside == 0.0:
            on_lawn, lawn_triangle = lawn.surfaces_under(points)
            z_m = np.where((lawn_triangle >= 0) & (triangle < 0), on_lawn, height)
    crossings = np.flatnonzero(on_road)
    number = np.arange(len(line))
    apart_m = step_m * np.abs(number[:, None] - crossings[None]).min(axis=1, initial=len(line))
    bed_m = _BED_M * np.clip(apart_m / _RAMP_M, 0.05, 1.0)
    return _Track(line, left, z_m, bed_m, on_road)


def _ties(track: _Track) -> Mesh:
    free = ~track.on_road
    line, left, z = track.line[free], track.left[free], (track.z_m + track.bed_m)[free] + 0.02
    ahead = np.column_stack([left[:, 1], -left[:, 0]])
    wide, deep = _TIE_HALF_M
    sides = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corners = [np.column_stack([line + a * wide * left + b * deep * ahead, z]) for a, b in sides]
    return polygons(np.stack(corners, axis=1), PatchLook(Material.WOOD, SemanticTag.RAIL_TRACK, _TIE_BROWN), _UP)


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
