"""The inertial unit: acceleration, turning rate and compass, measured in the sensor's own frame.

Source of meaning: CARLA 0.9.16, InertialMeasurementUnit.cpp. Three of its faults are left out: it takes the world's
origin for the places before the first, so its second measurement leaps; it turns the rate of a unit mounted askew the
wrong way round; and with a ``sensor_tick`` it takes the time of a frame for that between two measurements.
"""

import math
from typing import NamedTuple

from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform, Vector3D
from linden.sensors.devices.attributes import ImuSpec
from linden.sensors.devices.noise import gaussian


class ImuMeasurement(NamedTuple):
    """m/s² with gravity, rad/s, and the heading in rad: 0 north, growing clockwise, below 2π."""

    accelerometer: Vector3D
    gyroscope: Vector3D
    compass: float


class Trace(NamedTuple):
    """Where the sensor was at its last two measurements (world, m) and when (s), the later first."""

    last: Vector3D | None = None
    before: Vector3D | None = None
    last_s: float = 0.0
    before_s: float = 0.0


def extend(trace: Trace, location: Vector3D, now_s: float) -> Trace:
    """Return the trace after a measurement."""
    return Trace(location, trace.last, now_s, trace.last_s)


def acceleration(trace: Trace, location: Vector3D, now_s: float) -> Vector3D:
    """Return the second derivative (world, m/s²) of the parabola through the last two places and this one.

    Zero until there are three. It is twice the second divided difference (Burden and Faires, Numerical Analysis, 3.3),
    which for even steps is the usual (here - 2 last + before) / dt².
    """
    if trace.last is None or trace.before is None:
        return Vector3D()
    late_s, early_s = now_s - trace.last_s, trace.last_s - trace.before_s
    if min(late_s, early_s) <= 0.0:
        return Vector3D()
    x, y, z = (
        2.0 * ((here - last) / late_s - (last - before) / early_s) / (late_s + early_s)
        for here, last, before in zip(location, trace.last, trace.before, strict=True)
    )
    return Vector3D(x, y, z)


def compass_rad(forward_x: float, forward_y: float) -> float:
    """Return the heading of a direction in the world: 0 along -y, which is north, π/2 along x."""
    heading = math.atan2(forward_x, -forward_y)
    return heading if heading >= 0.0 else math.fmod(heading + math.tau, math.tau)


def measure(
    spec: ImuSpec,
    number: int,
    pose: Transform,
    acceleration_mps2: Vector3D,
    angular_velocity_radps: Vector3D,
    gravity_mps2: float,
) -> ImuMeasurement:
    """Return measurement ``number`` of a unit at ``pose``, with this acceleration and this turning rate of its carrier.

    Both vectors are in the world; at rest the accelerometer reads ``gravity_mps2`` upwards.
    """
    axes = rotation_matrix(pose.rotation).T.tolist()  # forward, right and up of the sensor, in the world
    felt = acceleration_mps2._replace(z=acceleration_mps2.z + gravity_mps2)
    errors = gaussian(spec.seed, number, (*spec.accelerometer_deviation, *spec.gyroscope_deviation))
    return ImuMeasurement(
        Vector3D(*(_along(felt, axis) + error for axis, error in zip(axes, errors[:3], strict=True))),
        Vector3D(
            *(
                _along(angular_velocity_radps, axis) + bias + error
                for axis, bias, error in zip(axes, spec.gyroscope_bias, errors[3:], strict=True)
            )
        ),
        compass_rad(axes[0][0], axes[0][1]),
    )


def _along(vector: Vector3D, axis: list[float]) -> float:
    """Return the part of a vector along an axis of length 1, both in the world."""
    return vector.x * axis[0] + vector.y * axis[1] + vector.z * axis[2]
