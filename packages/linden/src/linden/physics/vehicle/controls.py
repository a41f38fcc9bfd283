"""The controls of many vehicles, set at once: the kernel behind ``VehicleApi.set_controls``."""

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.physics.state import Rows

_MOST_GEAR = 99.0


@kernel
def set_controls(
    rows: Rows, slots: NDArray[np.int32], controls: NDArray[np.float64]
) -> None:  # pragma: no cover - compiled
    """Write controls (K, 7), in the order of VehicleControl's fields, into the bodies in ``slots`` (K,), in that order.

    Throttle and brake are held in [0, 1], the steering in [-1, 1]; what is no number is 0.
    """
    for i in range(len(slots)):
        v, asked = rows[slots[i]], controls[i]
        v.throttle = _within(asked[0], 0.0, 1.0)
        v.steer = _within(asked[1], -1.0, 1.0)
        v.brake = _within(asked[2], 0.0, 1.0)
        v.hand_brake = asked[3] != 0.0
        v.reverse = asked[4] != 0.0
        v.manual_gear_shift = asked[5] != 0.0
        v.gear_command = np.int32(_within(asked[6], -1.0, _MOST_GEAR))
        v.ackermann_on = False
        v.controlled = True


@kernel
def _within(value: float, least: float, most: float) -> float:  # pragma: no cover - compiled
    if np.isnan(value):
        return 0.0
    return max(least, min(most, value))
