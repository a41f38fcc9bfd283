"""Topics and messages of Autoware.AI 1.12 to 1.14 (ROS 1): sensing, localisation, mission, vehicle status and commands.

Names and types are those of Autoware.AI's nodes and of carla-autoware. ``base_link`` is the middle of the rear axle on
the ground. Where the software has no localisation of its own, pose and velocity come from the simulator.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from basu_ros import vehicle_messages as of_vehicle
from basu_ros.topics import TF_STATIC
from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.frames import Pose
from linden_ros2.sensor_messages import sensor_messages
from linden_ros2.topic import CLOCK, TF, Message, Topic
from linden_ros2.types import Generation, Types

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu_ros.moment import Moment, Vehicle
    from linden_ros2.mount import Mount

Place = tuple[float, float, float, float]
"""x, y, z in m and yaw in rad, in CARLA's axes."""

WORLD = "world"
MPS_TO_KMPH = 3.6
AUTO = 1  # VehicleStatus: MODE_AUTO
DRIVE, REVERSE = 4, 2  # autoware_msgs/Gear of 1.14
OLD_DRIVE, OLD_REVERSE = 1, 2  # 1.13: CMD_GEAR_D and CMD_GEAR_R of twist_gate.h

POSE, VELOCITY = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped"
CURRENT_POSE = Topic("/current_pose", POSE)
CURRENT_VELOCITY = Topic("/current_velocity", VELOCITY)
GNSS_POSE = Topic("/gnss_pose", POSE)
STATUS = Topic("/vehicle_status", "autoware_msgs/msg/VehicleStatus")
INITIAL_POSE = Topic("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped", is_latched=True, depth=1)
GOAL = Topic("/move_base_simple/goal", POSE, is_latched=True, depth=1)
STATE_COMMAND = Topic("/state_cmd", "std_msgs/msg/String", is_latched=True, depth=1)
COMMAND = Topic("/vehicle_cmd", "autoware_msgs/msg/VehicleCmd")
NDT_POSE = Topic("/ndt_pose", POSE)

POINTS = Topic("/points_raw", "sensor_msgs/msg/PointCloud2")
IMU = Topic("/imu_raw", "sensor_msgs/msg/Imu")
FIX = Topic("/fix", "sensor_msgs/msg/NavSatFix")
IMAGE = Topic("/image_raw", "sensor_msgs/msg/Image")
CAMERA = Topic("/camera_info", "sensor_msgs/msg/CameraInfo")
_SENSORS = {"sensor.lidar.ray_cast": POINTS, "sensor.other.imu": IMU, "sensor.other.gnss": FIX}
_FRAMES = {"sensor.lidar.ray_cast": "velodyne", "sensor.other.imu": "imu", "sensor.other.gnss": "gps"}

OLD_STATUS = """Header header
string tm
int32 drivemode
int32 steeringmode
int32 MODE_MANUAL=0
int32 MODE_AUTO=1
int32 gearshift
float64 speed
int32 drivepedal
int32 brakepedal
float64 angle
int32 lamp
int32 LAMP_LEFT=1
int32 LAMP_RIGHT=2
int32 LAMP_HAZARD=3
int32 light
"""
"""``autoware_msgs/VehicleStatus`` up to 1.13: the gear is a number."""
OLD_COMMAND = """Header header
autoware_msgs/SteerCmd steer_cmd
autoware_msgs/AccelCmd accel_cmd
autoware_msgs/BrakeCmd brake_cmd
autoware_msgs/LampCmd lamp_cmd
int32 gear
int32 mode
geometry_msgs/TwistStamped twist_cmd
autoware_msgs/ControlCommand ctrl_cmd
int32 emergency
"""
"""``autoware_msgs/VehicleCmd`` up to 1.13: likewise."""


class Ordered(NamedTuple):
    """What a ``VehicleCmd`` orders."""

    speed_mps: float  # negative backwards
    yaw_rate_radps: float  # of ``twist_cmd``, positive to the left
    tyre_angle_rad: float | None  # of ``ctrl_cmd``, where that one orders
    is_emergency: bool


def old_types() -> Types:
    """Return the types of Autoware.AI 1.12 and 1.13."""
    return Types(Generation.ROS_1, {COMMAND.type: OLD_COMMAND, STATUS.type: OLD_STATUS})


def is_old(definition: str) -> bool:
    """Return whether the definition of a ``VehicleCmd`` is that of 1.13 or before."""
    return "gear_cmd" not in definition


def sensor_topics(mount: Mount) -> list[Topic]:
    """Return the topics of a sensor in the order of its messages; none for what Autoware.AI has no topic for."""
    if mount.type_id == "sensor.camera.rgb":
        return [IMAGE, CAMERA]
    return [_SENSORS[mount.type_id]] if mount.type_id in _SENSORS else []


def sensor_frame(mount: Mount) -> str:
    """Return the frame of a sensor, as Autoware.AI's launch files call it."""
    return _FRAMES.get(mount.type_id, "camera")


def sensing_topics(vehicle: Vehicle) -> list[Topic]:
    """Return what is published of the sensors, and what never waits for the software's version."""
    sensors = [topic for mount in vehicle.mounts for topic in sensor_topics(mount)]
    return [CLOCK, TF, TF_STATIC, GNSS_POSE, INITIAL_POSE, GOAL, STATE_COMMAND, *dict.fromkeys(sensors)]


def still_messages(types: Types, vehicle: Vehicle, t_s: float) -> list[Message]:
    """Return the transforms that never change: world to map, base_link to each sensor."""
    tree = [(WORLD, of_vehicle.MAP, Pose((0.0, 0.0, 0.0), frames.IDENTITY))]
    for mount in _first_mounts(vehicle):
        x_m, y_m, z_m = mount.pose.position_m
        moved = Pose((x_m + vehicle.rear_axle_m, y_m, z_m), mount.pose.attitude)
        tree.append((of_vehicle.BASE, sensor_frame(mount), moved))
    return [Message(TF_STATIC, basic.transforms(types, t_s, tree))]


def mission(types: Types, goal: Place, t_s: float) -> list[Message]:
    """Return the goal and the order to drive."""
    return [goal_message(types, goal, t_s), Message(STATE_COMMAND, types.message(STATE_COMMAND.type, data="engage"))]


def initial_pose(types: Types, vehicle: Vehicle, moment: Moment) -> Message:
    """Return the pose of base_link, from which a localisation starts."""
    stamped = _pose(types, vehicle, moment)
    covered = types.message("geometry_msgs/msg/PoseWithCovariance", pose=stamped.pose)
    return Message(INITIAL_POSE, types.message(INITIAL_POSE.type, header=stamped.header, pose=covered))


def goal_message(types: Types, goal: Place, t_s: float) -> Message:
    """Return a goal."""
    x, y, z, yaw = goal
    pose = basic.pose_message(types, Pose(frames.vector(x, y, z), frames.attitude(0.0, 0.0, yaw)))
    header = basic.header(types, t_s, of_vehicle.MAP)
    return Message(GOAL, types.message(GOAL.type, header=header, pose=pose))


def sensing_messages(types: Types, vehicle: Vehicle, moment: Moment) -> Iterator[Message]:
    """Yield the measurements of one frame, and the true pose as that of a GNSS receiver; of a kind the first sensor."""
    mounts = _first_mounts(vehicle)
    for mount, data in moment.measured:
        if mount in mounts:
            header = basic.header(types, moment.t_s, sensor_frame(mount))
            parts = sensor_messages(types, header, mount, data)
            for topic, (_, content) in zip(sensor_topics(mount), parts, strict=True):
                yield Message(topic, content)
    yield Message(GNSS_POSE, _pose(types, vehicle, moment))


def localisation_messages(types: Types, vehicle: Vehicle, moment: Moment) -> Iterator[Message]:
    """Yield pose, velocity and transform of base_link in the map: instead of the software's own localisation."""
    pose = frames.moved_back(moment.motion.pose, vehicle.rear_axle_m)
    yield Message(TF, basic.transforms(types, moment.t_s, [(of_vehicle.MAP, of_vehicle.BASE, pose)]))
    moving = of_vehicle.twist(types, moment.motion, vehicle.rear_axle_m)
    header = basic.header(types, moment.t_s, of_vehicle.BASE)
    yield Message(CURRENT_VELOCITY, types.message(VELOCITY, header=header, twist=moving))
    yield Message(CURRENT_POSE, _pose(types, vehicle, moment))


def status_message(types: Types, vehicle: Vehicle, moment: Moment, tyre_angle_rad: float) -> Message:
    """Return speed, tyre angle (positive to the left) and gear, in the version of ``types``."""
    moving = of_vehicle.twist(types, moment.motion, vehicle.rear_axle_m)
    is_back = moment.control.reverse
    fields = [name for name, _ in types.store.fielddefs[STATUS.type][1]]
    if "gearshift" in fields:
        gear: dict[str, Any] = {"gearshift": OLD_REVERSE if is_back else OLD_DRIVE}
    else:
        gear = {"current_gear": types.message("autoware_msgs/msg/Gear", gear=REVERSE if is_back else DRIVE)}
    header = basic.header(types, moment.t_s, of_vehicle.BASE)
    values = {"speed": moving.linear.x * MPS_TO_KMPH, "angle": tyre_angle_rad, "drivemode": AUTO, "steeringmode": AUTO}
    return Message(STATUS, types.message(STATUS.type, header=header, **values, **gear))


def ordered(message: Any) -> Ordered:  # noqa: ANN401 - a VehicleCmd of either version
    """Return what a command orders; values are not checked.

    As in carla-autoware, ``twist_cmd`` orders, unless it is empty and ``ctrl_cmd`` is not.
    """
    twist, control = message.twist_cmd.twist, message.ctrl_cmd
    gear, back = (message.gear, OLD_REVERSE) if hasattr(message, "gear") else (message.gear_cmd.gear, REVERSE)
    by_twist = bool(twist.linear.x or twist.angular.z) or control.linear_velocity <= 0.0
    speed = float(twist.linear.x if by_twist else control.linear_velocity)
    if gear == back and speed > 0.0:
        speed = -speed
    angle = None if by_twist else float(control.steering_angle)
    return Ordered(speed, float(twist.angular.z), angle, bool(message.emergency))


def tyre_angle_rad(speed_mps: float, yaw_rate_radps: float, wheelbase_m: float) -> float:
    """Return the tyre angle of a bicycle that turns at a rate: Rajamani, Vehicle Dynamics and Control, section 2.2."""
    return 0.0 if speed_mps == 0.0 else math.atan(wheelbase_m * yaw_rate_radps / speed_mps)


def _first_mounts(vehicle: Vehicle) -> list[Mount]:
    """The first sensor of each topic."""
    first = {topics[0]: mount for mount in reversed(vehicle.mounts) if (topics := sensor_topics(mount))}
    return [mount for mount in vehicle.mounts if mount in first.values()]


def _pose(types: Types, vehicle: Vehicle, moment: Moment) -> Any:  # noqa: ANN401 - a message
    """The pose of base_link in the map."""
    pose = basic.pose_message(types, frames.moved_back(moment.motion.pose, vehicle.rear_axle_m))
    return types.message(POSE, header=basic.header(types, moment.t_s, of_vehicle.MAP), pose=pose)
