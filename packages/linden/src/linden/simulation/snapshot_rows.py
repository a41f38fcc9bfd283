"""The rows of the world snapshot: kernels that write the motion of all actors and the state of vehicles.

The motion is 15 numbers a row. One compiled pass writes a vehicle's state. Rows are 119 bytes, so their numbers lie
unaligned and are written byte by byte. Offsets: values.snapshot.VEHICLE_ROW.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel, part
from linden.maps.ground import Ground, surface_under
from linden.protocol.values.snapshot import VEHICLE_ROW

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

MOTION_OFFSET = 5
"""Byte at which location, rotation, velocity, angular velocity and acceleration begin in a row; see values.snapshot."""


@part
def _axes(pose: F64) -> tuple[tuple[float, float, float], ...]:  # pragma: no cover - compiled
    """Return the rows of the matrix of ``linden.geometry.rotation_matrix`` for a pose (6,); angles in degrees."""
    sp, cp = math.sin(math.radians(pose[3])), math.cos(math.radians(pose[3]))
    sy, cy = math.sin(math.radians(pose[4])), math.cos(math.radians(pose[4]))
    sr, cr = math.sin(math.radians(pose[5])), math.cos(math.radians(pose[5]))
    return (
        (cp * cy, cy * sp * sr - sy * cr, -cy * sp * cr - sy * sr),
        (cp * sy, sy * sp * sr + cy * cr, -sy * sp * cr + cy * sr),
        (sp, -cp * sr, cp * cr),
    )


@part
def _turned(row: tuple[float, ...], axes: tuple[tuple[float, ...], ...], column: int) -> float:  # pragma: no cover
    return 0.0 + row[0] * axes[0][column] + row[1] * axes[1][column] + row[2] * axes[2][column]


@part
def follow(parent: F64, relative: F64, pose: F64) -> None:  # pragma: no cover - compiled
    """Write into ``pose`` (6,) where a child with ``relative`` (6,) to its ``parent`` (6,) is; m and degrees."""
    outer, inner = _axes(parent), _axes(relative)
    for axis in range(3):
        own = outer[axis]
        pose[axis] = parent[axis] + own[0] * relative[0] + own[1] * relative[1] + own[2] * relative[2]
    x_axis, y_axis, up = outer[0], outer[1], outer[2]
    sine = min(1.0, max(-1.0, _turned(up, inner, 0)))
    pose[3] = math.degrees(math.asin(sine))
    if abs(sine) > 1.0 - 1e-12:  # straight up or down: yaw and roll turn about one axis, so all of it is roll
        pose[4] = 0.0
        pose[5] = math.degrees(
            math.atan2(math.copysign(1.0, sine) * _turned(x_axis, inner, 1), _turned(y_axis, inner, 1))
        )
    else:
        pose[4] = math.degrees(math.atan2(_turned(y_axis, inner, 0), _turned(x_axis, inner, 0)))
        pose[5] = math.degrees(math.atan2(-_turned(up, inner, 1), _turned(up, inner, 2)))


@part
def put_pose(position: F64, rotation: F64, pose: F64) -> None:  # pragma: no cover - compiled
    """Write the pose (6,) of a body at ``position`` (3,) in m with ``rotation`` (3,) in rad.

    Its angles are in (-180, 180] degrees, as Unreal's ``FRotator::NormalizeAxis`` has them.
    """
    for axis in range(3):
        pose[axis] = position[axis]
        degrees = math.degrees(rotation[axis])
        pose[3 + axis] = degrees - 360.0 * math.ceil((degrees - 180.0) / 360.0)


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

    ``pose``, ``relative``: (N, 6) m and degrees. The rest are columns of the bodies, (M, 3), SI with radians, read
    where ``slot`` is not negative. Parents stand further up than their children, so one pass is enough.
    """
    for row in range(count):
        body = slot[row]
        motion[row, 6:15] = 0.0
        if body >= 0:
            put_pose(position[body], rotation[body], pose[row])
            for axis in range(3):
                motion[row, 6 + axis] = velocity[body, axis]
                motion[row, 9 + axis] = math.degrees(angular_velocity[body, axis])
                motion[row, 12 + axis] = acceleration[body, axis]
        elif parent_row[row] >= 0:
            follow(pose[parent_row[row]], relative[row], pose[row])
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
