"""Comfort: acceleration and jerk as passengers feel them. Reported, not scored.

The comfort limits of normal driving here are 1.0 m/s² and 1.0 m/s³. Accelerations come from the recorded velocities,
along and across the vehicle, over a window of 0.5 s: what a standing passenger has to answer, not a wheel's
rattle. The jerk is the change of that smoothed acceleration, smoothed over the same window once more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.history import History

WINDOW_S = 0.5


class Comfort(NamedTuple):
    """Largest and 99th-percentile magnitudes, m/s² and m/s³."""

    longitudinal_max_mps2: float
    longitudinal_p99_mps2: float
    lateral_max_mps2: float
    lateral_p99_mps2: float
    jerk_max_mps3: float  # longitudinal
    jerk_p99_mps3: float


def comfort(history: History) -> Comfort | None:
    """The figures, or None for a run shorter than two windows: not measurable is not zero."""
    step_s = history.facts.step_s
    width = max(1, round(WINDOW_S / step_s))
    if len(history.frames) < 2 * width + 2:
        return None
    frames = history.frames
    yaw_rad = frames["yaw_rad"]
    forward_mps = frames["velocity_x_mps"] * np.cos(yaw_rad) + frames["velocity_y_mps"] * np.sin(yaw_rad)
    along_mps2 = _smooth(np.diff(forward_mps) / step_s, width)
    turning_radps = np.diff(np.unwrap(yaw_rad)) / step_s
    across_mps2 = _smooth(forward_mps[1:] * turning_radps, width)
    jerk_mps3 = _smooth(np.diff(along_mps2) / step_s, width)
    return Comfort(*_extremes(along_mps2), *_extremes(across_mps2), *_extremes(jerk_mps3))


def _smooth(values: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Moving mean over ``width`` values."""
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")


def _extremes(values: NDArray[np.float64]) -> tuple[float, float]:
    """The largest magnitude and the 99th percentile of magnitudes."""
    magnitude = np.abs(values)
    return float(magnitude.max()), float(np.percentile(magnitude, 99.0))
