"""`Place`: a position on a road network that moves along lanes and through junctions, with its pose in the world."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from basu_openscenario.roads.network import DRIVING, Network

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu_openscenario.roads.network import Entry
    from basu_openscenario.roads.road import Road, RoadPoint

SMALL = 1e-6
MOST_ROADS = 8
"""Roads that one movement may pass."""


class Difference(NamedTuple):
    """The way from one place to another: along the road, across it, and by lanes; m."""

    ds_m: float
    dt_m: float
    lanes: int
    same_direction: bool
    opposite_lane: bool


def wrapped(angle_rad: float) -> float:
    """Return an angle between -pi and pi."""
    return math.remainder(angle_rad, math.tau)


def is_forward(angle_rad: float) -> bool:
    """Return whether an angle is less than a right angle."""
    return abs(wrapped(angle_rad)) <= math.pi / 2.0


@dataclass(slots=True)
class Place:
    """A position: on a road in s, t and lane; in the world in m and rad (x east, y north, z up, yaw to the left).

    ``h_rel_rad`` is the heading from that of the lane's middle. A place without a road moves freely.
    """

    network: Network
    road: Road | None = None
    s_m: float = 0.0
    t_m: float = 0.0
    lane: int = 0
    offset_m: float = 0.0
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    h_rad: float = 0.0
    p_rad: float = 0.0
    r_rad: float = 0.0
    h_rel_rad: float = 0.0
    z_rel_m: float | None = 0.0
    """Height above the road; None: the height is fixed."""
    on_surface: bool = True
    """Whether pitch and roll follow the road."""
    kinds: frozenset[str] = DRIVING
    at_end_of_road: bool = False
    route: Sequence[str] = ()
    """The roads of a route, in their order."""
    choose: Callable[[list[Entry]], Entry] | None = None
    """The choice among several ways on where the route names none; None: by the angle."""

    def copy(self) -> Place:
        """Return a place of its own with the same values."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return Place(**fields)

    def set_lane(self, number: str, lane: int, s_m: float, offset_m: float) -> None:
        """Stand in a lane of a road, with the heading that is kept from the lane's."""
        road = self.network.roads[number]
        self.road, self.lane, self.offset_m = road, lane, offset_m
        self.s_m = min(max(s_m, 0.0), road.length_m)
        self.t_m = offset_m + road.lane_t_m(lane, self.s_m)
        self._to_world()

    def set_track(self, number: str, s_m: float, t_m: float) -> None:
        """Stand on a road at s and t."""
        road = self.network.roads[number]
        self.road, self.s_m, self.t_m = road, min(max(s_m, 0.0), road.length_m), t_m
        self.lane, self.offset_m = road.lane_at(self.s_m, t_m, self.kinds)
        self._to_world()

    def set_world(self, x_m: float, y_m: float, h_rad: float | None, z_m: float | None = None) -> None:
        """Stand at a point of the world; the heading is kept where none is given, the height is the road's likewise."""
        self.x_m, self.y_m = x_m, y_m
        if h_rad is not None:
            self.h_rad = h_rad
        self.z_rel_m = 0.0 if z_m is None else None
        if z_m is not None:
            self.z_m = z_m
        self.attach()
        self._pose_from_world()

    def lift(self, above_m: float) -> None:
        """Stand above the road from now on."""
        self.z_rel_m = above_m
        self._pose_from_world()

    def attach(self) -> None:
        """Find road, s, t and lane of the point in the world; the point stays."""
        if not self.network.roads:
            self.road = None
            return
        near = None if self.road is None else (self.road.number, self.s_m)
        self.road, self.s_m, self.t_m = self.network.nearest(self.x_m, self.y_m, self.z_m, near, self.lane)
        self.lane, self.offset_m = self.road.lane_at(self.s_m, self.t_m, self.kinds)
        self.h_rel_rad = wrapped(self.h_rad - self.lane_heading())

    def lane_heading(self) -> float:
        """Return the heading of the lane's middle in the direction of s, in rad."""
        assert self.road is not None, "it is on a road"
        return self.road.line(self.s_m).h_rad + self._drift()

    def _drift(self) -> float:
        """Return how far the lane's middle is turned from the reference line."""
        assert self.road is not None, "it is on a road"
        lanes = self.road.section(self.s_m).lanes
        return self.road.lane_heading(self.lane, self.s_m) if self.lane in lanes or self.lane == 0 else 0.0

    def _to_world(self) -> None:
        """Find the pose in the world from road and lane."""
        assert self.road is not None, "it is on a road"
        point = self._point()
        self.x_m, self.y_m = point.x_m, point.y_m
        if self.z_rel_m is not None:
            self.z_m = point.z_m + self.z_rel_m
        self.h_rad = point.h_rad + self._drift() + self.h_rel_rad
        self._tilt(point)

    def _pose_from_world(self) -> None:
        """Lay a point of the world on the surface below it."""
        if self.road is None:
            return
        point = self._point()
        if self.z_rel_m is not None:
            self.z_m = point.z_m + self.z_rel_m
        self._tilt(point)

    def _point(self) -> RoadPoint:
        """Return the point of the surface here; kerbs lift some lanes above the road."""
        assert self.road is not None, "it is on a road"
        above_m = self.road.section(self.s_m).height_m(self.lane, self.s_m, self.offset_m)
        return self.road.point(self.s_m, self.t_m, above_m)

    def _tilt(self, point: RoadPoint) -> None:
        """Turn pitch and roll of the road into those of the body with its own heading."""
        if not self.on_surface:
            return
        h_rad, p_rad, r_rad = point.h_rad, point.p_rad, point.r_rad
        if max(abs(p_rad), abs(r_rad), abs(point.twist_rad)) < SMALL:
            self.p_rad, self.r_rad = 0.0, 0.0
            return
        turn, own_p = self.h_rad - h_rad, math.cos(self.h_rel_rad) * point.twist_rad
        cos_p, sin_p, cos_r, sin_r = math.cos(p_rad), math.sin(p_rad), math.cos(r_rad), math.sin(r_rad)
        cos, sin, cos_own, sin_own = math.cos(turn), math.sin(turn), math.cos(own_p), math.sin(own_p)

        def turned(x: float, y: float, z: float) -> tuple[float, float, float]:
            """Return a vector of the banked surface in the axes of the road's plan: Ry(p) Rx(r)."""
            y, z = cos_r * y - sin_r * z, sin_r * y + cos_r * z
            return cos_p * x + sin_p * z, y, cos_p * z - sin_p * x

        forward = turned(cos * cos_own, sin * cos_own, -sin_own)
        left_z, up_z = turned(-sin, cos, 0.0)[2], turned(cos * sin_own, sin * sin_own, cos_own)[2]
        self.p_rad = -math.asin(max(-1.0, min(1.0, forward[2])))
        self.r_rad = math.atan2(left_z, up_z)
        self.h_rad = h_rad + math.atan2(forward[1], forward[0])

    @property
    def is_forward(self) -> bool:
        """Whether it looks in the direction of s."""
        return is_forward(self.h_rel_rad)

    @property
    def road_number(self) -> str:
        """The road's id; empty without a road."""
        return "" if self.road is None else self.road.number

    @property
    def curvature_per_m(self) -> float:
        """Of the reference line here."""
        return 0.0 if self.road is None else self.road.line(self.s_m).curvature_per_m

    def stretched(self, ds_m: float) -> float:
        """Return the length along the reference line of a movement of ``ds_m`` at this lateral offset."""
        turn = self.curvature_per_m * self.t_m
        if turn > 1.0 - SMALL:
            self.attach()
            turn = min(self.curvature_per_m * self.t_m, 1.0 - SMALL)
        return ds_m / (1.0 - turn)

    def face_lane(self, angle_rad: float) -> None:
        """Turn to an angle from the lane, in its own direction along the road: forwards or backwards as before."""
        self.h_rel_rad = angle_rad if self.is_forward else math.pi + angle_rad
        self._to_world()

    def driving_sign(self) -> float:
        """Return 1 where traffic of this lane goes with s, and -1 where it goes against it."""
        left_hand = self.road is not None and self.road.left_hand
        return (1.0 if self.lane > 0 else -1.0) * (1.0 if left_hand else -1.0)

    def move(self, ds_m: float, *, turn_rad: float = 0.0, direction: str = "heading", actual: bool = True) -> bool:
        """Move along the lane, into following roads; return False at the end of the road.

        Args:
            ds_m: how far.
            turn_rad: at a junction, the way is taken that leaves by the angle nearest to this one.
            direction: ``heading`` of the place, ``lane`` of traffic, or ``road`` along s.
            actual: whether ``ds_m`` is measured at the present lateral offset, not on the reference line.
        """
        if self.road is None:
            return False
        ds_m = self.stretched(ds_m) if actual else ds_m
        if direction == "heading":
            ds_m *= 1.0 if self.is_forward else -1.0
        elif direction == "lane":
            ds_m *= self.driving_sign()
        for _ in range(MOST_ROADS):
            at_end = self.s_m + ds_m > self.road.length_m
            if not at_end and self.s_m + ds_m >= 0.0:
                break
            left_m = self.s_m + ds_m - (self.road.length_m if at_end else 0.0)
            entry = self._next(at_end=at_end, turn_rad=turn_rad)
            if entry is None:
                edge = self.road.length_m if at_end else 0.0
                self.set_lane(self.road.number, self._lane_at(edge), edge, self.offset_m)
                self.at_end_of_road = True
                return False
            ds_m = self._enter(entry, at_end=at_end, left_m=abs(left_m))
        lane = self._lane_at(self.s_m + ds_m)
        self.set_lane(self.road.number, lane, self.s_m + ds_m, self.offset_m)
        at_start = self.s_m < SMALL and self.road.predecessor is None
        self.at_end_of_road = at_start or (self.s_m > self.road.length_m - SMALL and self.road.successor is None)
        return True

    def _lane_at(self, s_m: float) -> int:
        """Return the lane that the present one becomes at another s of the same road; if it ends, the nearest one."""
        assert self.road is not None, "it is on a road"
        held = min(max(s_m, 0.0), self.road.length_m)
        lane = self.lane
        if len(self.road.sections) > 1:
            lane = self.network.lane_through(self.road, self.lane, self.s_m, held)
        section = self.road.section(held)
        if self.lane and (not lane or (lane in section.lanes and section.width_m(lane, held) < SMALL)):
            t_m = self.offset_m + self.road.lane_t_m(self.lane, self.s_m)
            lane, _ = self.road.lane_at(held, t_m, self.kinds)
        return lane

    def _enter(self, entry: Entry, *, at_end: bool, left_m: float) -> float:
        """Step onto the next road; return how far to go along its s."""
        assert self.road is not None, "it is on a road"
        if at_end != entry.at_start:  # the next road runs against this one
            self.h_rel_rad += math.pi
            self.offset_m = -self.offset_m
        lane = entry.lane
        s_m = 0.0 if entry.at_start else entry.road.length_m
        if lane == 0:
            lane, _ = entry.road.lane_at(s_m, self.t_m if at_end == entry.at_start else -self.t_m, self.kinds)
            self.offset_m = 0.0
        self.set_lane(entry.road.number, lane, s_m, self.offset_m)
        return left_m if entry.at_start else -left_m

    def _next(self, *, at_end: bool, turn_rad: float) -> Entry | None:
        """Return the way on at an end of the road: by the route, otherwise by the angle that it leaves by."""
        assert self.road is not None, "it is on a road"
        edge = self.road.length_m if at_end else 0.0
        entries = self.network.exits(self.road, self._lane_at(edge), at_end=at_end)
        if len(entries) < 2:
            return entries[0] if entries else None
        for entry in entries:
            if entry.road.number in self.route:
                return entry
        if self.choose is not None:
            return self.choose(entries)
        here = self.road.line(edge).h_rad + (0.0 if at_end else math.pi)

        def gap(entry: Entry) -> float:
            out = entry.road.line(entry.road.length_m if entry.at_start else 0.0).h_rad
            out += 0.0 if entry.at_start else math.pi
            return abs(wrapped(out - here - turn_rad))

        return min(entries, key=gap)

    def to(self, other: Place, longest_m: float = 1e4) -> Difference | None:
        """Return the way to another place along lanes, in either direction; None where no road leads there."""
        if self.road is None or other.road is None:
            return None
        if self.road is other.road:
            ds_m = (other.s_m - self.s_m) * (1.0 if self.is_forward else -1.0)
            opposite = (self.lane < 0) != (other.lane < 0)
            lanes = other.lane - self.lane
            lanes = (abs(lanes) - 1) * (1 if lanes > 0 else -1) if opposite and lanes else lanes
            same = self.is_forward == other.is_forward
            return Difference(ds_m, other.t_m - self.t_m, lanes, same, opposite)
        found: Difference | None = None
        for sign in (1.0, -1.0):
            forwards = self.is_forward == (sign > 0)
            for path in self.network.paths(self.road, self.lane, self.s_m, forwards=forwards, longest_m=longest_m):
                last = path.steps[-1]
                if last.road != other.road.number:
                    continue
                inside_m = other.s_m if last.at_start else other.road.length_m - other.s_m
                length_m = sign * (path.length_m + inside_m)
                if found is None or abs(length_m) < abs(found.ds_m):
                    found = self._difference(other, length_m, last.lane, at_start=last.at_start, ahead=sign > 0)
                break
        return found

    def _difference(self, other: Place, ds_m: float, lane: int, *, at_start: bool, ahead: bool) -> Difference:
        """Return the difference to a place on another road, which is entered by ``lane``."""
        assert other.road is not None, "it is on a road"
        near_s = 0.0 if at_start else other.road.length_m
        there = self.network.lane_through(other.road, lane, near_s, other.s_m) if lane else lane
        lanes, opposite = other.lane - there, (other.lane < 0) != (there < 0)
        lanes = (abs(lanes) - 1) * (1 if lanes > 0 else -1) if opposite and lanes else lanes
        dt_m = other.t_m - self.t_m if (there < 0) == (self.lane < 0) else other.t_m + self.t_m
        same = (at_start == other.is_forward) == ahead
        return Difference(ds_m, dt_m, lanes, same, opposite)

    def rotated(self, ahead_m: float, left_m: float, up_m: float) -> tuple[float, float, float]:
        """Return a vector in this place's axes as a vector of the world, after roll, pitch and heading."""
        cos_r, sin_r = math.cos(self.r_rad), math.sin(self.r_rad)
        y, z = cos_r * left_m - sin_r * up_m, sin_r * left_m + cos_r * up_m
        cos_p, sin_p = math.cos(self.p_rad), math.sin(self.p_rad)
        x, z = cos_p * ahead_m + sin_p * z, -sin_p * ahead_m + cos_p * z
        cos, sin = math.cos(self.h_rad), math.sin(self.h_rad)
        return cos * x - sin * y, sin * x + cos * y, z

    def seen_from(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return a point of the world in this place's axes: m ahead and m to the left."""
        dx, dy = x_m - self.x_m, y_m - self.y_m
        cos, sin = math.cos(self.h_rad), math.sin(self.h_rad)
        return dx * cos + dy * sin, -dx * sin + dy * cos
