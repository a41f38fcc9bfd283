"""``basu run ros``: software of ROS 2 on CARLA's topics drives, in lock-step over DDS."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_ros.agents.lockstep import NODE, LockstepAgent
from basu_ros.dds import Ros2Node

if TYPE_CHECKING:
    from basu_ros.node import RosNode


class RosAgent(LockstepAgent):
    """CARLA's topics on ROS 2: ``vehicle_control_cmd`` or ``ackermann_cmd`` drives."""

    def new_node(self) -> RosNode:
        """Return a node on the domain of ``ROS_DOMAIN_ID``."""
        return Ros2Node(NODE)
