"""Buildings, their name signs, and street furniture as objects of the road that passes nearest to each.

A footprint is kept clear of the paved ground: what lies on it is cut away, because widths are often guessed. A building
that would lose more than half of its ground is left out and counted.
"""

import math
import textwrap
from collections.abc import Iterator
from typing import NamedTuple

from shapely import LineString, MultiPolygon, Point, Polygon, STRtree, unary_union
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from linden_maps.streets.cross_section import View, view
from linden_maps.streets.curves import Path, Pose, length, moved, pose_at, sampled, seen_from
from linden_maps.streets.document import Object
from linden_maps.streets.name_signs import BLADE, HEIGHT_M, PLACE_NAME, POST_HALF_M
from linden_maps.streets.name_signs import KIND as SIGN_KIND
from linden_maps.streets.network import Network
from linden_maps.streets.street_facts import Building, Facts, Furniture

CLEAR_M = 0.3  # between a wall and the paved ground
SMALLEST_M2 = 4.0
LEAST_SHARE = 0.5  # of a building's ground that has to be free of streets
SIZE_M = {"bench": (1.8, 0.6, 0.8), "bin": (0.6, 0.6, 1.0), "mailbox": (0.6, 0.6, 1.3)}
"""Length along the street, width and height of furniture; estimates of usual sizes."""
SIGN_BEFORE_WALL_M = 1.0  # an estimate, as is the length of its lines
LINE_LETTERS = 24


class Standing(NamedTuple):
    """Objects (numbered 0) with the edge that each belongs to, and the ids of what has no room.

    ``signs`` are the name signs of the buildings. A sign without room is left out under the id of its building.
    """

    objects: tuple[tuple[int, Object], ...]
    left_out: tuple[str, ...]
    signs: tuple[tuple[int, Object], ...] = ()


def standing(facts: Facts, network: Network) -> Standing:
    """Return what stands beside the roads of a network."""
    if not facts.buildings and not facts.furniture:
        return Standing((), ())
    roads = _Roads(network)
    placed: list[tuple[int, Object]] = []
    signs: list[tuple[int, Object]] = []
    left_out = []
    for building in facts.buildings:
        found = _building(building, roads)
        if found is None:
            left_out.append(building.id)
            continue
        placed.append(found)
        if building.sign_confidence:
            sign = _sign(building, roads)
            if sign is None:
                left_out.append(building.id)
            else:
                signs.append(sign)
    for thing in facts.furniture:
        if roads.is_paved(Point(thing.point)):
            left_out.append(thing.id)
        else:
            placed.append(_furniture(thing, roads))
    return Standing(tuple(placed), tuple(left_out), tuple(signs))


class _Roads:
    """The roads of a network as lines, with what is paved about them."""

    def __init__(self, network: Network) -> None:
        self._roads = [(number, road) for number, road in enumerate(network.roads) if road is not None]
        lines = [LineString([pose[:2] for pose in sampled(road, 1.0)]) for _, road in self._roads]
        self._lines = STRtree(lines)
        self._paved = STRtree([*_along_roads(network, self._roads, lines), *_in_junctions(network)])

    def place(self, point: Point) -> tuple[int, Path, float]:
        """Return the edge of the road nearest to a point, the road, and how far along it."""
        row = int(self._lines.nearest(point))
        edge, road = self._roads[row]
        return edge, road, min(float(self._lines.geometries[row].project(point)), length(road))

    def is_paved(self, ground: BaseGeometry) -> bool:
        """Return whether something lies on paved ground."""
        return bool(len(self._paved.query(ground, predicate="intersects")))

    def clear_of(self, ground: Polygon) -> Polygon | None:
        """Return the largest part of a footprint that is free of paved ground, None where it is too small."""
        near = [self._paved.geometries[int(row)] for row in self._paved.query(ground)]
        rest = ground.difference(unary_union(near)) if near else ground
        parts = list(rest.geoms) if isinstance(rest, MultiPolygon) else [rest]
        free = [part for part in parts if isinstance(part, Polygon)]
        best = max(free, key=lambda part: part.area, default=None)
        if best is None or best.area < max(SMALLEST_M2, LEAST_SHARE * ground.area):
            return None
        return best


def _along_roads(network: Network, roads: list[tuple[int, Path]], lines: list[LineString]) -> Iterator[BaseGeometry]:
    for (number, _), line in zip(roads, lines, strict=True):
        half_m = _half_m(view(network.edges[number].section, along=True))
        yield line.buffer(half_m + CLEAR_M, cap_style="flat")


def _in_junctions(network: Network) -> Iterator[BaseGeometry]:
    for _, legs in network.junctions:
        mouths = [moved(leg.pose, left_m=leg.view.kerb_m(right=right))[:2] for leg in legs for right in (False, True)]
        yield LineString(mouths).convex_hull.buffer(CLEAR_M)


def _half_m(seen: View) -> float:
    return max(abs(seen.kerb_m(right=True)), abs(seen.kerb_m(right=False)))


def _building(building: Building, roads: _Roads) -> tuple[int, Object] | None:
    ground = Polygon(building.ring)
    if not ground.is_valid:
        ground = ground.buffer(0.0)
    free = roads.clear_of(ground)
    if free is None:
        return None
    free = free.simplify(0.1)  # type: ignore[assignment]  # a polygon stays one
    middle = Point(round(free.centroid.x, 3), round(free.centroid.y, 3))
    corners = [(x, y) for x, y in free.exterior.coords]
    if not free.exterior.is_ccw:
        corners.reverse()
    name = building.name or ("building" if building.kind == "yes" else building.kind)
    return _object(roads, middle, ("building", name), corners, building.height_m, building.confidence)


def _sign(building: Building, roads: _Roads) -> tuple[int, Object] | None:
    """Return the sign with a building's name, before the wall that is nearest to the road; None without room there.

    The sign stands across the road, so that drivers of both directions read it. A long name has several lines.
    """
    ground = Polygon(building.ring)
    _, road, s_m = roads.place(ground.centroid)
    wall, axis = nearest_points(ground, Point(pose_at(road, s_m)[:2]))
    away_m = wall.distance(axis)
    if away_m <= SIGN_BEFORE_WALL_M:
        return None
    share = SIGN_BEFORE_WALL_M / away_m
    foot = Point(round(wall.x + share * (axis.x - wall.x), 3), round(wall.y + share * (axis.y - wall.y), 3))
    if roads.is_paved(foot):
        return None
    _, road, s_m = roads.place(foot)
    at = pose_at(road, s_m)._replace(x_m=foot.x, y_m=foot.y)
    half = POST_HALF_M
    ends = ((-half, -half), (half, -half), (half, half), (-half, half), (-half, -half))
    corners = [moved(at, u, v)[:2] for u, v in ends]
    edge, post = _object(roads, foot, (SIGN_KIND, PLACE_NAME), corners, HEIGHT_M, building.sign_confidence)
    lines = textwrap.wrap(building.name, LINE_LETTERS)
    return edge, post._replace(notes=tuple((BLADE, f"{math.pi / 2:.3f} {line}") for line in lines))


def _furniture(thing: Furniture, roads: _Roads) -> tuple[int, Object]:
    along_m, across_m, height_m = SIZE_M[thing.kind]
    middle = Point(thing.point)
    _, road, s_m = roads.place(middle)
    at = pose_at(road, s_m)._replace(x_m=thing.point[0], y_m=thing.point[1])
    half_u, half_v = along_m / 2, across_m / 2
    ends = ((-half_u, -half_v), (half_u, -half_v), (half_u, half_v), (-half_u, half_v), (-half_u, -half_v))
    corners = [moved(at, u, v)[:2] for u, v in ends]
    return _object(roads, middle, ("obstacle", thing.kind), corners, height_m, thing.confidence)


def _object(
    roads: _Roads,
    middle: Point,
    kind_name: tuple[str, str],
    corners: list[tuple[float, float]],
    height_m: float,
    confidence: str,
) -> tuple[int, Object]:
    """Return an object about its middle, its outline in the frame of the road there."""
    edge, road, s_m = roads.place(middle)
    s_m = round(s_m, 3)
    beside = pose_at(road, s_m)
    t_m = round(seen_from(beside, (middle.x, middle.y))[1], 3)
    origin: Pose = moved(beside, left_m=t_m)
    outline = tuple((round(u, 3), round(v, 3)) for u, v in (seen_from(origin, corner) for corner in corners))
    kind, name = kind_name
    plain = name.replace("rosswalk", "rossing")  # LibCarla takes every object named crosswalk for one
    return edge, Object(0, plain, kind, s_m, t_m, 0.0, outline, confidence, height_m)
