"""Instruments over time: made from a description, observed frame by frame."""

import math

import pytest

from linden.blueprints.library import BlueprintLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import GeoLocation, Transform, Vector3D
from linden.sensors.devices.gnss import geolocation
from linden.sensors.devices.imu import ImuMeasurement
from linden.sensors.devices.instruments import Instrument, Moment, Reading, instrument, observe

LIBRARY = BlueprintLibrary.load()
ORIGIN_DEG = (39.99, -82.98)


def made(name: str, **attributes: str) -> Instrument:
    chosen = tuple(AttributeValue(key, AttributeType.STRING, value) for key, value in attributes.items())
    found = instrument(LIBRARY.validate(ActorDescription(0, f"sensor.other.{name}", chosen)))
    assert found is not None
    return found


def on_the_way(now_s: float) -> Moment:
    """A sensor that speeds up eastwards by 2 m/s²."""
    pose = Transform(Vector3D(now_s * now_s, 0.0, 1.0))
    return Moment(now_s, pose, Vector3D(0.0, 0.0, 0.25), ORIGIN_DEG, 9.81)


def readings(kept: Instrument, frames: range, *, wanted_from: int = 0) -> list[Reading | None]:
    found = []
    for frame in frames:
        reading, kept = observe(kept, on_the_way(0.05 * (frame + 1)), wanted=frame >= wanted_from)
        found.append(reading)
    return found


def test_attributes_arrive_as_numbers() -> None:
    spec = made("gnss", noise_seed="9", noise_lat_stddev="1e-5", noise_lon_bias="-2", noise_alt_stddev="0.5").spec
    assert spec == (GeoLocation(0.0, -2.0, 0.0), GeoLocation(1e-5, 0.0, 0.5), 9)
    unit = made("imu", noise_accel_stddev_y="0.1", noise_gyro_stddev_z="0.2", noise_gyro_bias_x="0.3")
    assert unit.spec == (Vector3D(0.0, 0.1, 0.0), Vector3D(0.0, 0.0, 0.2), Vector3D(0.3, 0.0, 0.0), 0)


@pytest.mark.parametrize("name", ["sensor.other.collision", "sensor.camera.rgb", "vehicle.easymile.ez10"])
def test_other_actors_are_no_instruments(name: str) -> None:
    assert instrument(LIBRARY.validate(ActorDescription(0, name))) is None


def test_a_receiver_reads_where_it_is_in_every_frame() -> None:
    found = readings(made("gnss"), range(3))
    assert found == [geolocation(Vector3D((0.05 * n) ** 2, 0.0, 1.0), *ORIGIN_DEG) for n in (1, 2, 3)]


def test_a_unit_reads_its_acceleration_from_the_third_frame_on() -> None:
    found = readings(made("imu"), range(4))
    assert all(isinstance(reading, ImuMeasurement) for reading in found)
    along = [reading.accelerometer.x for reading in found if isinstance(reading, ImuMeasurement)]
    assert along == pytest.approx([0.0, 0.0, 2.0, 2.0], abs=1e-9)
    last = found[-1]
    assert isinstance(last, ImuMeasurement)
    assert last.gyroscope == (0.0, 0.0, 0.25)
    assert last.compass == pytest.approx(math.pi / 2)


def test_with_a_tick_only_its_frames_are_read_and_the_acceleration_is_that_over_the_tick() -> None:
    found = readings(made("imu", sensor_tick="0.1"), range(7))
    assert [frame for frame, reading in enumerate(found) if reading is not None] == [0, 2, 4, 6]
    last = found[-1]
    assert isinstance(last, ImuMeasurement)
    assert last.accelerometer.x == pytest.approx(2.0)


@pytest.mark.parametrize("name", ["gnss", "imu"])
def test_a_later_listener_reads_the_same(name: str) -> None:
    noise = {"gnss": {"noise_lat_stddev": "0.1"}, "imu": {"noise_accel_stddev_x": "0.1"}}[name]
    always = readings(made(name, noise_seed="4", **noise), range(20))
    late = readings(made(name, noise_seed="4", **noise), range(20), wanted_from=12)
    assert late == [None] * 12 + always[12:]


@pytest.mark.parametrize("name", ["gnss", "imu"])
def test_two_runs_with_one_seed_are_alike_and_another_seed_is_not(name: str) -> None:
    noise = {"gnss": {"noise_alt_stddev": "0.1"}, "imu": {"noise_gyro_stddev_x": "0.1"}}[name]
    first, again, other = (readings(made(name, noise_seed=seed, **noise), range(5)) for seed in ("1", "1", "2"))
    assert first == again
    assert all(one != two for one, two in zip(first, other, strict=True))
