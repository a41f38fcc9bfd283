"""A small driver for `basu run ros`, `autoware`, `ros1` and `autoware-ai`: pure pursuit of the route.

Start it beside the run, in another process: `python examples/ros_follower.py KIND`. `carla`, `ackermann` and `autoware`
are over DDS and need no ROS; `ros1`, `autoware-ai` and `autoware-ai-1.13` are at a roscore. It answers each pose with
one command. The law is Coulter's (1992, "Implementation of the pure pursuit path tracking algorithm").
"""

import math
import sys

from basu_ros import autoware_ai, dds, ros1
from basu_ros.topics import odometry_of, path_of
from linden_ros2.topic import Message, Topic, ackermann_of, control_of

SPEED_MPS, AHEAD_M, WHEELBASE_M = 5.0, 6.0, 2.8
KINEMATIC = Topic("/localization/kinematic_state", "nav_msgs/msg/Odometry")
CONTROL = Topic("/control/command/control_cmd", "autoware_control_msgs/msg/Control", is_latched=True, depth=1)
PATIENCE_S = 120.0  # without a frame: the run is over


def wanted(message, path):
    """Speed in m/s and tyre angle in rad, positive to the left, towards a point of the path."""
    pose = getattr(message.pose, "pose", message.pose)  # an odometry, or a pose alone
    at, turn = pose.position, pose.orientation
    yaw = 2.0 * math.atan2(turn.z, turn.w)
    away = [math.hypot(x - at.x, y - at.y) for x, y in path]
    nearest = min(range(len(path)), key=away.__getitem__)
    goal = next((i for i in range(nearest, len(path)) if away[i] > AHEAD_M), len(path) - 1)
    x, y = path[goal]
    bearing = math.remainder(math.atan2(y - at.y, x - at.x) - yaw, math.tau)
    angle = math.atan2(2.0 * WHEELBASE_M * math.sin(bearing), max(away[goal], 1.0))
    return (SPEED_MPS if goal > nearest + 1 else 0.0), angle


def command(types, kind, seen, path):
    """A message for the vehicle, with the time of the frame that it answers."""
    speed, angle = wanted(seen, path)
    stamp = seen.header.stamp
    if kind.startswith("autoware-ai"):
        twist = types.message("geometry_msgs/msg/Twist")
        twist.linear.x, twist.angular.z = speed, speed * math.tan(angle) / WHEELBASE_M
        stamped = types.message("geometry_msgs/msg/TwistStamped", twist=twist)
        return types.message(autoware_ai.COMMAND.type, header=seen.header, twist_cmd=stamped)
    if kind == "autoware":
        return types.message(
            CONTROL.type,
            stamp=stamp,
            lateral=types.message("autoware_control_msgs/msg/Lateral", stamp=stamp, steering_tire_angle=angle),
            longitudinal=types.message("autoware_control_msgs/msg/Longitudinal", stamp=stamp, velocity=speed),
        )
    if kind in {"ackermann", "ros1"}:
        return types.message("ackermann_msgs/msg/AckermannDrive", speed=speed, steering_angle=angle)
    header, now = types.message("std_msgs/msg/Header", stamp=stamp), seen.twist.twist.linear.x
    return types.message(
        "carla_msgs/msg/CarlaEgoVehicleControl",
        header=header,
        throttle=max(0.0, min(0.6, 0.3 * (speed - now))),
        brake=max(0.0, min(1.0, 0.5 * (now - speed))),
        steer=max(-1.0, min(1.0, -angle / 0.7)),
    )


def main(kind="carla"):
    is_first = kind == "ros1" or kind.startswith("autoware-ai")
    node = ros1.Ros1Node("follower") if is_first else dds.Ros2Node("follower")
    seen, told = odometry_of("hero"), control_of("hero")
    if kind in {"ackermann", "ros1"}:
        told = ackermann_of("hero")
    elif kind == "autoware":
        seen, told = KINEMATIC, CONTROL
    elif is_first:
        seen, told = autoware_ai.CURRENT_POSE, autoware_ai.COMMAND
    types = autoware_ai.old_types() if kind == "autoware-ai-1.13" else node.types
    way = path_of("hero")
    node.listen(seen, way)
    if is_first:
        node.announce_as(types, told)
    else:
        node.announce(told)
    path = []
    while node.wait(seen, PATIENCE_S):
        for message in node.received(way):
            path = [(each.pose.position.x, each.pose.position.y) for each in message.poses]
        for frame in node.received(seen)[-1:]:
            if path or node.wait(way, 5.0):
                path = path or [(p.pose.position.x, p.pose.position.y) for p in node.received(way)[-1].poses]
                answer = Message(told, command(types, kind, frame, path))
                node.publish_as(types, answer) if is_first else node.publish(answer)


if __name__ == "__main__":
    main(*sys.argv[1:])
