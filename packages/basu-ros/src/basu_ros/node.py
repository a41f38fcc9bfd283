"""`RosNode`, the protocol of ROS 1 and ROS 2 nodes: publishing and receiving on topics, and the number of peers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from linden_ros2.topic import Message, Topic
    from linden_ros2.types import Types


class RosNode(Protocol):
    """A node: ``dds.Node`` for ROS 2, ``ros1.Node`` for ROS 1."""

    types: Types
    kind: str  # "ROS 1" or "ROS 2"
    realm: str  # where peers are found: the domain 7, the master http://localhost:11311
    settings: str  # the environment variables that peers must share
    missed_s: float  # wall time after which a node that was killed counts no more

    def announce(self, *topics: Topic) -> None:
        """Make publishers, so that peers find the topics before the first message."""

    def listen(self, *topics: Topic) -> None:
        """Make subscribers."""

    def publish(self, *messages: Message) -> None:
        """Publish messages on their topics."""

    def received(self, topic: Topic) -> list[Any]:
        """Return the messages that have arrived since the last call, the oldest first."""

    def wait_any(self, topics: Sequence[Topic], timeout_s: float) -> bool:
        """Wait until something has arrived on one of the topics; whether it has."""

    def writers_of(self, topic: Topic) -> int:
        """Return how many peers publish on a topic that this node listens to."""

    def unheard(self, topic: Topic) -> list[str]:
        """Return why each peer that publishes on a topic, and that this node does not hear, does not fit."""

    def readers_of(self, topic: Topic) -> int:
        """Return how many peers listen to a topic of this node."""

    def close(self) -> None:
        """Leave."""
