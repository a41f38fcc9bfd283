"""Autoware.AI's topics and messages, in both versions."""

import math
from types import SimpleNamespace as Fake

import numpy as np
import pytest

from basu_ros import autoware_ai as ai
from basu_ros.moment import Control, Measurement, Moment, Motion, Vehicle
from linden_ros2.mount import Mount
from linden_ros2.topic import CLOCK, TF
from linden_ros2.types import Generation, Types, types_of

NEW, OLD = types_of(Generation.ROS_1), ai.old_types()
TOP, SECOND = Mount("top", "sensor.lidar.ray_cast", 0.5, 0.0, 2.9), Mount("second", "sensor.lidar.ray_cast")
CAMERA = Mount("front", "sensor.camera.rgb")
VEHICLE = Vehicle("hero", [TOP, SECOND, CAMERA], rear_axle_m=1.4)
LEFT_TURN = Motion(10.0, 0.0, 0.0, 0, 0, 0, 5.0, -0.7, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, -0.5)


def moment(**more: object) -> Moment:
    return Moment(1.0, 20, LEFT_TURN, **{"control": Control(), **more})  # type: ignore[arg-type]


def command(types: Types, *, speed: float = 0.0, rate: float = 0.0, back: bool = False, **control: float) -> object:
    twist = types.message("geometry_msgs/msg/Twist")
    twist.linear.x, twist.angular.z = speed, rate
    stamped = types.message("geometry_msgs/msg/TwistStamped", twist=twist)
    gear: dict[str, object] = {"gear": ai.OLD_REVERSE if back else ai.OLD_DRIVE}
    if types is NEW:
        gear = {"gear_cmd": types.message("autoware_msgs/msg/Gear", gear=ai.REVERSE if back else ai.DRIVE)}
    ordered = types.message("autoware_msgs/msg/ControlCommand", **control)
    return types.message(ai.COMMAND.type, twist_cmd=stamped, ctrl_cmd=ordered, **gear)


def test_pose_and_velocity_are_those_of_the_rear_axle() -> None:
    found = {topic.name: each for topic, each in ai.localisation_messages(NEW, VEHICLE, moment())}
    assert found["/current_pose"].pose.position.x == pytest.approx(8.6)
    assert found["/current_pose"].header.frame_id == "map"
    moving = found["/current_velocity"].twist
    assert (moving.linear.x, moving.angular.z) == (pytest.approx(5.0), pytest.approx(0.5))
    [turn] = found[TF.name].transforms
    assert (turn.header.frame_id, turn.child_frame_id) == ("map", "base_link")


def test_the_lidar_hangs_on_base_link_by_autoware_s_names() -> None:
    [(_, tree)] = ai.still_messages(NEW, VEHICLE, 1.0)
    frames = {each.child_frame_id: each for each in tree.transforms}
    assert set(frames) == {"map", "velodyne", "camera"}
    assert frames["velodyne"].transform.translation.x == pytest.approx(1.9)
    assert frames["map"].header.frame_id == "world"


def test_the_first_of_two_lidars_is_points_raw() -> None:
    one, two = (Fake(raw_data=np.full((n, 4), n, dtype=np.float32).tobytes()) for n in (1, 2))
    measured = [Measurement(TOP, one), Measurement(SECOND, two)]
    found = {topic.name: each for topic, each in ai.sensing_messages(NEW, VEHICLE, moment(measured=measured))}
    assert set(found) == {"/points_raw", "/gnss_pose"}
    assert (found["/points_raw"].width, found["/points_raw"].header.frame_id) == (1, "velodyne")


@pytest.mark.parametrize("types", [NEW, OLD], ids=["1.14", "1.13"])
def test_the_status_has_km_per_h_and_the_gear_of_its_version(types: Types) -> None:
    status = ai.status_message(types, VEHICLE, moment(control=Control(reverse=True)), 0.25).content
    assert (status.speed, status.angle) == (pytest.approx(18.0), 0.25)
    assert (status.gearshift if types is OLD else status.current_gear.gear) == 2
    assert types.parsed(types.data(status), ai.STATUS.type).angle == 0.25


@pytest.mark.parametrize("types", [NEW, OLD], ids=["1.14", "1.13"])
def test_a_command_orders_by_its_twist(types: Types) -> None:
    given = types.parsed(types.data(command(types, speed=4.0, rate=0.2)), ai.COMMAND.type)
    assert ai.ordered(given) == ai.Ordered(4.0, 0.2, None, is_emergency=False)
    assert ai.ordered(command(types, speed=1.0, back=True)).speed_mps == -1.0
    both = command(types, speed=4.0, linear_velocity=3.0, steering_angle=0.3)
    assert ai.ordered(both).tyre_angle_rad is None


def test_an_empty_twist_leaves_the_order_to_ctrl_cmd() -> None:
    order = ai.ordered(command(NEW, linear_velocity=3.0, steering_angle=0.3))
    assert (order.speed_mps, order.tyre_angle_rad) == (3.0, 0.3)
    reset = ai.ordered(command(NEW, linear_velocity=-1.0))  # what twist_gate writes when it resets
    assert (reset.speed_mps, reset.tyre_angle_rad) == (0.0, None)


def test_definitions_tell_the_versions_apart() -> None:
    texts = [types.store.generate_msgdef(ai.COMMAND.type) for types in (NEW, OLD)]
    assert [ai.is_old(text) for text, _ in texts] == [False, True]
    assert texts[0][1] != texts[1][1]


def test_the_tyre_angle_drives_the_circle() -> None:
    assert ai.tyre_angle_rad(5.0, 0.5, 2.8) == pytest.approx(math.atan(0.28))
    assert ai.tyre_angle_rad(0.0, 0.5, 2.8) == 0.0


def test_the_mission_is_a_goal_and_the_order_to_drive() -> None:
    goal, engage = ai.mission(NEW, (10.0, 5.0, 0.0, math.pi / 2), 1.0)
    assert (goal.topic.name, goal.content.pose.position.x, goal.content.pose.position.y) == (
        "/move_base_simple/goal",
        10.0,
        -5.0,
    )
    assert (engage.topic.name, engage.content.data) == ("/state_cmd", "engage")


def test_a_localisation_starts_where_the_rear_axle_is() -> None:
    """A start that is wrong by the distance to the axle can make NDT matching lose its way at once."""
    now = moment()
    start = ai.initial_pose(NEW, VEHICLE, now)
    true = dict(ai.localisation_messages(NEW, VEHICLE, now))[ai.CURRENT_POSE]
    assert VEHICLE.rear_axle_m > 1.0
    assert (start.topic.name, start.topic.is_latched) == ("/initialpose", True)
    assert start.content.pose.pose == true.pose


def test_every_topic_that_is_written_was_announced() -> None:
    known = {topic.name for topic in ai.sensing_topics(VEHICLE)}
    picture = Fake(raw_data=bytes(16), height=2, width=2, fov=90.0)
    written = {
        topic.name for topic, _ in ai.sensing_messages(NEW, VEHICLE, moment(measured=[Measurement(CAMERA, picture)]))
    }
    assert {"/image_raw", "/camera_info"} < written
    assert written | {CLOCK.name, TF.name} <= known
