"""`Strip`, the path section near the vehicle, and `Footprint`, the extent of another actor in path coordinates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.scene import Other

BEHIND_M = 6.0  # the strip begins this far behind the vehicle's origin …
AHEAD_M = 55.0  # … and ends this far ahead


class Footprint(NamedTuple):
    """A body's extent along and across the path, m; ``left_m`` < ``right_m``, positive to the right."""

    from_s_m: float
    to_s_m: float
    left_m: float
    right_m: float
    heading_rad: float  # of the path beside it

    def overlaps(self, half_width_m: float) -> bool:
        """Whether it reaches into a strip of that half width."""
        return self.left_m < half_width_m and self.right_m > -half_width_m


class Strip:
    """The part of the path near the vehicle, cut out once a step."""

    def __init__(self, path: SampledPath, place: PathPosition) -> None:
        self._first = path.index_at(place.s_m - BEHIND_M)
        end = path.index_at(place.s_m + AHEAD_M) + 1
        self._points_m = path.points_m[self._first : end]
        self._headings_rad = path.heading_rad[self._first : end]
        self._path = path

    def leads_against(self, yaw_rad: float, least_rad: float) -> bool:
        """Return whether a heading differs by more than ``least_rad`` from every heading of the strip."""
        low_rad, high_rad = min(self._headings_rad), max(self._headings_rad)
        off_rad = abs(math.remainder(yaw_rad - 0.5 * (low_rad + high_rad), math.tau))
        return off_rad - 0.5 * (high_rad - low_rad) > least_rad

    def away_m(self, others: Sequence[Other]) -> list[float]:
        """How far each body's centre is from the strip's middle line."""
        centres_m = np.array([(other.x_m, other.y_m) for other in others])
        gaps = centres_m[:, None, :] - self._points_m[None, :, :]  # (N, W, 2)
        distances: list[float] = np.sqrt(np.einsum("nwd,nwd->nw", gaps, gaps).min(axis=1)).tolist()
        return distances

    def footprint(self, other: Other, after_s: float = 0.0) -> Footprint | None:
        """The extent of a body now, or after driving straight on for a while; None where it is off the strip's ends."""
        corners_m = _corners_m(other, after_s)
        gaps = corners_m[:, None, :] - self._points_m[None, :, :]  # (4, W, 2)
        nearest = np.einsum("kwd,kwd->kw", gaps, gaps).argmin(axis=1).tolist()
        if min(nearest) == len(self._points_m) - 1 or max(nearest) == 0:
            return None
        along_m, across_m = [], []
        for (x_m, y_m), near in zip(corners_m.tolist(), nearest, strict=True):
            place = self._path.follow(x_m, y_m, self._first + near)
            along_m.append(place.s_m)
            across_m.append(place.lateral_m)
        middle = self._first + nearest[0]
        return Footprint(
            min(along_m), max(along_m), min(across_m), max(across_m), heading_rad=self._path.heading_rad[middle]
        )


def _corners_m(other: Other, after_s: float) -> NDArray[np.float64]:
    """(4, 2) the corners of a body's box after a while of moving straight on."""
    x_m = other.x_m + other.velocity_x_mps * after_s
    y_m = other.y_m + other.velocity_y_mps * after_s
    cos, sin = math.cos(other.yaw_rad), math.sin(other.yaw_rad)
    ax, ay = other.half_length_m * cos, other.half_length_m * sin
    bx, by = -other.half_width_m * sin, other.half_width_m * cos
    return np.array(
        [
            (x_m + ax + bx, y_m + ay + by),
            (x_m + ax - bx, y_m + ay - by),
            (x_m - ax + bx, y_m - ay + by),
            (x_m - ax - bx, y_m - ay - by),
        ]
    )
