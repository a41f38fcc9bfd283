"""The output ``ros``: the managers that publish a run on ROS and write it as a bag."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_ros.dds import Ros2Node
from basu_ros.output.bag_manager import BagManager
from basu_ros.output.publish_manager import PublishManager
from basu_ros.ros1 import Ros1Node, require_roscore
from linden_ros2.types import Generation

if TYPE_CHECKING:
    from basu.managers.base_manager import BaseManager
    from basu.options.drive import DriveOptions
    from basu.running.outputs import ShownDrive


def check(options: DriveOptions) -> None:
    """Check that a roscore answers for ``--ros1``.

    Raises:
        UserError: ROS 1 is not there, or no roscore answers.
    """
    if options.ros1:
        require_roscore()


def managers(options: DriveOptions, drive: ShownDrive) -> list[BaseManager]:
    """Return the managers of ``--ros2``, ``--ros1`` and ``--rosbag``."""
    found: list[BaseManager] = []
    live, say = drive.live, drive.say
    if options.ros2:
        found.append(PublishManager(live, Ros2Node, say))
    if options.ros1:
        found.append(PublishManager(live, Ros1Node, say))
    if options.rosbag is not None:
        found.append(BagManager(live, Generation(options.rosbag), say))
    return found
