"""Messages of sensors, field by field as the official ros-bridge has them (shared notes on its run of July 2022)."""

import math
from types import SimpleNamespace as Fake
from typing import Any

import numpy as np
import pytest

from linden_ros2.basic_messages import header
from linden_ros2.mount import Mount
from linden_ros2.sensor_messages import CITYSCAPES, SEMANTIC_ROW, sensor_messages, sensor_types
from linden_ros2.types import Generation, types_of

TYPES = types_of(Generation.ROS_2)
HEADER = header(TYPES, 1.25, "hero/S")


def made(type_id: str, **fields: Any) -> list[tuple[str, Any]]:
    return sensor_messages(TYPES, HEADER, Mount("S", type_id), Fake(**fields))


def columns(message: Any) -> list[tuple[str, int, int, int]]:
    return [(each.name, each.offset, each.datatype, each.count) for each in message.fields]


def xyz(x: float, y: float, z: float) -> Fake:
    return Fake(x=x, y=y, z=z)


def test_a_lidar_has_sixteen_bytes_a_point_with_y_to_the_left() -> None:
    points = np.array([[1, 2, 3, 0.5], [4, -5, 6, 0.25]], dtype=np.float32)
    [(suffix, message)] = made("sensor.lidar.ray_cast", raw_data=points.tobytes())
    assert suffix == ""
    assert columns(message) == [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("intensity", 12, 7, 1)]
    assert (message.height, message.width, message.point_step, message.row_step) == (1, 2, 16, 32)
    assert (message.is_dense, message.is_bigendian) == (False, False)
    expected = [[1, -2, 3, 0.5], [4, 5, 6, 0.25]]
    assert message.data.view(np.float32).reshape(-1, 4).tolist() == expected
    assert (message.header.stamp.sec, message.header.stamp.nanosec, message.header.frame_id) == (
        1,
        250_000_000,
        "hero/S",
    )


def test_an_empty_lidar_is_an_empty_cloud() -> None:
    [(_, message)] = made("sensor.lidar.ray_cast", raw_data=b"")
    assert (message.width, len(message.data)) == (0, 0)


def test_a_semantic_lidar_has_twenty_four_bytes_a_point() -> None:
    rows = np.array([(1, 2, 3, 0.5, 77, 14)], dtype=SEMANTIC_ROW)
    [(_, message)] = made("sensor.lidar.ray_cast_semantic", raw_data=rows.tobytes())
    names = ["x", "y", "z", "CosAngle", "ObjIdx", "ObjTag"]
    assert [(name, offset) for name, offset, *_ in columns(message)] == list(zip(names, range(0, 24, 4), strict=True))
    assert message.data.view(SEMANTIC_ROW).tolist() == [(1.0, -2.0, 3.0, 0.5, 77, 14)]


def test_a_radar_has_thirty_two_bytes_a_point_with_a_gap() -> None:
    detection = np.array([[-3.0, math.radians(30.0), math.radians(10.0), 20.0]], dtype=np.float32)
    [(_, message)] = made("sensor.other.radar", raw_data=detection.tobytes())
    offsets = {name: offset for name, offset, *_ in columns(message)}
    assert offsets == {
        "x": 0, "y": 4, "z": 8, "Range": 12, "Velocity": 16, "AzimuthAngle": 20, "ElevationAngle": 28,
    }  # fmt: skip
    assert message.point_step == 32
    x, y, z, reach, velocity, azimuth, gap, elevation = message.data.view(np.float32).tolist()
    assert math.hypot(x, y, z) == pytest.approx(20.0)
    assert (y, z) == pytest.approx((-20.0 * 0.5 * math.cos(math.radians(10.0)), 20.0 * math.sin(math.radians(10.0))))
    assert (reach, velocity, gap) == (20.0, -3.0, 0.0)
    assert (azimuth, elevation) == pytest.approx((math.radians(30.0), math.radians(10.0)))


def test_an_imu_turns_its_axial_and_its_polar_vector() -> None:
    turn = Fake(rotation=Fake(roll=0.0, pitch=0.0, yaw=90.0))
    [(_, message)] = made(
        "sensor.other.imu", gyroscope=xyz(0.1, 0.2, 0.3), accelerometer=xyz(1.0, 2.0, 9.8), transform=turn
    )
    spin, force, attitude = message.angular_velocity, message.linear_acceleration, message.orientation
    assert (spin.x, spin.y, spin.z) == (-0.1, 0.2, -0.3)
    assert (force.x, force.y, force.z) == (1.0, -2.0, 9.8)
    assert (attitude.z, attitude.w) == pytest.approx((-math.sqrt(0.5), math.sqrt(0.5)))


def test_a_gnss_keeps_its_numbers() -> None:
    [(_, message)] = made("sensor.other.gnss", latitude=48.5, longitude=9.25, altitude=400.0)
    assert (message.latitude, message.longitude, message.altitude) == (48.5, 9.25, 400.0)


def picture(pixels: Any, fov: float = 90.0) -> dict[str, Any]:
    raw = np.array(pixels, dtype=np.uint8)
    return {"raw_data": raw.tobytes(), "height": raw.shape[0], "width": raw.shape[1], "fov": fov}


def test_a_camera_has_its_bytes_and_its_matrix() -> None:
    [(image_suffix, image), (info_suffix, info)] = made("sensor.camera.rgb", **picture([[[1, 2, 3, 255]] * 4] * 2))
    assert (image_suffix, info_suffix) == ("/image", "/camera_info")
    assert (image.encoding, image.height, image.width, image.step) == ("bgra8", 2, 4, 16)
    assert image.data.tolist() == [1, 2, 3, 255] * 8
    assert info.k.tolist() == pytest.approx([2.0, 0.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 1.0])
    assert info.p.tolist() == pytest.approx([2.0, 0.0, 2.0, 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    assert (info.d.tolist(), info.r.tolist()) == ([0.0] * 5, [1, 0, 0, 0, 1, 0, 0, 0, 1])
    assert (info.distortion_model, info.width, info.height) == ("plumb_bob", 4, 2)


def test_a_depth_picture_is_metres() -> None:
    [(_, image), _] = made("sensor.camera.depth", **picture([[[255, 255, 255, 0], [1, 2, 3, 255]]]))
    assert (image.encoding, image.step) == ("32FC1", 8)
    expected = [1000.0, 1000.0 * (3 + 2 * 256 + 1 * 65536) / (256**3 - 1)]
    assert image.data.view(np.float32) == pytest.approx(expected)


def test_a_semantic_picture_has_the_colours_of_cityscapes() -> None:
    [(_, image), _] = made("sensor.camera.semantic_segmentation", **picture([[[0, 0, 14, 255], [0, 0, 200, 255]]]))
    assert image.data.reshape(-1, 4).tolist() == [[*CITYSCAPES[14][::-1].tolist(), 255], [0, 0, 0, 255]]


def test_events_carry_ids_and_kinds() -> None:
    [(_, hit)] = made("sensor.other.collision", other_actor=Fake(id=7), normal_impulse=xyz(1.0, 2.0, 3.0))
    assert (hit.other_actor_id, hit.normal_impulse.y) == (7, -2.0)
    [(_, crossed)] = made("sensor.other.lane_invasion", crossed_lane_markings=[Fake(type=1), Fake(type=2)])
    assert crossed.crossed_lane_markings.tolist() == [1, 2]


@pytest.mark.parametrize("type_id", ["sensor.lidar.ray_cast", "sensor.camera.rgb", "sensor.other.imu"])
def test_the_topics_of_a_sensor_are_known_before_it_measures(type_id: str) -> None:
    assert sensor_types(type_id)
    assert sensor_types("sensor.other.obstacle") == []


def test_ros_1_has_capital_matrices() -> None:
    types = types_of(Generation.ROS_1)
    made_1 = sensor_messages(
        types, header(types, 0.0, "hero/S"), Mount("S", "sensor.camera.rgb"), Fake(**picture([[[1, 2, 3, 4]] * 2]))
    )
    assert made_1[1][1].K.tolist()[0] == pytest.approx(1.0)
    assert len(types.data(made_1[1][1])) > 0
