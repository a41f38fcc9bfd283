"""`Ros2Node`, the benchmark's node of ROS 2: that of linden-ros2, with errors that users of BASU read."""

from __future__ import annotations

from basu.errors import UserError
from linden_ros2.dds_domain import DdsError
from linden_ros2.dds_node import DdsNode


class Ros2Node(DdsNode):
    """A node of ROS 2 on the domain of the environment, or on one that is named."""

    def __init__(self, name: str, domain: int | None = None) -> None:
        """Join the domain.

        Raises:
            UserError: ``ROS_DOMAIN_ID`` names no domain, or DDS finds no network.
        """
        try:
            super().__init__(name, domain)
        except DdsError as error:
            raise UserError(str(error)) from error
