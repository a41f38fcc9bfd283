"""Topics and messages of Autoware Universe and Core: what its sensing and vehicle interfaces publish, and its commands.

Names and types follow ``autoware_carla_interface`` and Autoware's documentation of the vehicle interface. The frame
``base_link`` is the middle of the rear axle on the ground. Localisation is given. Pose, acceleration and the transform
of ``base_link`` come from the simulator, so a stack runs without its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu_ros import vehicle_messages as of_vehicle
from basu_ros.topics import TF_STATIC
from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.basic_messages import vector3
from linden_ros2.frames import Pose
from linden_ros2.sensor_messages import sensor_messages
from linden_ros2.topic import CLOCK, TF, Message, Topic

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_ros.moment import Moment, Vehicle
    from linden_ros2.mount import Mount
    from linden_ros2.types import Types

DRIVE, REVERSE = 2, 20  # autoware_vehicle_msgs/GearReport
AUTONOMOUS = 1  # autoware_vehicle_msgs/ControlModeReport
OFF = 1  # TurnIndicatorsReport and HazardLightsReport: DISABLE

VELOCITY = Topic("/vehicle/status/velocity_status", "autoware_vehicle_msgs/msg/VelocityReport")
STEERING = Topic("/vehicle/status/steering_status", "autoware_vehicle_msgs/msg/SteeringReport")
GEAR = Topic("/vehicle/status/gear_status", "autoware_vehicle_msgs/msg/GearReport")
MODE = Topic("/vehicle/status/control_mode", "autoware_vehicle_msgs/msg/ControlModeReport")
TURN = Topic("/vehicle/status/turn_indicators_status", "autoware_vehicle_msgs/msg/TurnIndicatorsReport")
HAZARD = Topic("/vehicle/status/hazard_lights_status", "autoware_vehicle_msgs/msg/HazardLightsReport")
KINEMATIC = Topic("/localization/kinematic_state", "nav_msgs/msg/Odometry")
ACCELERATION = Topic("/localization/acceleration", "geometry_msgs/msg/AccelWithCovarianceStamped")
INITIAL_POSE = Topic("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped", depth=1)
GOAL = Topic("/planning/mission_planning/goal", "geometry_msgs/msg/PoseStamped", is_latched=True, depth=1)
ENGAGE = Topic("/autoware/engage", "autoware_vehicle_msgs/msg/Engage", is_latched=True, depth=1)
CONTROL = Topic("/control/command/control_cmd", "autoware_control_msgs/msg/Control", depth=1)
GEAR_COMMAND = Topic("/control/command/gear_cmd", "autoware_vehicle_msgs/msg/GearCommand", is_latched=True, depth=1)
STATES = (VELOCITY, STEERING, GEAR, MODE, TURN, HAZARD, KINEMATIC, ACCELERATION)

LIDAR = Topic("/sensing/lidar/top/pointcloud_before_sync", "sensor_msgs/msg/PointCloud2", is_reliable=False, depth=5)
IMU = Topic("/sensing/imu/tamagawa/imu_raw", "sensor_msgs/msg/Imu")
GNSS = Topic("/sensing/gnss/ublox/nav_sat_fix", "sensor_msgs/msg/NavSatFix")
_SENSORS = {"sensor.lidar.ray_cast": LIDAR, "sensor.other.imu": IMU, "sensor.other.gnss": GNSS}


def sensor_topics(mount: Mount) -> list[Topic]:
    """Return the topics of a sensor in the order of its messages; none for what Autoware has no topic for."""
    if mount.is_camera:
        base = f"/sensing/camera/{mount.id}"
        image = Topic(f"{base}/image_raw", "sensor_msgs/msg/Image", is_reliable=False, depth=5)
        return [image, Topic(f"{base}/camera_info", "sensor_msgs/msg/CameraInfo", is_reliable=False, depth=5)]
    return [_SENSORS[mount.type_id]] if mount.type_id in _SENSORS else []


def all_topics(vehicle: Vehicle) -> list[Topic]:
    """Return every topic that a vehicle is published on for Autoware."""
    sensors = [topic for mount in vehicle.mounts for topic in sensor_topics(mount)]
    return [CLOCK, TF, TF_STATIC, *STATES, INITIAL_POSE, GOAL, ENGAGE, *dict.fromkeys(sensors)]


def mission(types: Types, way: list[tuple[float, float, float, float]]) -> list[Message]:
    """Return start, goal and the order to drive; ``way`` gives x, y, z in m and yaw in rad in CARLA's axes."""
    start, goal = (_pose(types, *way[index]) for index in (0, -1))
    header = basic.header(types, 0.0, of_vehicle.MAP)
    covered = types.message("geometry_msgs/msg/PoseWithCovariance", pose=start)
    return [
        Message(INITIAL_POSE, types.message(INITIAL_POSE.type, header=header, pose=covered)),
        Message(GOAL, types.message(GOAL.type, header=header, pose=goal)),
        Message(ENGAGE, types.message(ENGAGE.type, stamp=basic.stamp(types, 0.0), engage=True)),
    ]


def autoware_messages(types: Types, vehicle: Vehicle, moment: Moment, tyre_angle_rad: float) -> Iterator[Message]:
    """Yield the messages of one frame; ``tyre_angle_rad`` is the front tyres' angle, positive to the left.

    Of several sensors of a kind, Autoware's topic has the first one.
    """
    t_s, motion, behind_m = moment.t_s, moment.motion, vehicle.rear_axle_m
    stamp = basic.stamp(types, t_s)
    based = basic.header(types, t_s, of_vehicle.BASE)
    moving = of_vehicle.twist(types, motion, behind_m)
    yield Message(CLOCK, basic.clock(types, t_s))
    yield Message(TF, basic.transforms(types, t_s, of_vehicle.moving_tree(vehicle, motion)))
    for mount, data in _first_of_each_topic(moment):
        header = basic.header(types, t_s, of_vehicle.sensor_frame(vehicle, mount))
        parts = sensor_messages(types, header, mount, data)
        for topic, (_, content) in zip(sensor_topics(mount), parts, strict=True):
            yield Message(topic, content)
    report = {"longitudinal_velocity": moving.linear.x, "lateral_velocity": moving.linear.y}
    yield Message(VELOCITY, types.message(VELOCITY.type, header=based, heading_rate=moving.angular.z, **report))
    yield Message(STEERING, types.message(STEERING.type, stamp=stamp, steering_tire_angle=tyre_angle_rad))
    gear = REVERSE if moment.control.reverse else DRIVE
    yield Message(GEAR, types.message(GEAR.type, stamp=stamp, report=gear))
    yield Message(MODE, types.message(MODE.type, stamp=stamp, mode=AUTONOMOUS))
    for lamp in (TURN, HAZARD):
        yield Message(lamp, types.message(lamp.type, stamp=stamp, report=OFF))
    yield Message(ACCELERATION, _acceleration(types, moment, based))
    yield Message(KINEMATIC, of_vehicle.odometry(types, vehicle, moment, of_vehicle.BASE))


def _first_of_each_topic(moment: Moment) -> Iterator[Any]:
    """The measurements that have a topic of Autoware's, one a topic."""
    taken: set[str] = set()
    for measurement in moment.measured:
        names = [topic.name for topic in sensor_topics(measurement.mount)]
        if names and not taken.intersection(names):
            taken.update(names)
            yield measurement


def _acceleration(types: Types, moment: Moment, header: Any) -> Any:  # noqa: ANN401 - messages
    """The acceleration in the axes of base_link."""
    motion = moment.motion
    linear = frames.in_body(motion.pose.attitude, motion.acceleration_mps2)
    accel = types.message("geometry_msgs/msg/Accel", linear=vector3(types, linear))
    covered = types.message("geometry_msgs/msg/AccelWithCovariance", accel=accel)
    return types.message(ACCELERATION.type, header=header, accel=covered)


def _pose(types: Types, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> Any:  # noqa: ANN401 - a message
    return basic.pose_message(types, Pose(frames.vector(x_m, y_m, z_m), frames.attitude(0.0, 0.0, yaw_rad)))
