"""`AttachedPublisher`: ROS 2 of a running server. The server loads this module for ``linden serve --ros2``."""

from typing import TYPE_CHECKING

from linden.errors import UserError
from linden.server.rpc.context import Follower
from linden_ros2.dds_domain import DdsError, is_local
from linden_ros2.dds_node import DdsNode
from linden_ros2.publisher import WorldPublisher
from linden_ros2.rtps_services import ServiceParticipant
from linden_ros2.world_services import SERVICES, WorldServices

if TYPE_CHECKING:
    from linden.server.loop import Server

NODE = "carla"


class AttachedPublisher:
    """The node of a server, and the publisher that follows its frames."""

    def __init__(self) -> None:
        """Join the domain of the environment.

        Raises:
            UserError: ``ROS_DOMAIN_ID`` names no domain, or DDS finds no network.
        """
        try:
            self._node = DdsNode(NODE)
            self._participant = ServiceParticipant(SERVICES, self._node.domain, is_local=is_local())
        except (DdsError, OSError) as error:
            raise UserError(f"--ros2: {error}") from error
        self._node.enter_services(*self._participant.endpoints())

    def attach(self, server: "Server") -> str:
        """Publish a server's frames from now on; return where, for its user."""
        context = server.context
        context.publisher = publisher = WorldPublisher(context, self._node)
        context.followers.append(Follower("publisher of ROS 2", publisher.after_frame, publisher.before_frame))
        services = WorldServices(context, self._node, self._participant)
        follower = Follower("services of ROS 2", lambda _measured: None, services.before_frame)
        server.follow(follower, self._participant.fileno(), services.read)
        reach = "this machine alone" if is_local() else "all networks"
        return f"domain {self._node.domain}, {reach}, topics /clock, /tf and /carla/..., services /carla/..."

    def close(self) -> None:
        """Remove this node from its ROS 2 domain; it publishes, hears and serves nothing more."""
        self._participant.close()
        self._node.close()
