"""Draws what vehicles and people walk on: the lanes' areas by type, and the marks painted on them."""

from collections import defaultdict
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from linden.geometry import points_from_opendrive
from linden.maps.opendrive.evaluate.strips import edges_of, strips_of
from linden.maps.opendrive.evaluate.tables import Tables
from linden.maps.opendrive.model import RoadMark
from linden.protocol.values.enums import LaneType
from linden_maps.drawing.style import ASPHALT, OTHER_SURFACE, PAINT, SURFACES, YELLOW, group, path
from linden_maps.polylines import places_at

Corners = NDArray[np.float64]  # (N, 2), m, CARLA's frame, which is SVG's: x to the right, y down

_MARK_WIDTH_M = 0.12
# stripe and gap of a broken line: MUTCD 2009, section 3A.06: 10 ft and 30 ft
_BROKEN = "3.05 9.14"
_UNPAINTED = {"none", "curb", "grass", "edge", "custom"}


def surfaces(tables: Tables) -> list[str]:
    """Return the lanes' areas, one path for each type."""
    strips = strips_of(tables)
    edges = edges_of(tables, strips)
    inner, outer = (points_from_opendrive(edge)[:, :2] for edge in edges)
    begins = np.flatnonzero(np.diff(strips.lane, prepend=-1)).tolist()
    areas: dict[int, list[Corners]] = defaultdict(list)
    for first, last in pairwise([*begins, len(strips.lane)]):
        ring = np.concatenate([inner[first:last], outer[first:last][::-1]])
        areas[int(tables.lanes["type_bits"][strips.lane[first]])].append(ring)
    drawn = []
    others = [ring for bits, rings in areas.items() if LaneType(bits) not in SURFACES for ring in rings]
    for name, colour, rings in (
        (*OTHER_SURFACE, others),
        *((name, colour, areas[int(kind)]) for kind, (name, colour) in SURFACES.items()),
    ):
        # a thin line of the same colour closes the hairlines between neighbours
        style = f'fill="{colour}" stroke="{colour}" stroke-width="0.05"'
        drawn += group(name, style, [f'<path d="{path(rings, closed=True)}"/>'] if rings else [])
    return drawn


def marks(tables: Tables) -> list[str]:
    """Return the lines painted along the lanes' edges and the middle of the road."""
    lines: dict[tuple[str, bool, bool, float], list[Corners]] = defaultdict(list)
    for mark, line in _mark_lines(tables):
        colour = YELLOW if mark.colour == "yellow" else PAINT
        width_m = mark.width_m or _MARK_WIDTH_M
        lines[colour, mark.type.startswith("broken"), " " in mark.type, width_m].append(line)
    drawn = []
    for (colour, is_broken, is_double, width_m), paths in lines.items():
        dashes = f' stroke-dasharray="{_BROKEN}"' if is_broken else ""
        data = path(paths, closed=False)
        whole_m = 3.0 * width_m if is_double else width_m
        drawn.append(f'<path d="{data}" stroke="{colour}" stroke-width="{whole_m:.2f}"{dashes}/>')
        if is_double:  # the road shows between the two lines
            drawn.append(f'<path d="{data}" stroke="{ASPHALT}" stroke-width="{width_m:.2f}"/>')
    return group("marks", 'fill="none"', drawn)


def _mark_lines(tables: Tables) -> list[tuple[RoadMark, Corners]]:
    """Return every painted mark with the line it follows."""
    strips = strips_of(tables)
    edges = edges_of(tables, strips)
    inner, outer = (points_from_opendrive(edge)[:, :2] for edge in edges)
    first = np.searchsorted(strips.lane, np.arange(len(tables.lanes) + 1))
    s_m = strips.s_m
    found = []
    for road_index, road in enumerate(tables.roads):
        for section_index, section in enumerate(road.sections):
            for lane in section.lanes:
                # the centre line is the inner edge of the first lane on either side
                own = [lane.id] if lane.id else [-1, 1]
                rows = [tables.lane_row.get((road_index, section_index, lane_id)) for lane_id in own]
                row = next((row for row in rows if row is not None), None)
                if row is None:
                    continue
                line = (outer if lane.id else inner)[first[row] : first[row + 1]]
                along_m = s_m[first[row] : first[row + 1]] - section.s_m
                ends_m = [*(mark.offset_m for mark in lane.marks), section.end_m - section.s_m][1:]
                for mark, end_m in zip(lane.marks, ends_m, strict=True):
                    if mark.type not in _UNPAINTED and end_m > mark.offset_m:
                        found.append((mark, _between(line, along_m, mark.offset_m, end_m)))
    return found


def _between(line: Corners, along_m: Corners, start_m: float, end_m: float) -> Corners:
    """Return the part of a line between two places along it."""
    places = np.unique(np.concatenate([[start_m], along_m[(along_m > start_m) & (along_m < end_m)], [end_m]]))
    return places_at(line, along_m, places)
