"""Where a driver that means to crash leaves its way, and what it hits: chosen from what stands beside the street."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from basu.agents.builtin.driving.path import Path
    from basu.agents.builtin.scene import Ego

AROUND_M = 60.0  # from the place asked for: what is looked at
NEAREST_M, FARTHEST_M = 4.5, 20.0  # beside the path: off the road, and not so far that the run ends on the way
LEFT_M = 25.0  # what stands to the left, across the other lane, has to be so much nearer to the place
LEAVES_M, LEAVES_PER_M = 10.0, 1.8  # so far before the thing, plus so much for each metre that it lies aside
CLEAR_M = 1.5  # kept free to both sides on the way to it: half a car, and what its steering may be off
TIGHTEST_MPS2 = 6.0  # sideways, when the wheel is turned at speed
AIM_M = 8.0  # from farther away one aims this far ahead


class Thing(NamedTuple):
    """An upright box beside the street; CARLA frame, m and rad."""

    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: float
    half_width_m: float


class Deviation(NamedTuple):
    """Leave the path at ``leaves_s_m`` and drive straight at the thing, which stands beside ``hits_s_m``."""

    leaves_s_m: float
    hits_s_m: float
    thing: Thing


def choose(path: Path, things: Sequence[Thing], at_s_m: float) -> Deviation | None:
    """The thing nearest to beside ``at_s_m`` that can be driven at with nothing between; None where there is none."""
    middle = path.index_at(at_s_m)
    near = [t for t in things if math.hypot(t.x_m - path.x_m[middle], t.y_m - path.y_m[middle]) < AROUND_M]
    candidates = []
    for number, thing in enumerate(near):
        place = path.follow(thing.x_m, thing.y_m, middle)
        if NEAREST_M < abs(place.lateral_m) < FARTHEST_M:
            cost_m = abs(place.s_m - at_s_m) + (LEFT_M if place.lateral_m < 0.0 else 0.0)
            candidates.append((cost_m, number, place))
    for _, number, place in sorted(candidates):
        leaves_s_m = place.s_m - LEAVES_M - LEAVES_PER_M * abs(place.lateral_m)
        others = [thing for other, thing in enumerate(near) if other != number]
        if leaves_s_m > 0.0 and _is_clear(path, leaves_s_m, near[number], others):
            return Deviation(leaves_s_m, place.s_m, near[number])
    return None


def _is_clear(path: Path, from_s_m: float, thing: Thing, others: Sequence[Thing]) -> bool:
    """Whether nothing else stands on the way from a place on the path to the thing's nearer side."""
    start = path.index_at(from_s_m)
    x_m, y_m = path.x_m[start], path.y_m[start]
    distance_m = math.hypot(thing.x_m - x_m, thing.y_m - y_m)
    share = np.arange(0.0, max(distance_m - max(thing.half_length_m, thing.half_width_m), 0.0), 0.5) / distance_m
    way_m = np.column_stack([x_m + share * (thing.x_m - x_m), y_m + share * (thing.y_m - y_m)])
    return not any(_reaches(other, way_m) for other in others)


def _reaches(thing: Thing, points_m: NDArray[np.float64]) -> bool:
    """Whether a box, grown by ``CLEAR_M``, holds one of the points (N, 2)."""
    gaps_m = points_m - (thing.x_m, thing.y_m)
    cos, sin = math.cos(thing.yaw_rad), math.sin(thing.yaw_rad)
    along_m = np.abs(gaps_m[:, 0] * cos + gaps_m[:, 1] * sin)
    across_m = np.abs(gaps_m[:, 1] * cos - gaps_m[:, 0] * sin)
    return bool(((along_m < thing.half_length_m + CLEAR_M) & (across_m < thing.half_width_m + CLEAR_M)).any())


def aim_rad(ego: Ego, thing: Thing, wheelbase_m: float) -> float:
    """The front wheels' angle with which to drive at the thing, positive to the right.

    Pure pursuit (Coulter 1992, "Implementation of the pure pursuit path tracking algorithm"), no tighter than tyres
    bear.
    """
    dx_m, dy_m = thing.x_m - ego.x_m, thing.y_m - ego.y_m
    off_rad = math.remainder(math.atan2(dy_m, dx_m) - ego.yaw_rad, math.tau)
    bend_1pm = 2.0 * math.sin(max(-1.5, min(1.5, off_rad))) / max(min(math.hypot(dx_m, dy_m), AIM_M), 1.0)
    tightest_1pm = TIGHTEST_MPS2 / max(ego.speed_mps, 1.0) ** 2
    return math.atan(wheelbase_m * max(-tightest_1pm, min(tightest_1pm, bend_1pm)))
