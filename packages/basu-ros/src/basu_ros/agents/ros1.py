"""``basu run ros1``: software of ROS 1 on CARLA's topics drives, in lock-step at a roscore."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_ros.agents.lockstep import NODE, LockstepAgent
from basu_ros.ros1 import Ros1Node

if TYPE_CHECKING:
    from basu_ros.node import RosNode

FIRST_S = 1.0  # the time of the first frame: a clock of 0 says "no clock yet" to nodes of ROS 1 (wiki.ros.org/Clock)


class Ros1Agent(LockstepAgent):
    """CARLA's topics on ROS 1: ``vehicle_control_cmd`` or ``ackermann_cmd`` drives."""

    first_s = FIRST_S

    def new_node(self) -> RosNode:
        """Return a node at the master; nodes that start later take their time from ``/clock``."""
        return Ros1Node(NODE, in_lockstep=True)
