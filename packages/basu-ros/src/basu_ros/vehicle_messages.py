"""Messages of a vehicle as the ros-bridge has them: trees of transforms, odometry, status, other actors, lights."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from linden_ros2 import basic_messages as basic
from linden_ros2 import frames
from linden_ros2.basic_messages import quaternion, vector3
from linden_ros2.frames import Pose

if TYPE_CHECKING:
    from basu_ros.moment import Actor, Control, Light, Moment, Motion, Vehicle
    from linden_ros2.mount import Mount
    from linden_ros2.types import Types

MAP, ODOM, BASE = "map", "odom", "base_link"
BOX = 1  # shape_msgs/SolidPrimitive
UNKNOWN, PEDESTRIAN, BIKE, CAR, TRUCK, MOTORCYCLE, BARRIER = 0, 4, 5, 6, 7, 8, 10  # derived_object_msgs/Object
CERTAIN, TRACKED = 255, 1
LIGHTS = {0: 0, 1: 1, 2: 2, 3: 3}  # carla.TrafficLightState to CarlaTrafficLightStatus: red, yellow, green, off
LIGHT_UNKNOWN = 4
BIKES = ("crossbike", "omafiets", "century")
MOTORCYCLES = ("harley", "ninja", "zx125", "yzf")
TRUCKS = ("carlacola", "firetruck", "ambulance", "european_hgv", "truck", "sprinter", "fusorosa")


def still_tree(vehicle: Vehicle) -> list[tuple[str, str, Pose]]:
    """Return what never moves: map to odom, base_link to the vehicle's origin, the origin to its sensors."""
    origin = Pose((vehicle.rear_axle_m, 0.0, 0.0), frames.IDENTITY)
    fixed = [(MAP, ODOM, Pose((0.0, 0.0, 0.0), frames.IDENTITY)), (BASE, vehicle.role, origin)]
    return [*fixed, *((vehicle.role, sensor_frame(vehicle, mount), mount.pose) for mount in vehicle.mounts)]


def moving_tree(vehicle: Vehicle, motion: Motion) -> list[tuple[str, str, Pose]]:
    """Return what moves: base_link in odom."""
    return [(ODOM, BASE, frames.moved_back(motion.pose, vehicle.rear_axle_m))]


def sensor_frame(vehicle: Vehicle, mount: Mount) -> str:
    """Return the frame of a sensor, as the ros-bridge calls it."""
    return f"{vehicle.role}/{mount.id}"


def twist(types: Types, motion: Motion, rear_axle_m: float = 0.0) -> Any:  # noqa: ANN401 - a message
    """Return the velocities in the vehicle's axes, at a point ``rear_axle_m`` behind its origin."""
    turn = motion.pose.attitude
    spin = frames.in_body(turn, motion.angular_velocity_radps)
    forward, left, up = frames.in_body(turn, motion.velocity_mps)
    linear = (forward, left - spin[2] * rear_axle_m, up + spin[1] * rear_axle_m)
    return types.message("geometry_msgs/msg/Twist", linear=vector3(types, linear), angular=vector3(types, spin))


def odometry(types: Types, vehicle: Vehicle, moment: Moment, child: str) -> Any:  # noqa: ANN401 - a message
    """Return the pose in the map, and the velocities in the axes of ``child``: base_link, or the vehicle's frame."""
    behind_m = vehicle.rear_axle_m
    pose = basic.pose_message(types, frames.moved_back(moment.motion.pose, behind_m))
    return types.message(
        "nav_msgs/msg/Odometry",
        header=basic.header(types, moment.t_s, MAP),
        child_frame_id=child,
        pose=types.message("geometry_msgs/msg/PoseWithCovariance", pose=pose),
        twist=types.message("geometry_msgs/msg/TwistWithCovariance", twist=twist(types, moment.motion, behind_m)),
    )


def control_message(types: Types, control: Control, t_s: float = 0.0) -> Any:  # noqa: ANN401 - a message
    """Return a control as CARLA has it: steer is positive to the right."""
    return types.message(
        "carla_msgs/msg/CarlaEgoVehicleControl", header=basic.header(types, t_s, ""), **control._asdict()
    )


def status(types: Types, moment: Moment) -> Any:  # noqa: ANN401 - a message
    """Return speed, acceleration, attitude and the applied control; the acceleration has the axes of the map."""
    motion = moment.motion
    return types.message(
        "carla_msgs/msg/CarlaEgoVehicleStatus",
        header=basic.header(types, moment.t_s, MAP),
        velocity=math.hypot(*motion.velocity_mps),
        acceleration=types.message("geometry_msgs/msg/Accel", linear=vector3(types, motion.acceleration_mps2)),
        orientation=quaternion(types, motion.pose.attitude),
        control=control_message(types, moment.control),
    )


def simulator_status(types: Types, moment: Moment, step_s: float) -> Any:  # noqa: ANN401 - a message
    """Return CARLA's number of the frame, else the moment's own, and that the simulator runs in steps."""
    return types.message(
        "carla_msgs/msg/CarlaStatus",
        frame=moment.frame if moment.server_frame is None else moment.server_frame,
        fixed_delta_seconds=step_s,
        synchronous_mode=True,
        synchronous_mode_running=True,
    )


def classification(type_id: str) -> int:
    """Return the class of an actor by its blueprint's id."""
    name = type_id.rpartition(".")[2]
    if type_id.startswith("walker."):
        return PEDESTRIAN
    if type_id.startswith("static.prop."):
        return BARRIER
    if not type_id.startswith("vehicle."):
        return UNKNOWN
    found = ((BIKES, BIKE), (MOTORCYCLES, MOTORCYCLE), (TRUCKS, TRUCK))
    return next((kind for names, kind in found if any(word in name for word in names)), CAR)


def objects(types: Types, t_s: float, others: tuple[Actor, ...]) -> Any:  # noqa: ANN401 - a message
    """Return the other actors with boxes and velocities in the map; heights of boxes are not recorded and stay 0."""
    return types.message(
        "derived_object_msgs/msg/ObjectArray",
        header=basic.header(types, t_s, MAP),
        objects=[_object(types, t_s, actor) for actor in others],
    )


def _object(types: Types, t_s: float, actor: Actor) -> Any:  # noqa: ANN401 - a message
    pose = Pose(frames.vector(actor.x_m, actor.y_m, actor.z_m), frames.attitude(0.0, 0.0, actor.yaw_rad))
    velocity = frames.vector(actor.velocity_x_mps, actor.velocity_y_mps, 0.0)
    size = np.array([2.0 * actor.half_length_m, 2.0 * actor.half_width_m, 0.0])
    kind = classification(actor.type_id)
    return types.message(
        "derived_object_msgs/msg/Object",
        header=basic.header(types, t_s, MAP),
        id=actor.id,
        detection_level=TRACKED,
        object_classified=kind != UNKNOWN,
        pose=basic.pose_message(types, pose),
        twist=types.message("geometry_msgs/msg/Twist", linear=vector3(types, velocity)),
        shape=types.message("shape_msgs/msg/SolidPrimitive", type=BOX, dimensions=size),
        classification=kind,
        classification_certainty=CERTAIN if kind != UNKNOWN else 0,
    )


def lights(types: Types, states: tuple[Light, ...]) -> Any:  # noqa: ANN401 - a message
    """Return the states of traffic lights."""
    rows = [
        types.message(
            "carla_msgs/msg/CarlaTrafficLightStatus", id=light.id, state=LIGHTS.get(light.state, LIGHT_UNKNOWN)
        )
        for light in states
    ]
    return types.message("carla_msgs/msg/CarlaTrafficLightStatusList", traffic_lights=rows)
