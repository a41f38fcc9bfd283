"""Attributes of a sensor as numbers, and the times at which it measures.

``sensor_tick`` acts as Unreal's tick interval does: the first frame is due, and from there on the first frame in every
interval. Where frames do not fall on due times, the overrun is credited to the next interval (as in
TickTaskManager.cpp), so the mean rate is right. A frame has at most one measurement. Intervals missed in a long frame
are not made up for.
"""

import math
from typing import NamedTuple

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import GeoLocation, Vector3D


class GnssSpec(NamedTuple):
    """Errors of a GNSS receiver: degrees, degrees, m."""

    bias: GeoLocation = GeoLocation()
    deviation: GeoLocation = GeoLocation()
    seed: int = 0


class ImuSpec(NamedTuple):
    """Errors of an inertial unit in its own frame: m/s² and rad/s."""

    accelerometer_deviation: Vector3D = Vector3D()
    gyroscope_deviation: Vector3D = Vector3D()
    gyroscope_bias: Vector3D = Vector3D()
    seed: int = 0


def gnss_spec(description: ActorDescription) -> GnssSpec:
    """Read ``noise_lat_bias``, ``noise_lat_stddev`` and the like of a complete description."""

    def read(kind: str) -> GeoLocation:
        return GeoLocation(*(description.number(f"noise_{axis}_{kind}") for axis in ("lat", "lon", "alt")))

    return GnssSpec(read("bias"), read("stddev"), _seed(description))


def imu_spec(description: ActorDescription) -> ImuSpec:
    """Read ``noise_accel_stddev_x`` and the like of a complete description."""

    def read(kind: str) -> Vector3D:
        return Vector3D(*(description.number(f"noise_{kind}_{axis}") for axis in "xyz"))

    return ImuSpec(read("accel_stddev"), read("gyro_stddev"), read("gyro_bias"), _seed(description))


def interval_s(description: ActorDescription) -> float:
    """Read ``sensor_tick``: seconds between two measurements, 0 for one every frame; 0 too where a sensor has none."""
    return description.number("sensor_tick")


def _seed(description: ActorDescription) -> int:
    return int(description.attribute("noise_seed", "0"))


ROUNDING_S = 1e-6
"""A frame that should fall on a due time counts as on it, whatever the last bits of the sum of steps are."""


class Schedule(NamedTuple):
    """Seconds of simulated time; ``due_s`` is when the next measurement is wanted, ``made`` how many were made."""

    interval_s: float = 0.0
    due_s: float = 0.0
    made: int = 0


def advance(schedule: Schedule, now_s: float) -> tuple[bool, Schedule]:
    """Return whether the frame at ``now_s`` is one of the sensor's, and its schedule after it."""
    interval_s, due_s, made = schedule
    if not made:
        due_s = now_s
    late_s = now_s - due_s + ROUNDING_S
    if late_s < 0.0:
        return False, schedule
    missed = math.floor(late_s / interval_s) if interval_s > 0.0 else 0
    return True, Schedule(interval_s, due_s + (missed + 1) * interval_s, made + 1)
