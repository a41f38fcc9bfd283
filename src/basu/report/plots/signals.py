"""What a report plots against time: speed and its limit, acceleration, jerk, distance from the lane's middle."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.comfort import WINDOW_S
from basu.metrics.speeding import limits_mps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.history import History

STANDING_MPS = 0.1  # slower than this the vehicle stands, as for stop signs


class Signals(NamedTuple):
    """All (T,), one value a tick."""

    t_s: NDArray[np.float64]
    speed_mps: NDArray[np.float64]
    limit_mps: NDArray[np.float64]  # nan where none is posted
    along_mps2: NDArray[np.float64]  # acceleration, + forward
    across_mps2: NDArray[np.float64]  # + to the right
    jerk_mps3: NDArray[np.float64]  # of the acceleration along
    offset_m: NDArray[np.float64]  # off the lane's middle, + to the right; nan where there is no lane
    manual: NDArray[np.bool_]  # a person drives


def signals(history: History) -> Signals:
    """The signals of a record.

    Accelerations are means over a window of 0.5 s about each tick, the jerk one of means twice, as in
    :mod:`basu.metrics.comfort`; they come from recorded velocities.
    """
    frames, step_s = history.frames, history.facts.step_s
    yaw_rad = frames["yaw_rad"]
    forward_mps = frames["velocity_x_mps"] * np.cos(yaw_rad) + frames["velocity_y_mps"] * np.sin(yaw_rad)
    width = max(1, round(WINDOW_S / step_s))
    along_mps2 = _smooth(_change(forward_mps) / step_s, width)
    limit_mps = limits_mps(history)
    return Signals(
        t_s=frames["t_s"].astype(np.float64),
        speed_mps=history.speed_mps(),
        limit_mps=np.where(np.isfinite(limit_mps), limit_mps, np.nan),
        along_mps2=along_mps2,
        across_mps2=_smooth(forward_mps * _change(np.unwrap(yaw_rad)) / step_s, width),
        jerk_mps3=_smooth(_change(along_mps2) / step_s, width),
        offset_m=frames["lane_offset_m"].astype(np.float64),
        manual=frames["manual"].astype(np.bool_),
    )


def stretches(holds: NDArray[np.bool_], t_s: NDArray[np.float64]) -> list[tuple[float, float]]:
    """From when to when ``holds`` (T,) holds: (first, last) in s of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8))).reshape(-1, 2)
    return [(float(t_s[first]), float(t_s[end - 1])) for first, end in edges.tolist()]


def _change(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """From each value to the one before it; 0 for the first."""
    return np.diff(values, prepend=values[:1])


def _smooth(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Mean over ``width`` values about each, over fewer at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    index = np.arange(len(values))
    low, high = np.maximum(0, index - width // 2), np.minimum(len(values), index - width // 2 + width)
    mean: NDArray[np.float64] = (sums[high] - sums[low]) / (high - low)
    return mean
