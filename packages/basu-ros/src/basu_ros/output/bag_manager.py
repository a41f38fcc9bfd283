"""``--rosbag``: writes a run as a ROS bag while it lasts; the run is not affected."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.managers.base_manager import BaseManager
from basu_ros.agents.vehicle_source import control_of, info_message
from basu_ros.bag_file import BagFile
from basu_ros.output.live_vehicle import LiveVehicle
from basu_ros.output.record_bag import command_message, event_messages, event_topics
from basu_ros.topics import first_messages, moment_messages, vehicle_topics
from linden_ros2.topic import control_of as control_topic
from linden_ros2.types import Generation

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run

BAGS = {Generation.ROS_1: "rosbag.bag", Generation.ROS_2: "rosbag"}
"""The name of a bag in its run's folder: a file for ROS 1, a folder with MCAP for ROS 2."""


class BagManager(BaseManager):
    """Writes each frame with the control that the agent asked for; contacts and crossings come at the end."""

    def __init__(self, live: Live, generation: Generation, say: Callable[[str], None]) -> None:
        """Observe ``live``; ``say`` prints where the bag is."""
        self._live, self._generation, self._say = live, generation, say
        self._bag: BagFile | None = None

    def setup(self, run: Run) -> None:
        """Begin the bag with everything that does not move.

        Raises:
            UserError: a sensor's id cannot be part of a topic's name.
        """
        self._source = LiveVehicle(run, self._live.sensors)
        vehicle = self._source.vehicle
        topics = [*vehicle_topics(vehicle), *event_topics(vehicle.role), control_topic(vehicle.role)]
        self._path: Path = run.folder / BAGS[self._generation]
        self._bag = bag = BagFile(self._path, self._generation)
        bag.announce(topics)
        bag.write(0.0, [*first_messages(bag.types, vehicle, 0.0), info_message(bag.types, run.vehicle)])

    def tick(self, frame: Frame) -> None:
        """Write a frame.

        Raises:
            UserError: the disk is full.
        """
        bag, vehicle = self._bag, self._source.vehicle
        if bag is None:
            return
        moment = self._source.moment(frame)
        bag.write(moment.t_s, moment_messages(bag.types, vehicle, moment))
        command = control_of(self._live.agents.requested)
        bag.write(moment.t_s, [command_message(bag.types, vehicle.role, command, moment.t_s)])

    def close(self) -> None:
        """Write the events and the index. A bag that cannot be finished is removed; the run's record is kept."""
        if self._bag is None:
            return
        bag, self._bag = self._bag, None
        try:
            if self._live.metrics.ticks:
                for t_s, message in event_messages(bag.types, self._source.vehicle.role, self._live.metrics.history()):
                    bag.write(t_s, [message])
            bag.close()
        except UserError as error:
            bag.abandon()
            sys.stderr.write(f"basu: warning: {error}; the run has no bag\n")
            return
        self._say(f"ROS bag           {self._path.name} in the result folder ({bag.messages} messages)")
