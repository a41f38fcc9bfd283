"""Maximum speeds and slowdowns along a path, `SpeedProfile`: posted limits, a cap, lateral acceleration and jerk."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from basu.agents.builtin.driving.manner import BASIC

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import SampledPath

LATERAL_ACCEL_MPS2 = BASIC.lateral_accel_mps2
LATERAL_JERK_MPS3 = BASIC.lateral_jerk_mps3
SLOWEST_MPS = 1.5  # no bend is driven slower than this
STEP_MPS = 0.1  # bends are driven at multiples of this, so that a bend is one speed and not a shiver of many
AROUND_M = 1.5  # the least limit this near before and behind holds, for the same reason
SAVED_MPS = 0.1  # a slowdown is left out where the next one already brings the speed this near to it
BRAKING_MPS2 = 0.8  # assumed in deciding which slowdowns matter; the planner brakes a little harder


@dataclass(frozen=True, slots=True)
class SpeedProfile:
    """The greatest speeds, and the few places where one has to be slower than just before."""

    limit_mps: list[float]  # (N,) beside the path's points
    slowdown_s_m: list[float]  # ascending
    slowdown_mps: list[float]  # the speed to have reached there

    def slowdowns(self, s_m: float, horizon_m: float) -> list[tuple[float, float]]:
        """Distances and speeds of the slowdowns ahead of ``s_m`` within the horizon."""
        first, end = bisect_right(self.slowdown_s_m, s_m), bisect_right(self.slowdown_s_m, s_m + horizon_m)
        return [(self.slowdown_s_m[i] - s_m, self.slowdown_mps[i]) for i in range(first, end)]


def bend_limit_mps(
    curvature_1pm: NDArray[np.float64],
    spacing_m: float,
    accel_mps2: float = LATERAL_ACCEL_MPS2,
    jerk_mps3: float = LATERAL_JERK_MPS3,
) -> NDArray[np.float64]:
    """The speed at which neither sideways push (v² k) nor its onset (v³ dk/ds) is felt too much. (N,) to (N,)."""
    bend = np.maximum(np.abs(curvature_1pm), 1e-6)
    onset = np.maximum(np.abs(np.gradient(curvature_1pm, spacing_m)), 1e-9)
    slow = np.minimum(np.sqrt(accel_mps2 / bend), np.cbrt(jerk_mps3 / onset))
    around = round(AROUND_M / spacing_m)
    slowest_near = np.lib.stride_tricks.sliding_window_view(np.pad(slow, around, mode="edge"), 2 * around + 1).min(
        axis=1
    )
    return np.asarray(np.maximum(np.floor(slowest_near / STEP_MPS) * STEP_MPS, SLOWEST_MPS))


def make_profile(
    path: SampledPath, posted_mps: NDArray[np.float64], cap_mps: float, spacing_m: float, manner: Manner = BASIC
) -> SpeedProfile:
    """Combine the limits along a path.

    Args:
        path: N points.
        posted_mps: (N,) the posted limits beside them, nan where there is none.
        cap_mps: what the vehicle does at most.
        spacing_m: between the points.
        manner: what bends may feel like, and what is kept to a posted limit.
    """
    posted = np.where(np.isnan(posted_mps), np.inf, posted_mps + manner.above_limit_mps)
    bends = bend_limit_mps(
        np.asarray(path.curvature_1pm), spacing_m, manner.lateral_accel_mps2, manner.lateral_jerk_mps3
    )
    limit = np.minimum(np.minimum(posted, cap_mps), bends)
    limit = np.maximum(limit, SLOWEST_MPS)
    places: list[int] = []
    next_mps, next_index = np.inf, len(limit)
    for i in range(len(limit) - 1, 0, -1):
        implied_mps = (next_mps**2 + 2.0 * BRAKING_MPS2 * spacing_m * (next_index - i)) ** 0.5
        if limit[i] < limit[i - 1] and limit[i] < implied_mps - SAVED_MPS:
            places.append(i)
            next_mps, next_index = float(limit[i]), i
    places.reverse()
    return SpeedProfile(
        limit_mps=limit.tolist(),
        slowdown_s_m=[path.s_m[i] for i in places],
        slowdown_mps=[float(limit[i]) for i in places],
    )
