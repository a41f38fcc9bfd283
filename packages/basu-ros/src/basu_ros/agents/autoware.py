"""``basu run autoware``: an Autoware of ROS 2 beside the run drives the vehicle, in lock-step over DDS."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu_ros import autoware
from basu_ros.agents.autoware_base import AutowareBase
from basu_ros.agents.commands import REVERSE, Wanted, autoware_command
from basu_ros.agents.lockstep import NODE
from basu_ros.dds import Ros2Node
from basu_ros.topics import TF_STATIC, first_messages, path_message, path_of
from linden_ros2.topic import Message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_ros.moment import Moment
    from basu_ros.node import RosNode
    from linden_ros2.topic import Topic


class AutowareAgent(AutowareBase):
    """Autoware's topics: sensing, vehicle status, localisation and goal out, ``control_cmd`` in."""

    def new_node(self) -> RosNode:
        """Return a node on the domain of ``ROS_DOMAIN_ID``."""
        return Ros2Node(NODE)

    def topics(self) -> Sequence[Topic]:
        """Return Autoware's topics, and the route as a path for planners that take one."""
        return [*autoware.all_topics(self.described), path_of(self.described.role)]

    def commands(self) -> Sequence[Topic]:
        """Return Autoware's control command."""
        return [autoware.CONTROL]

    def beginning(self) -> Sequence[Message]:
        """Return transforms, start, goal, the order to drive, and the route as a path."""
        types, way = self.node.types, self.way()
        still = first_messages(types, self.described, 0.0)
        assert all(message.topic == TF_STATIC for message in still), "they never move"
        return [*still, *autoware.mission(types, way), path_message(types, self.described.role, way)]

    def messages(self, moment: Moment) -> Sequence[Message]:
        """Return what Autoware's interfaces publish in a frame."""
        return list(autoware.autoware_messages(self.node.types, self.described, moment, self.tyre_angle_rad))

    def wanted(self, topic: Topic, message: Any) -> Wanted:  # noqa: ANN401 - a message
        """Return what a control command wants; in the reverse gear its speed is backwards."""
        del topic
        wanted = autoware_command(message)
        for gear in self.node.received(autoware.GEAR_COMMAND):
            self._is_reverse = gear.command == REVERSE
        if self._is_reverse and wanted.speed_mps > 0.0:
            wanted = wanted._replace(speed_mps=-wanted.speed_mps)
        self.tyre_angle_rad = wanted.tyre_angle_rad
        return wanted

    def setup(self) -> None:
        """Publish the mission, and wait until an Autoware appears on the domain."""
        self._is_reverse, self.tyre_angle_rad = False, 0.0
        super().setup()
        self.node.listen(autoware.GEAR_COMMAND)
