"""The managers that publish a run on ROS and write it as a bag; of use where rosbags is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.ros.bag_manager import BagManager
from basu.output.ros.publish_manager import PublishManager
from basu.ros.ros1 import Node as Ros1Node
from basu.ros.types import Generation

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers import Live
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions


def ros_managers(options: DriveOptions, live: Live, say: Callable[[str], None]) -> list[BaseManager]:
    """Return the managers of ``--ros2``, ``--ros1`` and ``--rosbag``."""
    managers: list[BaseManager] = []
    if options.ros2:
        from basu.ros.dds import Node as Ros2Node  # noqa: PLC0415 - DDS, an extra that bags and ROS 1 do not need

        managers.append(PublishManager(live, Ros2Node, say))
    if options.ros1:
        managers.append(PublishManager(live, Ros1Node, say))
    if options.rosbag is not None:
        managers.append(BagManager(live, Generation(options.rosbag), say))
    return managers
