"""Trajectories as polylines with headings, times and speeds."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import ScenarioError
from basu_openscenario.playing.transition import SMALL, sign
from basu_openscenario.reading.position_reading import LONGEST_TRAJECTORY_M
from basu_openscenario.reading.positions import ClothoidSpec, ClothoidSplineSpec, NurbsSpec, PolylineSpec
from basu_openscenario.roads.geometry import Clothoid
from basu_openscenario.roads.place import Place, wrapped

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.positions import Orientation, Position, TrajectorySpec

STEP_M = 1.0
"""Length of the pieces into which curves are cut, as esmini cuts them."""
FINE_STEP_M = 0.25
"""The same for a single clothoid, which esmini evaluates exactly: within a millimetre at a radius of 10 m."""
CORNER_M = 2.0
"""Length before and behind a corner over which the heading turns."""


class Vertex(NamedTuple):
    """A point of a trajectory: m, rad, s and m/s; ``h_rad`` is the body's heading, ``true_rad`` the path's.

    Without a height of its own the body stands on the road, without a pitch and a roll it has those of the road.
    """

    s_m: float
    x_m: float
    y_m: float
    z_m: float | None
    h_rad: float
    true_rad: float
    time_s: float
    has_heading: bool
    speed_mps: float = 0.0
    acceleration_mps2: float = 0.0
    p_rad: float | None = None
    r_rad: float | None = None


@dataclass(slots=True)
class Curve:
    """A trajectory in the world. ``turns`` says how headings are interpolated: ``segment``, ``corner`` or ``none``."""

    name: str
    closed: bool
    vertices: list[Vertex]
    turns: str
    follows: bool
    timed: bool
    _starts: list[float] = field(default_factory=list)

    @property
    def length_m(self) -> float:
        """The length."""
        return self.vertices[-1].s_m

    @property
    def first_s(self) -> float:
        """The time of the first vertex."""
        return self.vertices[0].time_s

    @property
    def duration_s(self) -> float:
        """The time from the first to the last vertex."""
        return self.vertices[-1].time_s - self.vertices[0].time_s

    def at(self, s_m: float) -> Vertex:
        """Return the point at a distance along the trajectory."""
        if not self._starts:
            self._starts.extend(vertex.s_m for vertex in self.vertices)
        if s_m > self.length_m - SMALL:
            return self.vertices[-1]
        index = max(bisect.bisect_left(self._starts, s_m - SMALL) - 1, 0)
        return self._between(index, s_m - self._starts[index])

    def _between(self, index: int, local_m: float) -> Vertex:
        """Return the point ``local_m`` behind a vertex."""
        a, b = self.vertices[index], self.vertices[index + 1]
        length_m = max(b.s_m - a.s_m, SMALL)
        local_m = min(max(local_m, 0.0), length_m)
        share = local_m / length_m

        def mix(one: float, other: float) -> float:
            return (1.0 - share) * one + share * other

        def turned(name: str) -> float | None:
            angles = [getattr(self.vertices[n], name) for n in (max(index - 1, 0), index, index + 1)]
            if angles[1] is None:
                return None
            before, here, following = (angles[1] if angle is None else angle for angle in angles)
            return self._angle(index, local_m, length_m, before, here, following)

        z_m = None if a.z_m is None or b.z_m is None else mix(a.z_m, b.z_m)
        h_rad = turned("h_rad")
        assert h_rad is not None, "each vertex has a heading"
        return Vertex(
            mix(a.s_m, b.s_m),
            mix(a.x_m, b.x_m),
            mix(a.y_m, b.y_m),
            z_m,
            h_rad,
            a.true_rad,
            mix(a.time_s, b.time_s),
            a.has_heading,
            mix(a.speed_mps, b.speed_mps),
            p_rad=turned("p_rad"),
            r_rad=turned("r_rad"),
        )

    def _angle(
        self, index: int, local_m: float, length_m: float, before: float, here: float, following: float
    ) -> float:
        """Return an angle of the body ``local_m`` behind a vertex, from those of three vertices one after the other."""
        ahead = wrapped(following - here)
        if self.turns == "segment":
            return here + local_m / length_m * ahead
        if self.turns == "none":
            return here
        radius_m = min(CORNER_M, length_m / 2.0)
        if local_m < radius_m:
            if index == 0:
                return here
            return before + (radius_m + local_m) / (2.0 * radius_m) * wrapped(here - before)
        if local_m > length_m - radius_m:
            left_m = length_m - local_m
            is_last = index >= len(self.vertices) - 2
            share = left_m / radius_m if is_last else (radius_m + left_m) / (2.0 * radius_m)
            return here + (1.0 - share) * ahead
        return here

    def s_at(self, time_s: float) -> float:
        """Return the distance along the trajectory at a time of its own clock."""
        if time_s >= self.vertices[-1].time_s:
            return self.length_m
        if time_s <= self.vertices[0].time_s:
            return 0.0
        index = bisect.bisect_right(self.vertices, time_s, key=lambda vertex: vertex.time_s) - 1
        a, b = self.vertices[index], self.vertices[index + 1]
        since_s = time_s - a.time_s
        if self.follows:
            s_m = a.s_m + a.speed_mps * since_s + 0.5 * a.acceleration_mps2 * since_s * since_s
            return min(max(s_m, a.s_m), b.s_m)
        return a.s_m + (b.s_m - a.s_m) * since_s / max(b.time_s - a.time_s, SMALL)

    def nearest(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return where along the trajectory its point nearest to a point of the world is, and how far that is; m."""
        best = (math.inf, 0.0)
        for a, b in pairwise(self.vertices):
            dx, dy = b.x_m - a.x_m, b.y_m - a.y_m
            length2 = dx * dx + dy * dy
            share = 0.0 if length2 < SMALL * SMALL else ((x_m - a.x_m) * dx + (y_m - a.y_m) * dy) / length2
            share = min(max(share, 0.0), 1.0)
            gap = math.hypot(x_m - a.x_m - share * dx, y_m - a.y_m - share * dy)
            if gap < best[0] - 1e-12:
                best = gap, a.s_m + share * (b.s_m - a.s_m)
        return best[1], best[0]


def lay(
    spec: TrajectorySpec,
    place_of: Callable[[Position], Place],
    *,
    follows: bool,
    speed_mps: float,
    here: Place,
) -> Curve:
    """Return a trajectory in the world.

    Args:
        spec: as the file has it.
        place_of: finds the place of a position.
        follows: whether the entity obeys its own speed at the start, and changes it steadily between vertices.
        speed_mps: of the entity at the start.
        here: of the entity, where a trajectory without a place of its own begins.

    Raises:
        ScenarioError: it has no length, or times that do not go up.
    """
    shape = spec.shape
    turns = "segment"
    if isinstance(shape, PolylineSpec):
        vertices, timed = _polyline(shape, place_of)
        turns = "segment" if follows else "corner"
    elif isinstance(shape, ClothoidSpec):
        vertices, timed = _clothoid(shape, place_of(shape.position))
    elif isinstance(shape, ClothoidSplineSpec):
        vertices, timed = _spline(shape, place_of, here)
    else:
        assert isinstance(shape, NurbsSpec), "there are four shapes"
        vertices, timed = _nurbs(shape, place_of)
    if timed and any(b.time_s < a.time_s for a, b in pairwise(vertices)):
        raise ScenarioError(f"the times of the trajectory '{spec.name}' do not go up; sort its vertices")
    follows = follows and isinstance(shape, PolylineSpec)  # along a curve the times are those of its length
    vertices = _with_speeds(vertices, speed_mps, follows=follows) if timed else vertices
    return Curve(spec.name, spec.closed, vertices, turns, follows, timed)


def _polyline(shape: PolylineSpec, place_of: Callable[[Position], Place]) -> tuple[list[Vertex], bool]:
    """Return the vertices of a polyline; a heading that the file does not give is the path's."""
    places = [place_of(position) for position, _ in shape.vertices]
    given = [position.orientation.h_rad is not None for position, _ in shape.vertices]
    times = [time_s for _, time_s in shape.vertices]
    s_m, heading = 0.0, places[0].h_rad
    headings: list[float] = []
    for a, b in pairwise(places):
        if math.hypot(b.x_m - a.x_m, b.y_m - a.y_m) > SMALL:
            heading = math.atan2(b.y_m - a.y_m, b.x_m - a.x_m)
        headings.append(heading)
    first = next(
        (
            h
            for h, a, b in zip(headings, places, places[1:], strict=False)
            if math.hypot(b.x_m - a.x_m, b.y_m - a.y_m) > SMALL
        ),
        heading,
    )
    headings = [*([first] if headings else []), *headings[1:], headings[-1]]
    found = []
    for nth, place in enumerate(places):
        if nth:
            s_m += math.hypot(place.x_m - places[nth - 1].x_m, place.y_m - places[nth - 1].y_m)
        z_m = place.z_m if place.z_rel_m is None else None
        h_rad = place.h_rad if given[nth] else headings[nth]
        found.append(Vertex(s_m, place.x_m, place.y_m, z_m, h_rad, headings[nth], times[nth] or 0.0, given[nth]))
    found = _pitched(found, [position.orientation for position, _ in shape.vertices])
    return found, all(time_s is not None for time_s in times) and (times[-1] or 0.0) - (times[0] or 0.0) > SMALL


def _pitched(vertices: list[Vertex], given: list[Orientation]) -> list[Vertex]:
    """Return vertices that have heights with the pitch that the file gives, or that of the next piece."""
    found, pitch = [], 0.0
    for nth, (vertex, orientation) in enumerate(zip(vertices, given, strict=True)):
        following = vertices[min(nth + 1, len(vertices) - 1)]
        if vertex.z_m is None:
            found.append(vertex)
            continue
        if following.z_m is not None and following.s_m - vertex.s_m > SMALL:
            pitch = -math.atan2(following.z_m - vertex.z_m, following.s_m - vertex.s_m)
        own = orientation.p_rad
        found.append(vertex._replace(p_rad=pitch if own is None else own, r_rad=orientation.r_rad or 0.0))
    return found


def _with_speeds(vertices: list[Vertex], speed_mps: float, *, follows: bool) -> list[Vertex]:
    """Return vertices with the speed at each, and the acceleration up to the next."""
    found = []
    speed = speed_mps
    for a, b in pairwise(vertices):
        ds, dt = b.s_m - a.s_m, b.time_s - a.time_s
        if not follows:
            speed = ds / dt if dt > SMALL else 0.0
            found.append(a._replace(speed_mps=speed))
            continue
        acceleration, after = 0.0, 0.0
        if abs(ds) > SMALL and dt > SMALL:
            acceleration = 2.0 * (ds - speed * dt) / (dt * dt)
            after = speed + acceleration * dt
            if sign(after) != sign(speed):  # it would turn round: it comes to rest earlier instead
                acceleration, after = -speed * speed / (2.0 * ds), 0.0
        found.append(a._replace(speed_mps=speed, acceleration_mps2=acceleration))
        speed = after
    return [*found, vertices[-1]._replace(speed_mps=speed)]


def _clothoid(shape: ClothoidSpec, start: Place) -> tuple[list[Vertex], bool]:
    """Return the vertices of a clothoid, `FINE_STEP_M` apart."""
    curve = Clothoid(
        0.0, start.x_m, start.y_m, start.h_rad, shape.length_m, shape.curvature_per_m, shape.curvature_prime_per_m2
    )
    timed = shape.start_s is not None and shape.stop_s is not None
    first, last = (shape.start_s or 0.0), (shape.stop_s or 0.0)
    found = []
    for s_m in _marks(shape.length_m, FINE_STEP_M):
        point = curve.at(s_m)
        time_s = first + s_m / shape.length_m * (last - first)
        found.append(Vertex(s_m, point.x_m, point.y_m, None, point.h_rad, point.h_rad, time_s, has_heading=False))
    return found, timed


def _marks(length_m: float, step_m: float) -> list[float]:
    """Return distances from 0 to the length, a step apart; the last piece may be longer."""
    steps = int(length_m / step_m)
    return [*(nth * step_m for nth in range(steps)), length_m] if steps else [0.0, length_m]


def _spline(shape: ClothoidSplineSpec, place_of: Callable[[Position], Place], here: Place) -> tuple[list[Vertex], bool]:
    """Return the vertices of clothoids one after the other, a metre apart."""
    x_m, y_m, h_rad = here.x_m, here.y_m, here.h_rad
    found: list[Vertex] = []
    total_m = 0.0
    starts = [piece.start_s for piece in shape.pieces]
    timed = all(start is not None for start in starts) and shape.end_s is not None
    ends = [*starts[1:], shape.end_s]
    for piece, first, last in zip(shape.pieces, starts, ends, strict=True):
        if piece.position is not None:
            place = place_of(piece.position)
            x_m, y_m, h_rad = place.x_m, place.y_m, place.h_rad
        change = (piece.end_per_m - piece.start_per_m) / max(piece.length_m, SMALL)
        curve = Clothoid(0.0, x_m, y_m, h_rad + piece.turn_rad, piece.length_m, piece.start_per_m, change)
        marks = [
            mark - total_m for mark in range(math.ceil(total_m - SMALL), math.ceil(total_m + piece.length_m - SMALL))
        ]
        for mark in marks:
            point = curve.at(mark)
            time_s = (first or 0.0) + mark / max(piece.length_m, SMALL) * ((last or 0.0) - (first or 0.0))
            found.append(
                Vertex(total_m + mark, point.x_m, point.y_m, None, point.h_rad, point.h_rad, time_s, has_heading=False)
            )
        end = curve.at(piece.length_m)
        x_m, y_m, h_rad = end.x_m, end.y_m, end.h_rad
        total_m += piece.length_m
    found.append(Vertex(total_m, x_m, y_m, None, h_rad, h_rad, shape.end_s or 0.0, has_heading=False))
    return found, timed


class NurbsPoint(NamedTuple):
    """A point of a NURBS curve: m and rad.

    The height is mixed from those of the control points. The standard has no rule for angles; they are mixed as esmini
    mixes them, each control point turning what the ones before it gave by its share.
    """

    x_m: float
    y_m: float
    z_m: float
    h_rad: float
    p_rad: float
    basis: list[float]


def _nurbs(shape: NurbsSpec, place_of: Callable[[Position], Place]) -> tuple[list[Vertex], bool]:
    """Return points of a NURBS curve about a metre apart, with times between those of the control points.

    The first control point says whether the points have heights and headings of their own, as in esmini.
    """
    places = [place_of(point.position) for point in shape.points]
    length_m = sum(math.hypot(b.x_m - a.x_m, b.y_m - a.y_m) for a, b in pairwise(places))
    if length_m > LONGEST_TRAJECTORY_M:
        raise ScenarioError(f"a NURBS of {length_m:g} m is not supported; at most {LONGEST_TRAJECTORY_M:g} m are")
    steps = 1 + int(length_m / STEP_M)
    last = shape.knots[-1]
    own = shape.points[0].position.orientation
    has_height, has_heading = places[0].z_rel_m is None, own.h_rad is not None
    peaks = [(0.0, 0.0)] * len(places)
    raw: list[tuple[float, Vertex]] = []
    s_m = 0.0
    for nth in range(steps + 1):
        t = nth * last / steps
        here = _on_nurbs(shape, places, t)
        turn = 1.0 if nth < steps else -1.0
        nearby = _on_nurbs(shape, places, min(max(t + turn * 0.001, 0.0), last))
        peaks = [(share, t) if share > peak[0] else peak for share, peak in zip(nearby.basis, peaks, strict=True)]
        dx, dy, dz = (turn * (b - a) for a, b in zip(here[:3], nearby[:3], strict=True))
        heading = here.h_rad if has_heading else math.atan2(dy, dx)
        pitch = here.p_rad if own.p_rad is not None else -math.atan2(dz, math.hypot(dx, dy))
        s_m += math.hypot(here.x_m - raw[-1][1].x_m, here.y_m - raw[-1][1].y_m) if raw else 0.0
        vertex = Vertex(s_m, here.x_m, here.y_m, here.z_m if has_height else None, heading, heading, 0.0, has_heading)
        if has_height:
            vertex = vertex._replace(p_rad=pitch, r_rad=own.r_rad or 0.0)
        raw.append((t, vertex))
    if not has_heading:  # esmini gives the first point the heading of the second
        raw[0] = raw[0][0], raw[0][1]._replace(h_rad=raw[1][1].h_rad, true_rad=raw[1][1].h_rad)
    found = []
    current = 0
    for t, vertex in raw:
        while current < len(places) - 2 and t >= peaks[current + 1][1]:
            current += 1
        a, b = peaks[current][1], peaks[current + 1][1]
        share = (t - a) / max(b - a, SMALL)
        first, second = (shape.points[current].time_s or 0.0), (shape.points[current + 1].time_s or 0.0)
        found.append(vertex._replace(time_s=first + share * (second - first)))
    return found, all(point.time_s is not None for point in shape.points)


def _on_nurbs(shape: NurbsSpec, places: list[Place], t: float) -> NurbsPoint:
    """Return a point of the curve (Cox and de Boor)."""
    t = min(max(t, shape.knots[0]), shape.knots[-1] - SMALL)
    knots = shape.knots
    basis = [1.0 if knots[i] <= t < knots[i + 1] else 0.0 for i in range(len(knots) - 1)]
    for degree in range(1, shape.order):
        for i in range(len(knots) - 1 - degree):
            left = knots[i + degree] - knots[i]
            right = knots[i + degree + 1] - knots[i + 1]
            value = 0.0 if left == 0.0 else (t - knots[i]) / left * basis[i]
            value += 0.0 if right == 0.0 else (knots[i + degree + 1] - t) / right * basis[i + 1]
            basis[i] = value
    weights = [basis[i] * shape.points[i].weight for i in range(len(places))]
    total = sum(weights) or 1.0
    shares = [weight / total for weight in weights]
    x_m, y_m, z_m = (
        sum(share * getattr(place, name) for share, place in zip(shares, places, strict=True))
        for name in ("x_m", "y_m", "z_m")
    )
    h_rad = p_rad = 0.0
    for share, place in zip(shares, places, strict=True):
        h_rad += share * wrapped(place.h_rad - h_rad)
        p_rad += share * wrapped(place.p_rad - p_rad)
    return NurbsPoint(x_m, y_m, z_m, h_rad, p_rad, basis[: len(places)])
