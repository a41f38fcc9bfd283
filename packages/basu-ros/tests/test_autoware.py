"""Autoware's topics and messages."""

import math
from types import SimpleNamespace as Fake

import numpy as np
import pytest

from basu_ros import autoware
from basu_ros.moment import Control, Measurement, Moment, Motion, Vehicle
from linden_ros2.mount import Mount
from linden_ros2.types import Generation, types_of

TYPES = types_of(Generation.ROS_2)
TOP, SECOND = Mount("top", "sensor.lidar.ray_cast", 0.0, 0.0, 2.9), Mount("second", "sensor.lidar.ray_cast")
CAMERA = Mount("front", "sensor.camera.rgb")
VEHICLE = Vehicle("hero", [TOP, SECOND, CAMERA], rear_axle_m=1.4)
LEFT_TURN = Motion(10.0, 0.0, 0.0, 0, 0, 0, 5.0, -0.7, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, -0.5)


def messages(**more: object) -> dict[str, object]:
    moment = Moment(1.0, 20, LEFT_TURN, Control(), **more)  # type: ignore[arg-type]
    return {topic.name: each for topic, each in autoware.autoware_messages(TYPES, VEHICLE, moment, 0.25)}


def test_velocities_are_those_of_the_rear_axle() -> None:
    found = messages()
    report = found["/vehicle/status/velocity_status"]
    assert report.longitudinal_velocity == pytest.approx(5.0)  # type: ignore[attr-defined]
    assert report.lateral_velocity == pytest.approx(0.0, abs=1e-12)  # type: ignore[attr-defined]
    assert report.heading_rate == pytest.approx(0.5)  # type: ignore[attr-defined]
    state = found["/localization/kinematic_state"]
    assert state.pose.pose.position.x == pytest.approx(8.6)  # type: ignore[attr-defined]
    assert state.child_frame_id == "base_link"  # type: ignore[attr-defined]
    assert found["/vehicle/status/steering_status"].steering_tire_angle == 0.25  # type: ignore[attr-defined]
    assert found["/localization/acceleration"].accel.accel.linear.x == 0.5  # type: ignore[attr-defined]


def test_gear_and_mode_have_autoware_s_values() -> None:
    found = messages()
    assert found["/vehicle/status/gear_status"].report == 2  # type: ignore[attr-defined]
    assert found["/vehicle/status/control_mode"].mode == 1  # type: ignore[attr-defined]
    backwards = Moment(1.0, 20, LEFT_TURN, Control(reverse=True))
    gears = [
        each for topic, each in autoware.autoware_messages(TYPES, VEHICLE, backwards, 0.0) if topic == autoware.GEAR
    ]
    assert [each.report for each in gears] == [20]


def test_the_first_of_two_lidars_is_the_top_one() -> None:
    one, two = (Fake(raw_data=np.full((n, 4), n, dtype=np.float32).tobytes()) for n in (1, 2))
    found = messages(measured=[Measurement(TOP, one), Measurement(SECOND, two)])
    cloud = found["/sensing/lidar/top/pointcloud_before_sync"]
    assert (cloud.width, cloud.header.frame_id) == (1, "hero/top")  # type: ignore[attr-defined]


def test_every_topic_that_is_written_was_announced() -> None:
    known = {topic.name: topic.type for topic in autoware.all_topics(VEHICLE)}
    picture = Fake(raw_data=bytes(16), height=2, width=2, fov=90.0)
    moment = Moment(1.0, 20, LEFT_TURN, Control(), measured=[Measurement(CAMERA, picture)])
    way = [(0.0, 0.0, 0.0, 0.0), (10.0, 5.0, 0.0, math.pi / 2)]
    for topic, content in [*autoware.autoware_messages(TYPES, VEHICLE, moment, 0.0), *autoware.mission(TYPES, way)]:
        assert known[topic.name] == topic.type == content.__msgtype__
        assert len(TYPES.data(content)) > 4
    assert "/sensing/camera/front/image_raw" in known


def test_the_goal_is_the_end_of_the_way() -> None:
    way = [(0.0, 0.0, 0.0, 0.0), (10.0, 5.0, 0.0, math.pi / 2)]
    goal = {topic.name: each for topic, each in autoware.mission(TYPES, way)}["/planning/mission_planning/goal"]
    assert (goal.pose.position.x, goal.pose.position.y) == (10.0, -5.0)
    assert (goal.pose.orientation.z, goal.header.frame_id) == (pytest.approx(-math.sqrt(0.5)), "map")
