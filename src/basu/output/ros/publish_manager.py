"""``--ros2``: publishes a run on ROS 2 while it lasts, whatever agent drives; the run is not affected."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.ros.vehicle_source import info_message
from basu.managers.base_manager import BaseManager
from basu.output.ros.live_vehicle import LiveVehicle
from basu.output.ros.record_bag import event_messages, event_topics
from basu.ros.dds import Node
from basu.ros.topics import first_messages, moment_messages, path_message, path_of, vehicle_topics

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run

NODE = "basu_run"


class PublishManager(BaseManager):
    """Publishes each frame; contacts and crossed markings come at the end, when the record has all of them."""

    def __init__(self, live: Live, say: Callable[[str], None]) -> None:
        """Observe ``live``; ``say`` prints the domain."""
        self._live, self._say = live, say
        self._node: Node | None = None

    def setup(self, run: Run) -> None:
        """Join the domain and publish what does not move.

        Raises:
            UserError: cyclonedds is not installed, or it finds no network.
        """
        self._source = LiveVehicle(run, self._live.sensors)
        vehicle, node = self._source.vehicle, Node(NODE)
        self._node = node
        node.announce(*vehicle_topics(vehicle), *event_topics(vehicle.role), path_of(vehicle.role))
        rows = zip(run.route.points_m.tolist(), run.route.yaw_rad.tolist(), strict=True)
        way = path_message(node.types, vehicle.role, [(*point, yaw) for point, yaw in rows])
        node.publish(*first_messages(node.types, vehicle, 0.0), way, info_message(node.types, run.vehicle))
        self._say(f"ROS 2             domain {node.domain}, topics /carla/{vehicle.role}/…")

    def tick(self, frame: Frame) -> None:
        """Publish a frame."""
        if self._node is not None:
            moment = self._source.moment(frame)
            self._node.publish(*moment_messages(self._node.types, self._source.vehicle, moment))

    def close(self) -> None:
        """Publish the events and leave the domain."""
        if self._node is None:
            return
        node, self._node = self._node, None
        if self._live.metrics.ticks:
            role = self._source.vehicle.role
            node.publish(*(message for _, message in event_messages(node.types, role, self._live.metrics.history())))
        node.close()
