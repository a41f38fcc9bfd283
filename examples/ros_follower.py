"""A small driver for `basu run ros` and `basu run autoware`: pure pursuit of the route, over DDS and without ROS.

Start it beside the run, in another process: `python examples/ros_follower.py [carla | ackermann | autoware]`. It
answers each odometry with one command. The law is Coulter's (1992, "Implementation of the pure pursuit path tracking
algorithm").
"""

import math
import sys

from basu.ros.dds import Node
from basu.ros.topics import Message, Topic, ackermann_of, control_of, odometry_of, path_of

SPEED_MPS, AHEAD_M, WHEELBASE_M = 5.0, 6.0, 2.8
KINEMATIC = Topic("/localization/kinematic_state", "nav_msgs/msg/Odometry")
CONTROL = Topic("/control/command/control_cmd", "autoware_control_msgs/msg/Control", is_latched=True, depth=1)
PATIENCE_S = 120.0  # without a frame: the run is over


def wanted(odometry, path):
    """Speed in m/s and tyre angle in rad, positive to the left, towards a point of the path."""
    at, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
    yaw = 2.0 * math.atan2(turn.z, turn.w)
    away = [math.hypot(x - at.x, y - at.y) for x, y in path]
    nearest = min(range(len(path)), key=away.__getitem__)
    goal = next((i for i in range(nearest, len(path)) if away[i] > AHEAD_M), len(path) - 1)
    x, y = path[goal]
    bearing = math.remainder(math.atan2(y - at.y, x - at.x) - yaw, math.tau)
    angle = math.atan2(2.0 * WHEELBASE_M * math.sin(bearing), max(away[goal], 1.0))
    return (SPEED_MPS if goal > nearest + 1 else 0.0), angle


def command(types, kind, odometry, path):
    """A message for the vehicle, with the time of the frame that it answers."""
    speed, angle = wanted(odometry, path)
    now = odometry.twist.twist.linear.x
    stamp = odometry.header.stamp
    if kind == "autoware":
        return types.message(
            CONTROL.type,
            stamp=stamp,
            lateral=types.message("autoware_control_msgs/msg/Lateral", stamp=stamp, steering_tire_angle=angle),
            longitudinal=types.message("autoware_control_msgs/msg/Longitudinal", stamp=stamp, velocity=speed),
        )
    if kind == "ackermann":
        return types.message("ackermann_msgs/msg/AckermannDrive", speed=speed, steering_angle=angle)
    header = types.message("std_msgs/msg/Header", stamp=stamp)
    return types.message(
        "carla_msgs/msg/CarlaEgoVehicleControl",
        header=header,
        throttle=max(0.0, min(0.6, 0.3 * (speed - now))),
        brake=max(0.0, min(1.0, 0.5 * (now - speed))),
        steer=max(-1.0, min(1.0, -angle / 0.7)),
    )


def main(kind="carla"):
    node = Node("follower")
    seen = KINEMATIC if kind == "autoware" else odometry_of("hero")
    told = {"autoware": CONTROL, "ackermann": ackermann_of("hero")}.get(kind, control_of("hero"))
    way = path_of("hero")
    node.listen(seen, way)
    node.announce(told)
    path = []
    while node.wait(seen, PATIENCE_S):
        for message in node.received(way):
            path = [(each.pose.position.x, each.pose.position.y) for each in message.poses]
        for odometry in node.received(seen)[-1:]:
            if path or node.wait(way, 5.0):
                path = path or [(p.pose.position.x, p.pose.position.y) for p in node.received(way)[-1].poses]
                node.publish(Message(told, command(node.types, kind, odometry, path)))


if __name__ == "__main__":
    main(*sys.argv[1:])
