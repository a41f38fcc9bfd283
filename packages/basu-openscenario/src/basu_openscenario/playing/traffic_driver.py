"""`TrafficDriver`: a vehicle of traffic that follows its lane, chooses ways by chance, and keeps its distance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.scenarios.actions.path_follower import MARGIN_M, FollowerLimits, following_mps2, gap_ahead
from basu.scenarios.paths import Path
from basu.scenarios.stage import ActorBox

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.reading.entities import Entity
    from basu_openscenario.roads.network import Entry
    from basu_openscenario.roads.place import Place

POINT_M = 2.0
"""Distance of the points of the way ahead."""
LOOK_M = 100.0
"""How far a vehicle looks ahead."""
RENEW_M = 30.0
"""The way ahead is made so much longer than a vehicle looks, so that it is not made anew in each step."""
KEPT_M = 10.0
"""How much of the way behind the vehicle is kept."""
ACROSS_MPS2 = 2.0
"""The acceleration across that a bend may give: a usual value of drivers."""
SLOWEST_MPS = 2.0
"""No bend asks for less."""
UNPOSTED_MPS = 50.0 / 3.6
"""The speed on roads without a posted one, for vehicles to which the file gives none."""
DECIDE_S = 0.1
"""A driver decides so often."""
BEND_M = 0.5
"""Boxes so much farther from the way than the vehicle's width are compared exactly, since the way may bend."""
MOST_COMPARED = 4
"""So many of the nearest boxes on the way are compared exactly."""


class Seen(NamedTuple):
    """The boxes of all entities in OpenDRIVE's axes; N of them."""

    names: tuple[str, ...]
    boxes: tuple[ActorBox, ...]
    middles_m: NDArray[np.float64]
    """(N, 2) of x and y."""
    halves_m: NDArray[np.float64]
    """(N, 2) half the length and half the width."""
    yaw_rad: NDArray[np.float64]
    """(N,) headings."""


def seen(movers: Sequence[Mover]) -> Seen:
    """Return the boxes of entities, each with its name, as arrays and one by one."""
    boxes = tuple(box_of(one) for one in movers)
    middles = np.array([box[:2] for box in boxes], dtype=np.float64).reshape(-1, 2)
    halves = np.array([(box.half_length_m, box.half_width_m) for box in boxes]).reshape(-1, 2)
    yaw = np.array([box.yaw_rad for box in boxes])
    return Seen(tuple(one.name for one in movers), boxes, middles, halves, yaw)


def box_of(mover: Mover) -> ActorBox:
    """Return the box of an entity in OpenDRIVE's axes: y to the north, yaw to the left."""
    place, box = mover.place, mover.entity.box
    dx, dy, _ = box.centre_m
    cos, sin = math.cos(place.h_rad), math.sin(place.h_rad)
    x_m, y_m = place.x_m + dx * cos - dy * sin, place.y_m + dx * sin + dy * cos
    vx, vy, _ = mover.velocity_mps
    return ActorBox(x_m, y_m, place.z_m, place.h_rad, vx, vy, box.length_m / 2.0, box.width_m / 2.0)


def wished_mps(place: Place, given_mps: float | None, entity: Entity) -> float:
    """Return the speed in m/s that a vehicle makes for: the given one, otherwise the posted one of its road."""
    posted = None if place.road is None else place.road.limit_mps(place.s_m)
    return min(given_mps if given_mps is not None else posted or UNPOSTED_MPS, entity.performance.max_speed_mps)


class TrafficDriver:
    """A driver of one vehicle of traffic: it keeps its lane and its distance."""

    def __init__(self, mover: Mover, wish_mps: float | None, rng: random.Random) -> None:
        """Take a vehicle on a road.

        Args:
            mover: the vehicle.
            wish_mps: the speed that it makes for; None: the posted speed of its road.
            rng: for the choice of ways at junctions.
        """
        self.mover, self.wish_mps, self.rng = mover, wish_mps, rng
        own = mover.entity.performance
        usual = FollowerLimits()
        self.limits = FollowerLimits(
            min(usual.accelerate_mps2, own.max_acceleration_mps2),
            min(usual.brake_mps2, own.max_deceleration_mps2),
            min(usual.emergency_mps2, own.max_deceleration_mps2),
        )
        self.rate_mps2 = 0.0
        self._scout = mover.place.copy()
        self._scout.choose = self._chosen
        self._way: list[tuple[float, float, float]] = [self._point()]
        self._roads: list[tuple[str, int]] = []
        """The chosen roads, each with the number of the point of the way at which it was chosen."""
        self._passed, self._ends = 0, False
        self.s_m = 0.0
        self._extend()

    def _chosen(self, entries: list[Entry]) -> Entry:
        """Return one of several ways on, by chance, and keep it for the vehicle itself."""
        entry = self.rng.choice(entries)
        self._roads.append((entry.road.number, self._passed + len(self._way)))
        return entry

    def _point(self) -> tuple[float, float, float]:
        """Return the scout's place: x and y in m, and the heading in rad."""
        return self._scout.x_m, self._scout.y_m, self._scout.h_rad

    def _extend(self) -> None:
        """Forget the way behind the vehicle, and make the way ahead long enough."""
        gone = max(0, int((self.s_m - KEPT_M) / POINT_M))
        del self._way[:gone]
        self._passed += gone
        self._roads = [one for one in self._roads if one[1] >= self._passed]
        while not self._ends and len(self._way) < (KEPT_M + LOOK_M + RENEW_M) / POINT_M:
            self._ends = not self._scout.move(POINT_M) or self._scout.at_end_of_road
            self._way.append(self._point())
        self.mover.place.route = tuple(road for road, _ in self._roads)
        points = np.array(self._way)
        if len(points) < 2 or math.dist(points[0, :2], points[-1, :2]) < POINT_M / 2.0:
            x_m, y_m, h_rad = self._way[0]
            points = np.array([self._way[0], (x_m + math.cos(h_rad), y_m + math.sin(h_rad), h_rad)])
        self.path = Path.through(points[:, :2])
        turn = np.abs(np.diff(np.unwrap(points[:, 2]))) / POINT_M
        self._bends_mps = np.maximum(np.sqrt(ACROSS_MPS2 / np.maximum(turn, 1e-6)), SLOWEST_MPS)
        self._bends_m = POINT_M * (0.5 + np.arange(len(turn)))
        place = self.mover.place
        self.s_m = self.path.nearest(place.x_m, place.y_m).s_m

    @property
    def wanted_mps(self) -> float:
        """The speed that it makes for: the file's or the posted one, less in and before bends; m/s."""
        wish = wished_mps(self.mover.place, self.wish_mps, self.mover.entity)
        ahead = self._bends_m >= self.s_m - POINT_M
        if not ahead.any():
            return wish
        room_m = np.maximum(self._bends_m[ahead] - self.s_m, 0.0)
        allowed = np.sqrt(self._bends_mps[ahead] ** 2 + self.limits.brake_mps2 * room_m)  # half of the usual braking
        return min(wish, float(allowed.min()))

    def decide(self, others: Seen) -> None:
        """Choose an acceleration until the next decision: towards the wanted speed, and by the vehicle ahead."""
        mover, limits = self.mover, self.limits
        place = mover.place
        self.s_m = self.path.nearest(place.x_m, place.y_m, self.s_m).s_m
        if not self._ends and self.path.length_m - self.s_m < LOOK_M:
            self._extend()
        speed = mover.speed_mps
        rate = (self.wanted_mps - speed) / DECIDE_S
        rate = min(max(rate, -limits.brake_mps2), limits.accelerate_mps2)
        own = box_of(mover)
        middle_m = self.s_m + mover.entity.box.centre_m[0]
        for nth in self._near(others, middle_m, own.half_width_m):
            if others.names[nth] == mover.name:
                continue
            ahead = gap_ahead(self.path, middle_m, own, others.boxes[nth], LOOK_M)
            if ahead is not None:
                rate = min(rate, following_mps2(speed, ahead, limits))
        self.rate_mps2 = rate

    def _near(self, others: Seen, middle_m: float, half_width_m: float) -> list[int]:
        """Return the entities with a middle ahead of the vehicle's and near its way, the nearest first."""
        points, yaw_rad = self.path.points_m[:, :2], self.path.yaw_rad
        dx, dy = (others.middles_m[:, axis, None] - points[:, axis] for axis in (0, 1))
        nearest = np.argmin(dx * dx + dy * dy, axis=1)
        rows, along_m = np.arange(len(nearest)), self.path.s_m[nearest]
        cos, sin = np.cos(yaw_rad[nearest]), np.sin(yaw_rad[nearest])
        left_m = np.abs(dy[rows, nearest] * cos - dx[rows, nearest] * sin)
        turn_rad = others.yaw_rad - yaw_rad[nearest]
        half_m = others.halves_m[:, 0] * np.abs(np.sin(turn_rad)) + others.halves_m[:, 1] * np.abs(np.cos(turn_rad))
        close = left_m <= half_m + half_width_m + MARGIN_M + BEND_M
        found = np.flatnonzero(close & (along_m >= middle_m - POINT_M / 2.0) & (along_m <= middle_m + LOOK_M + KEPT_M))
        return [int(one) for one in found[np.argsort(along_m[found], kind="stable")]][:MOST_COMPARED]

    def drive(self, step_s: float) -> None:
        """Change the speed for a step; the lane is followed as by every entity."""
        self.mover.set_speed(max(0.0, self.mover.speed_mps + self.rate_mps2 * step_s))
