"""`Topic` and `Message`: what nodes publish and hear; the topics that every simulated vehicle has."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")  # of a part of a topic's name: design.ros2.org, topic and service names


class Topic(NamedTuple):
    """A topic: its name with a slash, its type, whether a late subscriber gets the last message, and the delivery."""

    name: str
    type: str
    is_latched: bool = False
    is_reliable: bool = True
    depth: int = 10  # messages that a writer or reader keeps; the ros-bridge has 10


class Message(NamedTuple):
    """A message for a topic."""

    topic: Topic
    content: Any  # a message of `Types`


CLOCK = Topic("/clock", "rosgraph_msgs/msg/Clock")
TF = Topic("/tf", "tf2_msgs/msg/TFMessage", depth=100)


def control_of(role: str) -> Topic:
    """Return the topic of commands to a vehicle as CARLA has them."""
    return Topic(f"/carla/{role}/vehicle_control_cmd", "carla_msgs/msg/CarlaEgoVehicleControl")


def ackermann_of(role: str) -> Topic:
    """Return the topic of Ackermann commands to a vehicle."""
    return Topic(f"/carla/{role}/ackermann_cmd", "ackermann_msgs/msg/AckermannDrive")
