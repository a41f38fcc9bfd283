"""A path: points in the plane to be followed, with arc length and heading, and its arithmetic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.errors import ScenarioError
from basu.scenarios.stage import Pose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.routing import Route

NEAR_M = 0.05  # points nearer than this to their predecessor are one point
BACK_M, AHEAD_M = 5.0, 15.0  # how far from the last known place the next one is searched for
SWERVE_STEP_M = 0.5  # between the points of a swerve


class OnPath(NamedTuple):
    """The place of a path that is nearest to a point."""

    s_m: float
    right_m: float  # of the path, to the point
    distance_m: float


@dataclass(frozen=True, slots=True)
class Path:
    """A polyline. World coordinates are CARLA's; z is carried along and not part of the length."""

    points_m: NDArray[np.float64]  # (N, 3)
    s_m: NDArray[np.float64]  # (N,) arc length in the plane, strictly increasing from 0
    yaw_rad: NDArray[np.float64]  # (N,) heading, unwrapped: neighbours differ by less than pi

    @staticmethod
    def through(points: Sequence[Sequence[float]] | NDArray[np.float64]) -> Path:
        """The path through points of two or three coordinates; doubles are dropped.

        Raises:
            ScenarioError: fewer than two points are left.
        """
        given: NDArray[np.float64] = np.asarray(points, dtype=np.float64).reshape(len(points), -1)
        if given.shape[1] == 2:
            given = np.column_stack([given, np.zeros(len(given))])
        kept = [0] if len(given) else []
        for index in range(1, len(given)):
            if math.dist(given[index, :2], given[kept[-1], :2]) > NEAR_M:
                kept.append(index)
        if len(kept) < 2:
            raise ScenarioError("a path needs at least two points that are apart")
        points_m = given[kept]
        legs_m = np.diff(points_m[:, :2], axis=0)
        leg_rad = np.unwrap(np.arctan2(legs_m[:, 1], legs_m[:, 0]))
        yaw_rad = np.concatenate([leg_rad[:1], (leg_rad[:-1] + leg_rad[1:]) / 2.0, leg_rad[-1:]])
        return Path(points_m, np.concatenate([[0.0], np.cumsum(np.hypot(*legs_m.T))]), yaw_rad)

    @staticmethod
    def straight(start: Pose, length_m: float) -> Path:
        """Straight on from a pose."""
        end = (start.x_m + length_m * math.cos(start.yaw_rad), start.y_m + length_m * math.sin(start.yaw_rad))
        return Path.through([(start.x_m, start.y_m, start.z_m), (*end, start.z_m)])

    @staticmethod
    def of_route(route: Route, from_m: float = 0.0, to_m: float | None = None, right_m: float = 0.0) -> Path:
        """A stretch of a route, to its right by so much; arc lengths of the route."""
        whole = Path.through(route.points_m)
        return whole.part(from_m, whole.length_m if to_m is None else to_m).beside(right_m)

    @property
    def length_m(self) -> float:
        """From the first point to the last."""
        return float(self.s_m[-1])

    def heading_rad(self, s_m: float) -> float:
        """Where it heads there, unwrapped."""
        return float(np.interp(s_m, self.s_m, self.yaw_rad))

    def at(self, s_m: float, right_m: float = 0.0) -> Pose:
        """The pose so far along it and so far to its right; beyond its ends it goes straight on."""
        held_m = min(max(s_m, 0.0), self.length_m)
        x_m, y_m, z_m = (float(np.interp(held_m, self.s_m, self.points_m[:, axis])) for axis in range(3))
        yaw_rad, over_m = self.heading_rad(held_m), s_m - held_m
        return Pose(
            x_m + over_m * math.cos(yaw_rad) - right_m * math.sin(yaw_rad),
            y_m + over_m * math.sin(yaw_rad) + right_m * math.cos(yaw_rad),
            z_m,
            math.remainder(yaw_rad, math.tau),
        )

    def nearest(self, x_m: float, y_m: float, around_m: float | None = None, ahead_m: float = AHEAD_M) -> OnPath:
        """The nearest place to a point; with ``around_m``, among those from 5 m back of that one to ``ahead_m``.

        Beyond its ends the path goes straight on, so that ``s_m`` may be negative or more than the length.
        """
        first, last = 0, len(self.s_m) - 1
        if around_m is not None:
            first = max(0, min(int(np.searchsorted(self.s_m, around_m - BACK_M)) - 1, last - 1))
            last = min(last, max(first + 1, int(np.searchsorted(self.s_m, around_m + ahead_m))))
        tails, legs = self.points_m[first:last, :2], np.diff(self.points_m[first : last + 1, :2], axis=0)
        legs_m = np.diff(self.s_m[first : last + 1])
        along_m = ((x_m - tails[:, 0]) * legs[:, 0] + (y_m - tails[:, 1]) * legs[:, 1]) / legs_m
        low_m, high_m = np.zeros(len(legs_m)), legs_m.copy()
        if first == 0:
            low_m[0] = -math.inf
        if last == len(self.s_m) - 1:
            high_m[-1] = math.inf
        along_m = np.clip(along_m, low_m, high_m)
        off_x_m = x_m - tails[:, 0] - along_m * legs[:, 0] / legs_m
        off_y_m = y_m - tails[:, 1] - along_m * legs[:, 1] / legs_m
        leg = int(np.argmin(off_x_m**2 + off_y_m**2))
        distance_m = math.hypot(off_x_m[leg], off_y_m[leg])
        right = legs[leg, 0] * off_y_m[leg] - legs[leg, 1] * off_x_m[leg]  # y points south: positive is to the right
        return OnPath(
            float(self.s_m[first + leg] + along_m[leg]), math.copysign(distance_m, float(right)), float(distance_m)
        )

    def part(self, from_m: float, to_m: float) -> Path:
        """The stretch between two places; cut at the path's ends."""
        from_m, to_m = max(0.0, from_m), min(to_m, self.length_m)
        if to_m - from_m <= NEAR_M:
            raise ScenarioError(f"a path of {self.length_m:.1f} m has no stretch from {from_m:.1f} to {to_m:.1f} m")
        inner = self.points_m[(self.s_m > from_m) & (self.s_m < to_m)]
        return Path.through([self.at(from_m)[:3], *inner, self.at(to_m)[:3]])

    def beside(self, right_m: float) -> Path:
        """The path so far to its right."""
        if not right_m:
            return self
        points_m = self.points_m.copy()
        points_m[:, 0] -= right_m * np.sin(self.yaw_rad)
        points_m[:, 1] += right_m * np.cos(self.yaw_rad)
        return Path.through(points_m)

    def swerved(self, from_m: float, over_m: float, left_at_m: float, to_m: float) -> Path:
        """The path with a smooth way from ``left_at_m`` to ``to_m`` on its right: the change begins at ``from_m``.

        Both are offsets to the right; the profile is the quintic 10u^3 - 15u^4 + 6u^5; its ends have neither slope
        nor curvature.
        """
        inner_m = np.arange(from_m, from_m + over_m, SWERVE_STEP_M)
        s_m = np.unique(np.concatenate([self.s_m, inner_m, [from_m + over_m]]))
        s_m = s_m[s_m >= min(0.0, from_m)]
        u = np.clip((s_m - from_m) / max(over_m, NEAR_M), 0.0, 1.0)
        right_m = left_at_m + (to_m - left_at_m) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
        return Path.through([self.at(float(s), float(r))[:3] for s, r in zip(s_m, right_m, strict=True)])

    def reversed(self) -> Path:
        """The path driven the other way."""
        return Path.through(self.points_m[::-1])

    def then(self, other: Path) -> Path:
        """This path and straight on to another."""
        return Path.through(np.concatenate([self.points_m, other.points_m]))
