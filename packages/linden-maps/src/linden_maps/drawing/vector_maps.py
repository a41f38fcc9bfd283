"""Draws Lanelet2 and Aisan maps as SVG, alone or over their OpenDRIVE map; north up, one unit a metre, y down."""

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.model import OpenDrive
from linden_maps.aisan.reading import Folder
from linden_maps.aisan.tables import COLUMNS
from linden_maps.drawing.style import ASPHALT, GRASS, GREEN, INK, PAINT, RED, SPAWN, YELLOW, group, path
from linden_maps.drawing.surfaces import marks, surfaces
from linden_maps.lanelet2.model import LaneletMap, LaneletWay, bounds_of
from linden_maps.polylines import lengths, places_at

F64 = NDArray[np.float64]

_MARGIN_M = 20.0
_LONGER_SIDE_PX = 1800
_AREAS = {"road": "#6f8fae", "road_shoulder": "#9a9f76", "walkway": "#d9b99b", "bicycle_lane": "#a4655a"}
_LINES = {  # type of a way: colour, width in m
    "line_thin": (PAINT, 0.15),
    "line_thick": (PAINT, 0.3),
    "road_border": (INK, 0.15),
    "curbstone": (INK, 0.15),
    "virtual": ("#4a6f94", 0.06),
    "stop_line": (RED, 0.4),
    "traffic_sign": (RED, 0.3),
    "traffic_light": (GREEN, 0.3),
}
_ARROW_EVERY_M = 12.0


class Window(NamedTuple):
    """A square to be drawn: its middle in the map's frame, and its side."""

    x_m: float
    y_m: float
    side_m: float


def lanelet2_svg(lanelet_map: LaneletMap, under: OpenDrive | None = None, window: Window | None = None) -> str:
    """Return a drawing of a Lanelet2 map: lanelets by subtype, bounds by type, directions, areas, devices."""
    layers: list[str] = []
    areas: dict[str, list[F64]] = defaultdict(list)
    arrows: list[F64] = []
    for _, relation in lanelet_map.lanelets():
        bounds = bounds_of(lanelet_map, relation)
        left, right = (_flat(lanelet_map, side) for side in bounds)
        areas[relation.tags.get("subtype", "")].append(np.concatenate([left, right[::-1]]))
        if relation.tags.get("subtype") == "road":
            arrows += _arrows(_halved(left, right))
    opacity = 0.35 if under else 0.9
    for subtype, rings in areas.items():
        style = f'fill="{_AREAS.get(subtype, PAINT)}" fill-opacity="{opacity}"'
        layers += group(subtype, style, [f'<path d="{path(rings, closed=True)}"/>'])
    rings = [_flat(lanelet_map, way.nodes) for way in lanelet_map.ways.values() if _is(way, "intersection_area")]
    style = f'fill="{YELLOW}" fill-opacity="0.15" stroke="{YELLOW}" stroke-width="0.3"'
    layers += group("intersection-areas", style, [f'<path d="{path(rings, closed=True)}"/>'] if rings else [])
    for kind, (colour, width_m) in _LINES.items():
        for dashed in (False, True):
            lines = [
                _flat(lanelet_map, way.nodes)
                for way in lanelet_map.ways.values()
                if _is(way, kind) and way.tags.get("subtype", "").startswith("dashed") is dashed
            ]
            layers += _stroked(kind, colour, width_m, lines, dashed=dashed)
    layers += _stroked("directions", SPAWN, 0.15, arrows)
    return _svg(layers, np.array([node[:2] for node in lanelet_map.nodes.values()]), under, window)


def aisan_svg(folder: Folder, under: OpenDrive | None = None, window: Window | None = None) -> str:
    """Return a drawing of an Aisan map: rows of lanes with branches and merges, paint, edges, areas, devices."""
    place = {int(row[0]): np.array([row[5], -row[4]]) for row in folder["point"]}  # Ly east, Bx north
    point_of_node = dict(folder["node"].astype(np.int64).tolist())
    segment = {int(r[0]): np.stack([place[int(r[1])], place[int(r[2])]]) for r in folder.get("line", np.empty((0, 5)))}
    column = {name: COLUMNS["lane"].index(name) for name in ("BNID", "FNID", "JCT", "ClossID")}
    rows: dict[str, list[F64]] = defaultdict(list)
    for row in folder["lane"]:
        ends = [place[point_of_node[int(row[column[name]])]] for name in ("BNID", "FNID")]
        colour = RED if row[column["JCT"]] else YELLOW if row[column["ClossID"]] else SPAWN
        rows[colour].append(np.stack(ends))
    layers: list[str] = []
    if under is None:
        rings = _rings(folder, "wayarea", segment)
        layers += group("way-areas", f'fill="{ASPHALT}"', [f'<path d="{path(rings, closed=True)}"/>'])
    rings = _rings(folder, "intersection", segment)
    style = f'fill="{YELLOW}" fill-opacity="0.15" stroke="{YELLOW}" stroke-width="0.3"'
    layers += group("intersections", style, [f'<path d="{path(rings, closed=True)}"/>'] if rings else [])
    rings = _rings(folder, "crosswalk", segment)
    layers += group("crosswalks", f'fill="{PAINT}" fill-opacity="0.6"', [f'<path d="{path(rings, closed=True)}"/>'])
    for name, colour, width_m in (("roadedge", INK, 0.15), ("whiteline", PAINT, 0.15), ("stopline", RED, 0.4)):
        found = folder.get(name, np.empty((0, 6)))
        gaps = found[:, 4] == 2 if name == "whiteline" else np.zeros(len(found), np.bool_)
        layers += _stroked(name, colour, width_m, [segment[int(number)] for number in found[~gaps, 1]])
    for colour in (SPAWN, YELLOW, RED):
        layers += _stroked("lanes", colour, 0.25, rows[colour])
    of_vector = {int(row[0]): place[int(row[1])] for row in folder.get("vector", np.empty((0, 4)))}
    for name, colour in (("signaldata", GREEN), ("roadsign", RED)):
        spots = [of_vector[int(row[1])] for row in folder.get(name, np.empty((0, 5)))]
        layers += group(name, f'fill="{colour}"', [f'<circle cx="{x:.2f}" cy="{y:.2f}" r="0.6"/>' for x, y in spots])
    return _svg(layers, folder["point"][:, [5, 4]], under, window)


def _is(way: LaneletWay, kind: str) -> bool:
    return way.tags.get("type") == kind


def _flat(lanelet_map: LaneletMap, nodes: tuple[int, ...]) -> F64:
    return np.array([lanelet_map.nodes[node][:2] for node in nodes]) * [1.0, -1.0]


def _halved(left: F64, right: F64) -> F64:
    """Return a line between two others, at as many places as the longer one needs."""
    count = max(len(left), len(right), 2)
    share = np.linspace(0.0, 1.0, 4 * count)
    lines = []
    for side in (left, right):
        length = lengths(side)
        lines.append(places_at(side, length, share * length[-1]))
    middle: F64 = (lines[0] + lines[1]) / 2.0
    return middle


def _arrows(line: F64) -> list[F64]:
    """Return small arrow heads along a line."""
    length = lengths(line)
    heads = []
    for at_m in np.arange(min(_ARROW_EVERY_M, length[-1]) / 2.0, length[-1], _ARROW_EVERY_M):
        nth = min(int(np.searchsorted(length, at_m)), len(line) - 1)
        step = line[nth] - line[nth - 1]
        along = step / max(float(np.linalg.norm(step)), 1e-9)
        aside = np.array([-along[1], along[0]])
        heads.append(
            np.stack([line[nth] - 0.7 * along + 0.4 * aside, line[nth], line[nth] - 0.7 * along - 0.4 * aside])
        )
    return heads


def _stroked(name: str, colour: str, width_m: float, lines: list[F64], *, dashed: bool = False) -> list[str]:
    dashes = ' stroke-dasharray="3.05 9.14"' if dashed else ""
    style = f'fill="none" stroke="{colour}" stroke-width="{width_m}"{dashes}'
    return group(name, style, [f'<path d="{path(lines, closed=False)}"/>'] if lines else [])


def _rings(folder: Folder, name: str, segment: dict[int, F64]) -> list[F64]:
    areas = {int(row[0]): (int(row[1]), int(row[2])) for row in folder.get("area", np.empty((0, 3)))}
    found = folder.get(name, np.empty((0, 3)))
    return [
        np.stack([segment[line][0] for line in range(areas[int(row[1])][0], areas[int(row[1])][1] + 1)])
        for row in found
    ]


def _svg(layers: list[str], points: F64, under: OpenDrive | None, window: Window | None) -> str:
    """Return the document around layers; ``points`` are all places (N, 2), y north."""
    if window is not None:
        left, top = window.x_m - window.side_m / 2.0, -window.y_m - window.side_m / 2.0
        width = height = window.side_m
    else:
        low, high = points.min(axis=0) - _MARGIN_M, points.max(axis=0) + _MARGIN_M
        left, top, width, height = float(low[0]), -float(high[1]), *(float(v) for v in high - low)
    scale = _LONGER_SIDE_PX / max(width, height)
    size = f'width="{width * scale:.0f}" height="{height * scale:.0f}"'
    box = f"{left:.1f} {top:.1f} {width:.1f} {height:.1f}"
    ground = f'<rect x="{left:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{GRASS}"/>'
    below = [] if under is None else [*surfaces(tables_of(under)), *marks(tables_of(under))]
    head = f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="{box}" font-family="sans-serif">'
    return "\n".join([head, ground, *below, *layers, "</svg>\n"])
