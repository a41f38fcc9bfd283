"""A sensor's attributes, which are text, as the numbers its measurements need."""

from typing import NamedTuple

from linden.values.actors import ActorDescription
from linden.values.space import GeoLocation, Vector3D


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
        return GeoLocation(*(_number(description, f"noise_{axis}_{kind}") for axis in ("lat", "lon", "alt")))

    return GnssSpec(read("bias"), read("stddev"), _seed(description))


def imu_spec(description: ActorDescription) -> ImuSpec:
    """Read ``noise_accel_stddev_x`` and the like of a complete description."""

    def read(kind: str) -> Vector3D:
        return Vector3D(*(_number(description, f"noise_{kind}_{axis}") for axis in "xyz"))

    return ImuSpec(read("accel_stddev"), read("gyro_stddev"), read("gyro_bias"), _seed(description))


def interval_s(description: ActorDescription) -> float:
    """Read ``sensor_tick``: seconds between two measurements, 0 for one every frame; 0 too where a sensor has none."""
    return _number(description, "sensor_tick")


def _number(description: ActorDescription, name: str) -> float:
    return float(description.attribute(name, "0"))


def _seed(description: ActorDescription) -> int:
    return int(description.attribute("noise_seed", "0"))
