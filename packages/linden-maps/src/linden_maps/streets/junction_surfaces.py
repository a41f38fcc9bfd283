"""The surface of each junction: a plane fitted to the ground, on which all roads of the junction lie.

LibCarla knows no superelevation, so a street is level from side to side, also where it meets a junction on a slope.
The surface therefore blends the plane with the level ends of the streets. The roads inside are laid on it with all
lanes, so that lanes that cross have one height.
"""

import math
from collections.abc import Iterator, Sequence
from operator import mul
from typing import NamedTuple

from linden_maps.streets.cross_section import RAISED
from linden_maps.streets.curves import Point, Pose, length, moved, pose_at, seen_from
from linden_maps.streets.document import Cubic, EdgeHeights, LaneRecord, RoadRecord, eased, value
from linden_maps.streets.network import End, Leg
from linden_maps.streets.street_facts import AnyGround, Profile

LEVELLING_ROUNDS = 100
FIT_ROUNDS = 10
FIT_STEP_M = 2.0
OUTLIER_M = 0.05  # ground further from the plane than this counts less (Huber's weights)
BLEND_M = 4.0  # from a street's end to where the plane counts as much as the end
KNOT_M = 2.0  # between the heights given along a road of a junction
TILT_STEP_M = 1.0  # between the places where the edges of its lanes are looked up
TILT_M = 0.004  # by which an edge must have moved for a new record


class Plane(NamedTuple):
    """A plane: its height at a point, and its rise per metre east and north."""

    point: Point
    height_m: float
    east: float
    north: float

    def at(self, x_m: float, y_m: float) -> float:
        """Return the height in m at a place."""
        return self.height_m + self.east * (x_m - self.point[0]) + self.north * (y_m - self.point[1])

    def slope(self, heading_rad: float) -> float:
        """Return the rise per metre in a direction."""
        return self.north * math.sin(heading_rad) + self.east * math.cos(heading_rad)


class StreetEnd(NamedTuple):
    """The line on which a street meets a junction: level from kerb to kerb, rising by ``slope`` into the junction."""

    pose: Pose
    kerbs_m: tuple[float, float]  # left of the pose: of the right kerb and of the left one
    height_m: float
    slope: float


class JunctionHeights(NamedTuple):
    """The heights inside a junction: those of the street ends near them, those of the plane elsewhere."""

    plane: Plane
    ends: tuple[StreetEnd, ...]

    @property
    def is_level(self) -> bool:
        """Whether all of it has one height."""
        return self.plane.east == self.plane.north == 0.0 and len({end.height_m for end in self.ends}) == 1

    def height_m(self, x_m: float, y_m: float) -> float:
        """Return the height in m at a place: the mean of plane and street ends, weighted by 1 / distance squared.

        Source: Shepard 1968, "A two-dimensional interpolation function for irregularly-spaced data", ACM National
        Conference; each datum is a plane here, so that slopes are kept as well.
        """
        weights, heights = [BLEND_M**-2], [self.plane.at(x_m, y_m)]
        for end in self.ends:
            ahead_m, left_m = seen_from(end.pose, (x_m, y_m))
            beside_m = left_m - min(max(left_m, end.kerbs_m[0]), end.kerbs_m[1])
            weights.append(1.0 / max(ahead_m**2 + beside_m**2, 1e-12))
            heights.append(end.height_m + end.slope * ahead_m)
        return _sum_of_products(weights, heights) / math.fsum(weights)


def surfaces(
    ground: AnyGround,
    junctions: Sequence[tuple[Leg, ...]],
    roads_m: Sequence[float | None],
    lifts_m: Sequence[float],
) -> tuple[JunctionHeights, ...]:
    """Return each junction's surface, lifted by the mean lift of its nodes; ``roads_m``: None inside junctions."""
    planes = levelled(ground.profile, [fitted(ground, legs) for legs in junctions], junctions, roads_m)
    found = []
    for plane, legs in zip(planes, junctions, strict=True):
        ends = tuple(
            StreetEnd(
                leg.pose,
                (leg.view.kerb_m(right=True), leg.view.kerb_m(right=False)),
                round(plane.at(*leg.pose[:2]), 6) + lifts_m[leg.node],
                plane.slope(leg.pose.heading_rad),
            )
            for leg in legs
        )
        lift_m = math.fsum(lifts_m[leg.node] for leg in legs) / len(legs)
        found.append(JunctionHeights(plane._replace(height_m=plane.height_m + lift_m), ends))
    return tuple(found)


def fitted(ground: AnyGround, legs: tuple[Leg, ...]) -> Plane:
    """Return the plane of a junction, no steeper than the profile's ``tilt``: level at the mean height where that is 0.

    Least squares with Huber's weights, so that a wall or a ditch in the ground does not tilt a junction.
    """
    count = len(legs)
    middle = math.fsum(leg.pose.x_m for leg in legs) / count, math.fsum(leg.pose.y_m for leg in legs) / count
    if not ground.profile.tilt:
        mean_m = math.fsum(ground.height_m(*leg.pose[:2]) for leg in legs) / count
        return Plane(middle, mean_m, 0.0, 0.0)
    points = [(*point, ground.height_m(*point)) for leg in legs for point in _places(leg, middle, count)]
    plane = Plane(middle, points[0][2], 0.0, 0.0)
    for nth in range(FIT_ROUNDS):
        rests_m = [abs(z - plane.at(x, y)) if nth else 0.0 for x, y, z in points]
        weights = [OUTLIER_M / max(rest_m, OUTLIER_M) for rest_m in rests_m]
        plane = _bounded(_least_squares(points, weights, middle), ground.profile.tilt)
        total = math.fsum(weights)
        rest_m = _sum_of_products(weights, [z - plane.at(x, y) for x, y, z in points]) / total
        plane = plane._replace(height_m=plane.height_m + rest_m)
    return plane


def levelled(
    profile: Profile,
    planes: Sequence[Plane],
    junctions: Sequence[tuple[Leg, ...]],
    roads_m: Sequence[float | None],
) -> tuple[Plane, ...]:
    """Return the planes, raised or lowered until no road between two junctions is too steep.

    Where a road would rise by more than the profile allows, both its junctions give way by half the rest; a few rounds
    of that settle.
    """
    at = {leg.end: (number, leg) for number, legs in enumerate(junctions) for leg in legs}
    links = []
    for edge, road_m in enumerate(roads_m):
        begin, end = at.get(End(edge, at_end=False)), at.get(End(edge, at_end=True))
        if road_m is None or begin is None or end is None:
            continue
        (a, leg_a), (b, leg_b) = begin, end
        slopes = -planes[a].slope(leg_a.pose.heading_rad) + planes[b].slope(leg_b.pose.heading_rad)
        apart_m = _above_m(planes[b], leg_b) - _above_m(planes[a], leg_a)
        links.append((a, b, apart_m, [_most_rise_m(profile, road_m, sign * slopes) for sign in (1.0, -1.0)]))
    found = [plane.height_m for plane in planes]
    for _ in range(LEVELLING_ROUNDS):
        for a, b, apart_m, (most_up_m, most_down_m) in links:
            rise_m = found[b] - found[a] + apart_m
            most_m = most_up_m if rise_m > 0.0 else most_down_m
            rest_m = math.copysign(max(abs(rise_m) - most_m, 0.0), rise_m) / 2
            found[a] += rest_m
            found[b] -= rest_m
    return tuple(plane._replace(height_m=round(height_m, 3)) for plane, height_m in zip(planes, found, strict=True))


def laid(record: RoadRecord, surface: JunctionHeights) -> RoadRecord:
    """Return a road of a junction with its heights: the reference line and the lanes' edges lie on the surface.

    What stands on the right of a kerb stays level from side to side.
    """
    if surface.is_level:
        return record._replace(elevation=(Cubic(0.0, surface.ends[0].height_m),))
    total_m = length(record.path)
    count = math.ceil(total_m / KNOT_M)
    knots = [total_m * i / count for i in range(count + 1)]
    points = [_height_and_slope(surface, record, s_m, total_m) for s_m in knots]
    elevation = tuple(
        eased(s, after - s, (z, z_after), (g, g_after))
        for s, after, (z, g), (z_after, g_after) in zip(knots, knots[1:], points, points[1:], strict=False)
    )
    record = record._replace(elevation=elevation)
    return record._replace(
        left=tuple(_tilted(lane, record, surface) for lane in record.left),
        right=tuple(lane if lane.kind in RAISED else _tilted(lane, record, surface) for lane in record.right),
    )


def _places(leg: Leg, middle: Point, count: int) -> Iterator[Point]:
    """Yield places on a street's half of a junction, from kerb to kerb; ahead as far as the node at a street's end."""
    reach_m = leg.setback_m if count == 1 else max(seen_from(leg.pose, middle)[0], FIT_STEP_M)
    kerbs_m = leg.view.kerb_m(right=True), leg.view.kerb_m(right=False)
    steps = math.ceil(reach_m / FIT_STEP_M)
    for i in range(steps + 1):
        for left_m in (kerbs_m[0], math.fsum(kerbs_m) / 2, kerbs_m[1]):
            yield moved(leg.pose, reach_m * i / steps, left_m)[:2]


def _least_squares(points: Sequence[tuple[float, float, float]], weights: Sequence[float], middle: Point) -> Plane:
    """Return the plane with the least weighted squares; level where all points lie on one line."""
    total = math.fsum(weights)
    x0, y0, z0 = (_sum_of_products(weights, axis) / total for axis in zip(*points, strict=True))
    rows = [(w, x - x0, y - y0, z - z0) for w, (x, y, z) in zip(weights, points, strict=True)]
    xx, yy = math.fsum(w * x * x for w, x, _, _ in rows), math.fsum(w * y * y for w, _, y, _ in rows)
    xy = math.fsum(w * x * y for w, x, y, _ in rows)
    xz, yz = math.fsum(w * x * z for w, x, _, z in rows), math.fsum(w * y * z for w, _, y, z in rows)
    det = xx * yy - xy * xy
    if det <= 1e-9 * (xx + yy) ** 2:
        return Plane(middle, z0, 0.0, 0.0)
    east, north = (xz * yy - yz * xy) / det, (yz * xx - xz * xy) / det
    return Plane(middle, z0 + east * (middle[0] - x0) + north * (middle[1] - y0), east, north)


def _bounded(plane: Plane, tilt: float) -> Plane:
    """Return the plane turned back to the greatest slope where it is steeper."""
    share = min(1.0, tilt / max(math.hypot(plane.east, plane.north), 1e-12))
    return plane._replace(east=round(plane.east * share, 6), north=round(plane.north * share, 6))


def _above_m(plane: Plane, leg: Leg) -> float:
    """Return how far a street's end lies above the middle of its junction."""
    return plane.at(*leg.pose[:2]) - plane.height_m


def _most_rise_m(profile: Profile, road_m: float, slopes: float) -> float:
    """Return by how much a road may rise; ``slopes`` is the sum of those at its ends, upwards.

    A road without room for two ramps is one cubic. In its middle it rises by 3/2 of the mean, less 1/4 of the sum of
    the slopes at its ends.
    """
    mean = profile.steepest
    if road_m <= 2 * profile.ramp_m:
        mean = min(mean, (profile.steepest_spot + slopes / 4) / 1.5)
    return mean * road_m


def _height_and_slope(surface: JunctionHeights, record: RoadRecord, s_m: float, total_m: float) -> tuple[float, float]:
    """Return height and rise per metre along a road on a surface."""
    places_m = max(s_m - 0.01, 0.0), min(s_m + 0.01, total_m)
    before, after = (surface.height_m(*pose_at(record.path, place_m)[:2]) for place_m in places_m)
    return surface.height_m(*pose_at(record.path, s_m)[:2]), (after - before) / (places_m[1] - places_m[0])


def _tilted(lane: LaneRecord, record: RoadRecord, surface: JunctionHeights) -> LaneRecord:
    """Return a lane with both its edges on the surface, or as far above it as the lane is raised."""
    total_m = length(record.path)
    count = math.ceil(total_m / TILT_STEP_M)
    found: list[EdgeHeights] = []
    for i in range(count + 1):
        s_m = total_m * i / count
        pose, z_m = pose_at(record.path, s_m), value(record.elevation, s_m)
        edges_m = (
            round(surface.height_m(*moved(pose, left_m=left_m)[:2]) - z_m + lane.height_m, 4)
            for left_m in _edges_m(lane, record, s_m)
        )
        heights = EdgeHeights(s_m, *edges_m)
        if not found or max(abs(a - b) for a, b in zip(heights[1:], found[-1][1:], strict=True)) > TILT_M:
            found.append(heights)
    return lane._replace(heights=tuple(found))


def _edges_m(lane: LaneRecord, record: RoadRecord, s_m: float) -> tuple[float, float]:
    """Return how far left of the reference line the inner and the outer edge of a lane run."""
    sign, side = (1, record.left) if lane.id > 0 else (-1, record.right)
    inner_m = value(record.axis, s_m)
    inner_m += sign * math.fsum(value(other.widths, s_m) for other in side if abs(other.id) < abs(lane.id))
    return inner_m, inner_m + sign * value(lane.widths, s_m)


def _sum_of_products(ones: Sequence[float], others: Sequence[float]) -> float:
    """Return the scalar product of two rows; ``math.sumprod`` came with Python 3.12."""
    return math.fsum(map(mul, ones, others))
