"""What a snapshot row says of a vehicle beside its motion, written into the packed bytes by one compiled pass.

Rows are 119 bytes, so their numbers lie unaligned: they are written byte by byte. Offsets: values.snapshot.VEHICLE_ROW.
"""

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.ground import Ground, surface_under
from linden.values.snapshot import VEHICLE_ROW

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Flags = NDArray[np.bool_]


def _offset(field: str) -> int:
    assert VEHICLE_ROW.fields is not None
    return int(VEHICLE_ROW.fields[field][1])


_THROTTLE, _STEER, _BRAKE = _offset("throttle"), _offset("steer"), _offset("brake")
_HAND_BRAKE, _REVERSE, _MANUAL = _offset("hand_brake"), _offset("reverse"), _offset("manual_gear_shift")
FAILURE_STATE = _offset("failure_state")
_GEAR, _SPEED_LIMIT = _offset("gear"), _offset("speed_limit")
_LIGHT_STATE, _HAS_LIGHT, _LIGHT_ID = (
    _offset("traffic_light_state"),
    _offset("has_traffic_light"),
    _offset("traffic_light_id"),
)


@kernel
def _put_word(row: U8, offset: int, word: int) -> None:  # pragma: no cover - compiled
    for byte in range(4):
        row[offset + byte] = (word >> (8 * byte)) & 0xFF


@kernel
def _put_float(row: U8, offset: int, value: float) -> None:  # pragma: no cover - compiled
    _put_word(row, offset, np.float32(value).view(np.uint32))  # type: ignore[arg-type] # a number to numba


@kernel
def write_controls(
    rows: U8,
    row_of: I32,
    slots: I32,
    throttle: F64,
    steer: F64,
    brake: F64,
    hand_brake: Flags,
    reverse: Flags,
    manual: Flags,
    gear: I32,
) -> None:  # pragma: no cover - compiled
    """Write the controls in force of vehicle i, whose body lies in ``slots[i]``, into ``rows[row_of[i]]``."""
    for i in range(len(slots)):
        row, slot = rows[row_of[i]], slots[i]
        _put_float(row, _THROTTLE, throttle[slot])
        _put_float(row, _STEER, steer[slot])
        _put_float(row, _BRAKE, brake[slot])
        row[_HAND_BRAKE] = hand_brake[slot]
        row[_REVERSE] = reverse[slot]
        row[_MANUAL] = manual[slot]
        _put_word(row, _GEAR, gear[slot])


@kernel
def write_surroundings(
    rows: U8, row_of: I32, speed_limit_kmh: F64, light: I32, light_state: U8, light_actor_id: I32, at_sign: U8
) -> None:  # pragma: no cover - compiled
    """Write the limit (V,) in force and the light (V,) over each vehicle: an index into the next two, or -1.

    ``at_sign`` (V,) is the colour of those who are under none.
    """
    for i in range(len(row_of)):
        row = rows[row_of[i]]
        _put_float(row, _SPEED_LIMIT, speed_limit_kmh[i])
        if light[i] >= 0:
            row[_LIGHT_STATE], row[_HAS_LIGHT] = light_state[light[i]], 1
            _put_word(row, _LIGHT_ID, light_actor_id[light[i]])
        else:
            row[_LIGHT_STATE], row[_HAS_LIGHT] = at_sign[i], 0
            _put_word(row, _LIGHT_ID, 0)


@kernel
def limits_under(
    ground: Ground, lane_of_triangle: I32, limit_of_lane_kmh: F64, position: F64, slots: I32, speed_limit_kmh: F64
) -> None:  # pragma: no cover - compiled
    """Bring ``speed_limit_kmh`` (V,) up to date; off the road, or where the map says nothing, the last one holds."""
    for i in range(len(slots)):
        at = position[slots[i]]
        triangle = surface_under(ground, at[0], at[1], at[2])[4]
        if triangle >= 0:
            limit = limit_of_lane_kmh[lane_of_triangle[triangle]]
            if limit > 0.0:  # False where it is unknown, which is nan
                speed_limit_kmh[i] = limit
