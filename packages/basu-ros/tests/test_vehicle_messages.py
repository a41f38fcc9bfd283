"""Messages of a vehicle and its tree of frames."""

import math

import numpy as np
import pytest

from basu.errors import UserError
from basu_ros import vehicle_messages as of_vehicle
from basu_ros.moment import Actor, Control, Light, Moment, Motion, Vehicle
from basu_ros.topics import first_messages, moment_messages, vehicle_topics
from linden_ros2 import frames
from linden_ros2.mount import Mount
from linden_ros2.types import Generation, types_of

TYPES = types_of(Generation.ROS_2)
SOUTHWARD = Motion(10.0, 20.0, 1.0, 0.0, 0.0, math.pi / 2, 0.0, 5.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5)
"""Drives towards +y of CARLA, turns to the right."""


def moment(**more: object) -> Moment:
    return Moment(2.05, 41, SOUTHWARD, Control(throttle=0.25, steer=0.125), **more)  # type: ignore[arg-type]


def test_odometry_has_the_velocity_in_the_vehicle_s_axes() -> None:
    message = of_vehicle.odometry(TYPES, Vehicle("hero"), moment(), "hero")
    at, twist = message.pose.pose.position, message.twist.twist
    assert (at.x, at.y, at.z) == (10.0, -20.0, 1.0)
    assert (twist.linear.x, twist.linear.y, twist.linear.z) == pytest.approx((5.0, 0.0, 0.0))
    assert (twist.angular.x, twist.angular.y, twist.angular.z) == pytest.approx((0.0, 0.0, -0.5))
    assert (message.header.frame_id, message.child_frame_id) == ("map", "hero")
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 50_000_000)


def test_uphill_the_velocity_stays_along_the_vehicle() -> None:
    """The ros-bridge turns the velocity the wrong way round on slopes; here it is along x whatever the attitude."""
    pitch, yaw = 0.2, 1.0
    ahead = (math.cos(pitch) * math.cos(yaw), math.cos(pitch) * math.sin(yaw), math.sin(pitch))
    climbing = Motion(0, 0, 0, 0.0, pitch, yaw, *(6.0 * part for part in ahead), *([0.0] * 6))
    linear = of_vehicle.twist(TYPES, climbing).linear
    assert (linear.x, linear.y, linear.z) == pytest.approx((6.0, 0.0, 0.0), abs=1e-12)


def test_the_rear_axle_moves_sideways_less_than_the_middle() -> None:
    """Turning left about a point left of the rear axle: the middle, 1.4 m ahead, slips by yaw rate times 1.4 m."""
    turning = Motion(0, 0, 0, 0, 0, 0, 5.0, -0.7, 0.0, 0, 0, 0, 0.0, 0.0, -0.5)
    at_axle = of_vehicle.twist(TYPES, turning, 1.4).linear
    assert (at_axle.x, at_axle.y) == pytest.approx((5.0, 0.0))


def test_the_tree_leads_from_the_map_to_each_sensor() -> None:
    mounts = [Mount("CAM", "sensor.camera.rgb", 1.0, 0.5, 2.0), Mount("LIDAR", "sensor.lidar.ray_cast", 0.0, 0.0, 2.4)]
    vehicle = Vehicle("hero", mounts, rear_axle_m=1.4)
    tree = [*of_vehicle.still_tree(vehicle), *of_vehicle.moving_tree(vehicle, SOUTHWARD)]
    parents = {child: parent for parent, child, _ in tree}
    assert parents == {
        "odom": "map", "base_link": "odom", "hero": "base_link", "hero/CAM": "hero", "hero/LIDAR": "hero",
    }  # fmt: skip
    poses = {child: pose for _, child, pose in tree}
    origin = frames.rotated(poses["base_link"].attitude, poses["hero"].position_m)
    there = np.add(poses["base_link"].position_m, origin)
    assert there == pytest.approx(np.array([10.0, -20.0, 1.0]))  # the vehicle's origin, by way of its rear axle
    assert poses["hero/CAM"].position_m == (1.0, -0.5, 2.0)
    assert frames.rotated(poses["hero/CAM"].attitude, (0.0, 0.0, 1.0)) == pytest.approx((1.0, 0.0, 0.0))
    assert poses["hero/LIDAR"].attitude == pytest.approx(frames.IDENTITY)


def test_a_status_has_carla_s_control() -> None:
    message = of_vehicle.status(TYPES, moment())
    assert message.velocity == pytest.approx(5.0)
    assert (message.control.throttle, message.control.steer) == (0.25, 0.125)
    assert (message.acceleration.linear.x, message.acceleration.linear.y) == (0.0, -1.0)


def test_other_actors_are_classified_boxes() -> None:
    car = Actor(7, "vehicle.audi.tt", 1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 2.1, 0.9)
    walker = Actor(8, "walker.pedestrian.0001", 1.0, 2.0, 3.0, 0.0, 0.0, 1.0, 0.2, 0.2)
    message = of_vehicle.objects(TYPES, 1.0, (car, walker))
    first, second = message.objects
    assert (first.id, first.classification, second.classification) == (7, 6, 4)
    assert first.shape.dimensions.tolist() == pytest.approx([4.2, 1.8, 0.0])
    assert (first.pose.position.y, first.twist.linear.y) == (-2.0, -5.0)


@pytest.mark.parametrize(
    ("type_id", "kind"),
    [
        ("vehicle.diamondback.century", 5),
        ("vehicle.kawasaki.ninja", 8),
        ("vehicle.carlamotors.firetruck", 7),
        ("vehicle.easymile.ez10", 6),
        ("static.prop.box01", 10),
        ("traffic.stop", 0),
    ],
)
def test_classes_follow_from_blueprints(type_id: str, kind: int) -> None:
    assert of_vehicle.classification(type_id) == kind


def test_every_message_of_a_moment_is_of_its_topic_s_type_and_can_be_written() -> None:
    vehicle = Vehicle("hero", [Mount("GNSS", "sensor.other.gnss")])
    known = {topic.name: topic.type for topic in vehicle_topics(vehicle)}
    messages = [*first_messages(TYPES, vehicle, 0.0), *moment_messages(TYPES, vehicle, moment(lights=[Light(3, 2)]))]
    assert {topic.name for topic, _ in messages} == known.keys() - {"/carla/hero/GNSS"}
    for topic, content in messages:
        assert (topic.type, content.__msgtype__) == (known[topic.name], known[topic.name])
        assert len(TYPES.data(content)) > 4


def test_a_light_has_its_colour() -> None:
    message = of_vehicle.lights(TYPES, (Light(1, 0), Light(2, 2), Light(3, 4)))
    assert [(each.id, each.state) for each in message.traffic_lights] == [(1, 0), (2, 2), (3, 4)]


@pytest.mark.parametrize("name", ["FRONT-LEFT", "1st", "a b", ""])
def test_an_id_that_ros_cannot_name_is_a_sentence(name: str) -> None:
    with pytest.raises(UserError, match="cannot be part of a ROS topic's name"):
        vehicle_topics(Vehicle("hero", [Mount(name, "sensor.other.gnss")]))
