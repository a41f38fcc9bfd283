"""``--ros2`` and ``--ros1``: publish a run while it lasts, whatever agent drives; the run is not affected."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.managers.base_manager import BaseManager
from basu_ros.agents.vehicle_source import info_message
from basu_ros.output.live_vehicle import LiveVehicle
from basu_ros.output.record_bag import event_messages, event_topics
from basu_ros.topics import first_messages, moment_messages, path_message, path_of, vehicle_topics

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run
    from basu_ros.node import RosNode

NODE = "basu_run"


class PublishManager(BaseManager):
    """Publishes each frame; contacts and crossed markings come at the end, when the record has all of them."""

    def __init__(self, live: Live, make_node: Callable[[str], RosNode], say: Callable[[str], None]) -> None:
        """Observe ``live``; ``make_node`` makes a node of ROS 2 or ROS 1, ``say`` prints where it is."""
        self._live, self._make_node, self._say = live, make_node, say
        self._node: RosNode | None = None

    def setup(self, run: Run) -> None:
        """Join the domain, or the master, and publish what does not move.

        Raises:
            UserError: DDS finds no network; ROS 1 is not there, or no roscore answers.
        """
        self._source = LiveVehicle(run, self._live.sensors)
        vehicle, node = self._source.vehicle, self._make_node(NODE)
        self._node = node
        node.announce(*vehicle_topics(vehicle), *event_topics(vehicle.role), path_of(vehicle.role))
        rows = zip(run.route.points_m.tolist(), run.route.yaw_rad.tolist(), strict=True)
        way = path_message(node.types, vehicle.role, [(*point, yaw) for point, yaw in rows])
        node.publish(*first_messages(node.types, vehicle, 0.0), way, info_message(node.types, run.vehicle))
        self._say(f"{node.kind:<17} {node.realm.removeprefix('the ')}, topics /carla/{vehicle.role}/…")

    def tick(self, frame: Frame) -> None:
        """Publish a frame."""
        if self._node is not None:
            moment = self._source.moment(frame)._replace(server_frame=frame.server_frame)
            self._node.publish(*moment_messages(self._node.types, self._source.vehicle, moment))

    def close(self) -> None:
        """Publish the events and leave."""
        if self._node is None:
            return
        node, self._node = self._node, None
        if self._live.metrics.ticks:
            role = self._source.vehicle.role
            node.publish(*(message for _, message in event_messages(node.types, role, self._live.metrics.history())))
        node.close()
