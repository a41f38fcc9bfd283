"""Crosswalks: a lanelet in the direction people walk, its outline as a polygon, and the road lanelets it crosses."""

from typing import NamedTuple

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables
from linden_maps.lanelet2.areas import inside
from linden_maps.lanelet2.model import Bounds, LaneletMap
from linden_maps.lanelet2.outlines import outline_of
from linden_maps.lanelet2.overlap import area_m2
from linden_maps.polylines import lengths, resampled

_REACH_M = 40.0
_SPACING_M = 0.5


class Crosswalk(NamedTuple):
    """One crosswalk of the map."""

    key: str  # road and object
    outline: F64  # (N, 3)
    left: F64  # (2, 3), in the walking direction
    right: F64  # (2, 3)


def crosswalks_of(tables: Tables) -> list[Crosswalk]:
    """Return the map's crosswalks in the order of the file; those without an area are left out."""
    found = []
    for index, road in enumerate(tables.roads):
        for nth, thing in enumerate(road.objects):
            if not thing.is_crosswalk:
                continue
            outline = outline_of(tables, index, thing)
            if len(outline) < 3 or area_m2(outline[:, :2]) < 1e-3:
                continue
            s_m = np.clip([thing.s_m], 0.0, road.length_m)
            heading = float(tables.curves.pose(np.array([index]), s_m).heading_rad[0])
            found.append(Crosswalk(f"{road.id}/{thing.id}/{nth}", outline, *_sides(outline, heading)))
    return found


def _sides(outline: F64, heading_rad: float) -> tuple[F64, F64]:
    """Return the two long sides of a crosswalk: those of the quadrilateral, or of the box that holds the outline.

    People walk along the longer axis of the outline; a square one is crossed at right angles to its road.
    """
    middle = outline.mean(axis=0)
    flat = outline[:, :2] - middle[:2]
    _, sizes, axes = np.linalg.svd(flat, full_matrices=False)
    across_road = np.array([-np.sin(heading_rad), np.cos(heading_rad)])
    axis = axes[0] if sizes[0] > 1.1 * sizes[1] else across_road
    axis = axis if (axis[0], axis[1]) > (0.0, 0.0) else -axis
    aside = np.array([-axis[1], axis[0]])
    along, away = flat @ axis, flat @ aside
    if len(outline) == 4:
        left = outline[away >= np.sort(away)[2]][:2]
        right = outline[away <= np.sort(away)[1]][:2]
        if len(left) == len(right) == 2:
            return _ordered(left, axis), _ordered(right, axis)
    box = [
        np.array([[*(middle[:2] + a * axis + b * aside), middle[2]] for a in (along.min(), along.max())])
        for b in (away.max(), away.min())
    ]
    return box[0], box[1]


def _ordered(pair: F64, axis: F64) -> F64:
    return pair if (pair[1, :2] - pair[0, :2]) @ axis > 0.0 else pair[::-1]


def crossed(target: LaneletMap, sides: dict[int, Bounds], walks: list[Crosswalk]) -> list[list[int]]:
    """Return for each crosswalk the lanelets with a middle that runs through it."""
    numbers, lines = [], []
    spots = np.array([walk.outline.mean(axis=0)[:2] for walk in walks]).reshape(-1, 2)
    for number, bounds in sides.items():
        corners = np.array([target.nodes[node][:2] for side in bounds for node in side])
        low, high = corners.min(axis=0) - _REACH_M, corners.max(axis=0) + _REACH_M
        if not ((spots > low) & (spots < high)).all(axis=1).any():
            continue
        left, right = (_dense(np.array([target.nodes[n][:3] for n in side])) for side in bounds)
        count = max(len(left), len(right))
        line = (_to(left, count) + _to(right, count)) / 2.0
        numbers.append(np.full(len(line), number))
        lines.append(line)
    if not lines:
        return [[] for _ in walks]
    of_line, points = np.concatenate(numbers), np.concatenate(lines)
    found = []
    for walk in walks:
        middle = walk.outline.mean(axis=0)
        reach = np.abs(walk.outline - middle).max() + 1.0
        near = np.flatnonzero((np.abs(points - middle) < [reach, reach, 3.0]).all(axis=1))
        hit = near[inside(walk.outline[:, :2], points[near, :2])]
        found.append(list(dict.fromkeys(of_line[hit].tolist())))
    return found


def _dense(line: F64) -> F64:
    return resampled(line, max(2, int(lengths(line)[-1] / _SPACING_M) + 1))


def _to(line: F64, count: int) -> F64:
    return line if len(line) == count else resampled(line, count)
