"""The rows of the world snapshot: kernels that write the motion of all actors and the state of vehicles.

The motion is 15 numbers a row. One compiled pass writes a vehicle's state. Rows are 119 bytes, so their numbers lie
unaligned and are written byte by byte. Offsets: values.snapshot.VEHICLE_ROW.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.maps.ground import Ground, surface_under
from linden.protocol.values.snapshot import VEHICLE_ROW

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

MOTION_OFFSET = 5
"""Byte at which location, rotation, velocity, angular velocity and acceleration begin in a row; see values.snapshot."""


@kernel
def _axes(pitch_deg: float, yaw_deg: float, roll_deg: float) -> F64:  # pragma: no cover - compiled
    """Return the (3, 3) matrix of ``linden.geometry.rotation_matrix``."""
    sp, cp = math.sin(math.radians(pitch_deg)), math.cos(math.radians(pitch_deg))
    sy, cy = math.sin(math.radians(yaw_deg)), math.cos(math.radians(yaw_deg))
    sr, cr = math.sin(math.radians(roll_deg)), math.cos(math.radians(roll_deg))
    axes = np.empty((3, 3))
    axes[0, 0], axes[0, 1], axes[0, 2] = cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr
    axes[1, 0], axes[1, 1], axes[1, 2] = cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr
    axes[2, 0], axes[2, 1], axes[2, 2] = sp, -cp * sr, cp * cr
    return axes


@kernel
def _follow(parent: F64, relative: F64, pose: F64) -> None:  # pragma: no cover - compiled
    """Write into ``pose`` (6,) where a child with ``relative`` (6,) to its ``parent`` (6,) is; m and degrees."""
    outer = _axes(parent[3], parent[4], parent[5])
    inner = _axes(relative[3], relative[4], relative[5])
    turn = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                turn[i, j] += outer[i, k] * inner[k, j]
    for axis in range(3):
        pose[axis] = (
            parent[axis] + outer[axis, 0] * relative[0] + outer[axis, 1] * relative[1] + outer[axis, 2] * relative[2]
        )
    sine = min(1.0, max(-1.0, turn[2, 0]))
    pose[3] = math.degrees(math.asin(sine))
    if abs(sine) > 1.0 - 1e-12:  # straight up or down: yaw and roll turn about one axis, so all of it is roll
        pose[4] = 0.0
        pose[5] = math.degrees(math.atan2(math.copysign(1.0, sine) * turn[0, 1], turn[1, 1]))
    else:
        pose[4] = math.degrees(math.atan2(turn[1, 0], turn[0, 0]))
        pose[5] = math.degrees(math.atan2(-turn[2, 1], turn[2, 2]))


@kernel
def gather_motion(
    count: int,
    pose: F64,
    relative: F64,
    parent_row: I32,
    slot: I32,
    position: F64,
    rotation: F64,
    velocity: F64,
    angular_velocity: F64,
    acceleration: F64,
    motion: F32,
) -> None:  # pragma: no cover - compiled
    """Bring ``pose`` up to date for the first ``count`` actors and write ``motion`` (N, 15) for the snapshot.

    Angles of bodies are in (-180, 180] degrees, as Unreal's ``FRotator::NormalizeAxis`` has them.
    ``pose``, ``relative``: (N, 6) m and degrees. The rest are columns of the bodies, (M, 3), SI with radians, read
    where ``slot`` is not negative. Parents stand further up than their children, so one pass is enough.
    """
    for row in range(count):
        body = slot[row]
        motion[row, 6:15] = 0.0
        if body >= 0:
            for axis in range(3):
                pose[row, axis] = position[body, axis]
                degrees = math.degrees(rotation[body, axis])
                pose[row, 3 + axis] = degrees - 360.0 * math.ceil((degrees - 180.0) / 360.0)
                motion[row, 6 + axis] = velocity[body, axis]
                motion[row, 9 + axis] = math.degrees(angular_velocity[body, axis])
                motion[row, 12 + axis] = acceleration[body, axis]
        elif parent_row[row] >= 0:
            _follow(pose[parent_row[row]], relative[row], pose[row])
        for axis in range(6):
            motion[row, axis] = pose[row, axis]


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
    """Write the controls in force of vehicle i with its body in ``slots[i]``, into ``rows[row_of[i]]``."""
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

    ``at_sign`` (V,) is the colour for vehicles under no light.
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
