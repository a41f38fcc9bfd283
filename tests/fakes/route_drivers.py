"""Drivers of the vector environments that see observations alone."""

import numpy as np
from numpy.typing import NDArray

BRAKING_MPS2 = 0.8
Seen = dict[str, NDArray[np.float32]]


def careful(seen: Seen, cruise_mps: float) -> NDArray[np.float64]:
    """Return actions (N, 2): along the route at a comfortable pace, with a stop at each stop sign."""
    to_line_m = np.where(seen["stop_sign"][:, 0] > 0.0, seen["stop_sign"][:, 1], np.inf)
    wanted_mps = np.minimum(cruise_mps, np.sqrt(2.0 * BRAKING_MPS2 * np.maximum(0.0, to_line_m - 1.0)))
    x_m, y_m = seen["route"][:, 0].T
    pedals = np.clip(0.4 * (wanted_mps - seen["ego"][:, 0]), -0.5, 0.25)
    pedals[to_line_m < 1.2] = -0.4
    return np.column_stack([pedals, 1.2 * np.arctan2(y_m, x_m)])


def without_signs(seen: Seen) -> Seen:
    """Return the observation of a driver that sees no stop sign."""
    return {**seen, "stop_sign": np.zeros_like(seen["stop_sign"])}
