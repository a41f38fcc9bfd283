"""The topics of a simulated vehicle, as CARLA's ros-bridge has them, and the messages of each moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import UserError
from basu_ros import vehicle_messages as of_vehicle
from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.frames import Pose
from linden_ros2.sensor_messages import sensor_messages, sensor_types
from linden_ros2.topic import CLOCK, NAME, TF, Message, Topic

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_ros.moment import Moment, Vehicle
    from linden_ros2.types import Types


TF_STATIC = Topic("/tf_static", "tf2_msgs/msg/TFMessage", is_latched=True, depth=1)
STATUS = Topic("/carla/status", "carla_msgs/msg/CarlaStatus")
LIGHTS = Topic("/carla/traffic_lights/status", "carla_msgs/msg/CarlaTrafficLightStatusList")


def odometry_of(role: str) -> Topic:
    """Return the topic of a vehicle's odometry."""
    return Topic(f"/carla/{role}/odometry", "nav_msgs/msg/Odometry")


def status_of(role: str) -> Topic:
    """Return the topic of a vehicle's status: speed, acceleration, applied control."""
    return Topic(f"/carla/{role}/vehicle_status", "carla_msgs/msg/CarlaEgoVehicleStatus")


def objects_of(role: str) -> Topic:
    """Return the topic of the other actors around a vehicle."""
    return Topic(f"/carla/{role}/objects", "derived_object_msgs/msg/ObjectArray")


def info_of(role: str) -> Topic:
    """Return the topic of a vehicle's constant data: wheels, engine, mass."""
    return Topic(f"/carla/{role}/vehicle_info", "carla_msgs/msg/CarlaEgoVehicleInfo", is_latched=True, depth=1)


def path_of(role: str) -> Topic:
    """Return the topic of the planned route, as CARLA's waypoint publisher has it."""
    return Topic(f"/carla/{role}/waypoints", "nav_msgs/msg/Path", is_latched=True, depth=1)


def path_message(types: Types, role: str, way: list[tuple[float, float, float, float]]) -> Message:
    """Return a route for its topic; ``way`` gives x, y, z in m and yaw in rad of each point, in CARLA's axes."""
    header = basic.header(types, 0.0, of_vehicle.MAP)
    poses = [
        types.message("geometry_msgs/msg/PoseStamped", header=header, pose=basic.pose_message(types, pose))
        for pose in (Pose(frames.vector(x, y, z), frames.attitude(0.0, 0.0, yaw)) for x, y, z, yaw in way)
    ]
    return Message(path_of(role), types.message("nav_msgs/msg/Path", header=header, poses=poses))


def vehicle_topics(vehicle: Vehicle) -> list[Topic]:
    """Return all topics that a vehicle is published on.

    Raises:
        UserError: its role or a sensor's id cannot be part of a topic's name.
    """
    for name in (vehicle.role, *(mount.id for mount in vehicle.mounts)):
        if NAME.fullmatch(name) is None:
            raise UserError(
                f"'{name}' cannot be part of a ROS topic's name; use letters, digits and _, and begin with a letter"
            )
    role = vehicle.role
    own = [odometry_of(role), status_of(role), objects_of(role)]
    sensors = [
        Topic(f"/carla/{role}/{mount.id}{suffix}", kind)
        for mount in vehicle.mounts
        for suffix, kind in sensor_types(mount.type_id)
    ]
    return [CLOCK, TF, TF_STATIC, STATUS, LIGHTS, *own, *sensors]


def first_messages(types: Types, vehicle: Vehicle, t_s: float) -> list[Message]:
    """Return what is published once: the transforms that never change."""
    return [Message(TF_STATIC, basic.transforms(types, t_s, of_vehicle.still_tree(vehicle)))]


def moment_messages(types: Types, vehicle: Vehicle, moment: Moment) -> Iterator[Message]:
    """Yield the messages of one frame: the clock first, then the vehicle, then each sensor that measured in it."""
    role, t_s = vehicle.role, moment.t_s
    yield Message(CLOCK, basic.clock(types, t_s))
    yield Message(TF, basic.transforms(types, t_s, of_vehicle.moving_tree(vehicle, moment.motion)))
    yield Message(STATUS, of_vehicle.simulator_status(types, moment, vehicle.step_s))
    child = of_vehicle.BASE if vehicle.rear_axle_m else role
    yield Message(odometry_of(role), of_vehicle.odometry(types, vehicle, moment, child))
    yield Message(status_of(role), of_vehicle.status(types, moment))
    yield Message(objects_of(role), of_vehicle.objects(types, t_s, tuple(moment.others)))
    if moment.lights:
        yield Message(LIGHTS, of_vehicle.lights(types, tuple(moment.lights)))
    for mount, data in moment.measured:
        header = basic.header(types, t_s, of_vehicle.sensor_frame(vehicle, mount))
        for (suffix, kind), (_, content) in zip(
            sensor_types(mount.type_id), sensor_messages(types, header, mount, data), strict=True
        ):
            yield Message(Topic(f"/carla/{role}/{mount.id}{suffix}", kind), content)
