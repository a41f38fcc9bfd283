"""The line to be followed: evenly spaced points with heading and curvature, and where a vehicle is on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.builtin.scene import VehicleGeometry

SPACING_M = 0.5  # between the points of a path
SMOOTHING_M = 2.0  # way points are averaged over this, twice: a bend of radius r is cut by SMOOTHING_M**2 / (12 r)
FINE_M = 0.05  # step of that averaging
LINE_MARGIN_M = 0.1  # kept to the lines of the lane in a bend, where the lane is wide enough
LOST_M = 6.0  # farther beside the path than this, the place is looked for anew on the whole of it
SAME_PLACE_M = 1.0  # two places that fit a pose about equally well: the earlier one is meant


class PathPosition(NamedTuple):
    """Where a point lies beside the path."""

    near: int  # the path point next to it
    s_m: float
    lateral_m: float  # to the right of the path
    heading_rad: float  # of the path there


@dataclass(frozen=True, slots=True, eq=False)
class SampledPath:
    """N points, ``SPACING_M`` apart; CARLA frame, headings and curvature positive clockwise (to the right).

    Lists, because a step looks at single points, where lists are several times faster; ``points_m`` for many at once.
    """

    points_m: NDArray[np.float64]  # (N, 2)
    x_m: list[float]
    y_m: list[float]
    s_m: list[float]  # arc length of the route this was made from, so that stops and signs keep their place on it
    heading_rad: list[float]  # without jumps of a whole turn
    curvature_1pm: list[float]

    @property
    def end_s_m(self) -> float:
        """Where the path ends."""
        return self.s_m[-1]

    def index_at(self, s_m: float) -> int:
        """The path point nearest to an arc length."""
        return min(max(round(s_m / SPACING_M), 0), len(self.s_m) - 1)

    def heading_at_rad(self, s_m: float) -> float:
        """The heading between two points."""
        return _between(self.heading_rad, s_m / SPACING_M)

    def curvature_at_1pm(self, s_m: float) -> float:
        """The curvature between two points."""
        return _between(self.curvature_1pm, s_m / SPACING_M)

    def find(self, x_m: float, y_m: float, yaw_rad: float) -> PathPosition:
        """The place of a pose anywhere on the path; where the path passes twice, the first time."""
        away_m = np.hypot(self.points_m[:, 0] - x_m, self.points_m[:, 1] - y_m)
        away_m += 10.0 * (
            1.0 - np.cos(np.asarray(self.heading_rad) - yaw_rad)
        )  # the other side of the street is not it
        first = int(np.flatnonzero(away_m <= away_m.min() + SAME_PLACE_M)[0])
        best = first + int(np.argmin(away_m[first : first + round(4 * SAME_PLACE_M / SPACING_M)]))
        return self.follow(x_m, y_m, best)

    def follow(self, x_m: float, y_m: float, index: int) -> PathPosition:
        """The place of a point that moved a little since it was next to path point ``index``."""
        last = len(self.s_m) - 1
        step = 0
        while True:
            dx_m, dy_m, heading_rad = x_m - self.x_m[index], y_m - self.y_m[index], self.heading_rad[index]
            cos, sin = math.cos(heading_rad), math.sin(heading_rad)
            along_m = dx_m * cos + dy_m * sin
            wanted = 1 if along_m > SPACING_M / 2 else -1 if along_m < -SPACING_M / 2 else 0
            # turning round between two points would go on for ever: on the inside of a bend both point at each other
            if wanted in (0, -step) or not 0 <= index + wanted <= last:
                break
            step = wanted
            index += wanted
        s_m = self.s_m[index] + along_m
        bulge_m = 0.5 * self.curvature_1pm[index] * along_m * along_m
        return PathPosition(index, s_m, dy_m * cos - dx_m * sin - bulge_m, self.heading_at_rad(s_m))

    def track(self, x_m: float, y_m: float, yaw_rad: float, index: int) -> PathPosition:
        """Like ``follow``, but a vehicle that was put far from its path is found again."""
        place = self.follow(x_m, y_m, index)
        return self.find(x_m, y_m, yaw_rad) if abs(place.lateral_m) > LOST_M else place


def make_path(
    points_m: NDArray[np.float64],
    s_m: NDArray[np.float64],
    lane_width_m: NDArray[np.float64] | None = None,
    body: VehicleGeometry | None = None,
) -> SampledPath:
    """Smooth a route's way points into a path.

    Args:
        points_m: (M, 2 or more) way points in driving order, CARLA frame.
        s_m: (M,) their arc length, strictly increasing from 0.
        lane_width_m: (M,) of the lane, and
        body: the vehicle that is to stay within it; without them the path keeps to the middle.
    """
    fine_s_m = np.arange(0.0, s_m[-1] + FINE_M / 2, FINE_M)
    half = min(round(SMOOTHING_M / FINE_M / 2), (len(fine_s_m) - 1) // 2)
    smooth = [_averaged(_averaged(np.interp(fine_s_m, s_m, points_m[:, axis]), half), half) for axis in (0, 1)]
    heading_rad, curvature_1pm = _shape(smooth[0], smooth[1])
    if body is not None and lane_width_m is not None:
        width_m = np.interp(fine_s_m, s_m, lane_width_m)
        inwards_m = _averaged(_averaged(_inwards_m(curvature_1pm, width_m, body), half), half)
        smooth = [smooth[0] - inwards_m * np.sin(heading_rad), smooth[1] + inwards_m * np.cos(heading_rad)]
        heading_rad, curvature_1pm = _shape(smooth[0], smooth[1])
    every = round(SPACING_M / FINE_M)
    x_m, y_m = smooth[0][::every], smooth[1][::every]
    return SampledPath(
        points_m=np.column_stack([x_m, y_m]),
        x_m=x_m.tolist(),
        y_m=y_m.tolist(),
        s_m=fine_s_m[::every].tolist(),
        heading_rad=heading_rad[::every].tolist(),
        curvature_1pm=curvature_1pm[::every].tolist(),
    )


def _shape(x_m: NDArray[np.float64], y_m: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Heading in rad and curvature in 1/m of closely spaced points."""
    heading_rad = np.unwrap(np.arctan2(np.gradient(y_m), np.gradient(x_m)))
    arc_m = np.hypot(np.gradient(x_m), np.gradient(y_m))
    turning = np.gradient(heading_rad) / np.maximum(arc_m, FINE_M / 10)
    return heading_rad, _averaged(turning, min(round(SPACING_M / FINE_M), (len(turning) - 1) // 2))


def _inwards_m(
    curvature_1pm: NDArray[np.float64], lane_width_m: NDArray[np.float64], body: VehicleGeometry
) -> NDArray[np.float64]:
    """How far to the right of the smoothed way a turning body has to be driven to stay within its lane. All (F,).

    Its outer front corner swings out farther than its inner side cuts in: the circle of the rear axle, around which
    both turn, lies inside that of the origin (kinematic bicycle, as in ``controllers``).
    """
    bend_1pm = np.maximum(np.abs(curvature_1pm), 1e-3)
    radius_m = np.maximum(1.0 / bend_1pm, 1.5 * body.rear_axle_m)
    rear_radius_m = np.sqrt(radius_m**2 - body.rear_axle_m**2)
    outwards_m = np.hypot(rear_radius_m + body.half_width_m, body.rear_axle_m + body.front_m) - radius_m
    inside_m = radius_m - (rear_radius_m - body.half_width_m)
    beyond_m = outwards_m - (lane_width_m / 2 - LINE_MARGIN_M)
    # where the lane is too narrow for both sides, they share what is lacking
    wanted_m = np.minimum(beyond_m, (outwards_m - inside_m) / 2)
    shift_m = np.maximum(wanted_m - SMOOTHING_M**2 / 12 * bend_1pm, 0.0)
    return np.where(bend_1pm > 1e-3, np.sign(curvature_1pm) * shift_m, 0.0)


def _between(values: list[float], position: float) -> float:
    """The value at a broken index, in a straight line between its neighbours; constant beyond the ends."""
    last = len(values) - 1
    first = min(max(int(position), 0), last - 1)
    share = min(max(position - first, 0.0), 1.0)
    return values[first] + share * (values[first + 1] - values[first])


def _averaged(values: NDArray[np.float64], half: int) -> NDArray[np.float64]:
    """The mean over ``2 half + 1`` neighbours; beyond the ends the line is taken to go straight on."""
    if half == 0:
        return values
    before = 2 * values[0] - values[half:0:-1]
    after = 2 * values[-1] - values[-2 : -half - 2 : -1]
    sums = np.concatenate([[0.0], np.cumsum(np.concatenate([before, values, after]))])
    width = 2 * half + 1
    means: NDArray[np.float64] = (sums[width:] - sums[:-width]) / width
    return means
