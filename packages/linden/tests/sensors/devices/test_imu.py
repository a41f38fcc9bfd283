"""The inertial unit against motions whose accelerations are known in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.geometry import rotation_matrix
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.sensors.devices.attributes import ImuSpec
from linden.sensors.devices.imu import Trace, acceleration, compass_rad, extend, measure

AT_REST = Vector3D()


def followed(path, times_s: list[float]) -> Vector3D:
    """Return the acceleration seen at the last of the times by a sensor that goes along ``path``."""
    trace = Trace()
    for now_s in times_s[:-1]:
        trace = extend(trace, Vector3D(*path(now_s)), now_s)
    return acceleration(trace, Vector3D(*path(times_s[-1])), times_s[-1])


def test_at_rest_on_the_flat_gravity_points_up() -> None:
    found = measure(ImuSpec(), 0, Transform(), AT_REST, AT_REST, 9.81)
    assert found.accelerometer == (0.0, 0.0, 9.81)
    assert found.gyroscope == (0.0, 0.0, 0.0)


def test_nose_up_gravity_is_felt_forwards_and_right_side_down_to_the_left() -> None:
    nose_up = measure(ImuSpec(), 0, Transform(rotation=Rotation(pitch=30.0)), AT_REST, AT_REST, 10.0)
    assert nose_up.accelerometer == pytest.approx((5.0, 0.0, 10.0 * math.cos(math.radians(30.0))))
    right_down = measure(ImuSpec(), 0, Transform(rotation=Rotation(roll=30.0)), AT_REST, AT_REST, 10.0)
    assert right_down.accelerometer == pytest.approx((0.0, -5.0, 10.0 * math.cos(math.radians(30.0))))


@given(st.floats(-89, 89), st.floats(-180, 180), st.floats(-180, 180))
def test_turning_the_sensor_turns_what_it_reads_and_changes_no_length(pitch: float, yaw: float, roll: float) -> None:
    pose = Transform(rotation=Rotation(pitch, yaw, roll))
    found = measure(ImuSpec(), 0, pose, Vector3D(1.0, -2.0, 0.5), Vector3D(0.1, 0.2, 0.3), 9.81)
    back = rotation_matrix(pose.rotation) @ np.array([found.accelerometer, found.gyroscope]).T
    assert back[:, 0] == pytest.approx([1.0, -2.0, 10.31])
    assert back[:, 1] == pytest.approx([0.1, 0.2, 0.3])


@pytest.mark.parametrize("times_s", [[0.0, 0.1, 0.2], [0.0, 0.05, 0.2], [3.0, 3.2, 3.21]])
def test_a_parabola_is_read_exactly_whatever_the_steps(times_s: list[float]) -> None:
    def path(t: float) -> tuple[float, float, float]:
        return 100.0 + 3.0 * t + 0.5 * 1.5 * t * t, -2.0 * t * t, 7.0

    assert followed(path, times_s) == pytest.approx((1.5, -4.0, 0.0), abs=1e-9)


def test_a_circle_is_read_as_speed_squared_over_radius_towards_the_middle() -> None:
    def path(t: float) -> tuple[float, float, float]:
        return 20.0 * math.cos(0.5 * t), 20.0 * math.sin(0.5 * t), 0.0

    found = followed(path, [0.95, 1.0, 1.05])
    assert found == pytest.approx((-5.0 * math.cos(0.5), -5.0 * math.sin(0.5), 0.0), abs=0.001)


def test_until_there_are_three_places_nothing_accelerates() -> None:
    assert acceleration(Trace(), Vector3D(1e6, 0.0, 0.0), 0.0) == AT_REST
    assert acceleration(extend(Trace(), Vector3D(1e6, 0.0, 0.0), 0.0), Vector3D(), 0.1) == AT_REST


def test_time_that_does_not_pass_accelerates_no_body() -> None:
    trace = extend(extend(Trace(), Vector3D(), 1.0), Vector3D(1.0, 0.0, 0.0), 1.0)
    assert acceleration(trace, Vector3D(2.0, 0.0, 0.0), 1.1) == AT_REST


@pytest.mark.parametrize(
    ("forward", "heading"),
    [((0.0, -1.0), 0.0), ((1.0, 0.0), math.pi / 2), ((0.0, 1.0), math.pi), ((-1.0, 0.0), 3 * math.pi / 2)],
)
def test_the_compass_grows_clockwise_from_north(forward: tuple[float, float], heading: float) -> None:
    assert compass_rad(*forward) == pytest.approx(heading)


@given(st.floats(-math.pi, math.pi))
def test_the_compass_stays_below_a_full_turn(angle: float) -> None:
    assert 0.0 <= compass_rad(math.cos(angle), math.sin(angle)) < math.tau


def test_a_hair_west_of_north_is_still_below_a_full_turn() -> None:
    assert compass_rad(-1e-300, -1.0) < math.tau


def test_errors_have_the_bias_and_deviations_asked_for() -> None:
    spec = ImuSpec(Vector3D(0.1, 0.2, 0.3), Vector3D(0.01, 0.02, 0.03), Vector3D(0.5, -0.5, 0.25), seed=2)
    found = [measure(spec, number, Transform(), AT_REST, AT_REST, 9.81) for number in range(4000)]
    accelerometer = np.array([reading.accelerometer for reading in found]) - [0.0, 0.0, 9.81]
    gyroscope = np.array([reading.gyroscope for reading in found]) - spec.gyroscope_bias
    errors = np.column_stack(
        [accelerometer / spec.accelerometer_deviation, gyroscope / spec.gyroscope_deviation],
    )
    assert np.abs(errors.mean(axis=0)).max() < 4.0 / np.sqrt(4000)
    assert np.abs(errors.std(axis=0) - 1.0).max() < 4.0 / np.sqrt(2 * 4000)
    assert np.abs(np.corrcoef(errors.T) - np.eye(6)).max() < 4.0 / np.sqrt(4000)
