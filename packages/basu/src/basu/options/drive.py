"""The options of every drive, on a route or in a case: agent, conditions, simulator, records, window."""

from __future__ import annotations

from dataclasses import dataclass

from basu.conditions import SimulatorSpec
from basu.options.agent import AgentOptions
from basu.options.folders import RecordOptions
from basu.options.simulator import SimulatorOptions
from basu.options.sumo import SumoOptions
from basu.options.window import WindowOptions


@dataclass(frozen=True, kw_only=True)
class DriveOptions(WindowOptions, RecordOptions, SimulatorOptions, SumoOptions, AgentOptions):
    """The options that runs and cases share; the fields stand in the order of the bases, the last one first."""

    @property
    def simulator(self) -> SimulatorSpec:
        """The simulator to drive in."""
        return SimulatorSpec(
            host=self.host,
            port=self.port,
            timeout_s=self.timeout_s,
            maps=self.maps,
            upload_map=self.upload_map,
            recordings=self.output if self.record else None,
            is_open=self.open,
        )

    @property
    def is_ros(self) -> bool:
        """Whether the drive is published on ROS or written as a bag."""
        return self.ros2 or self.ros1 or self.rosbag is not None

    @property
    def shows_sensors(self) -> bool:
        """Whether a page, a bag or a topic shows what the agent's sensors measure."""
        return self.watch or self.is_ros

    @property
    def needs_one_simulator(self) -> bool:
        """Whether drives cannot be driven at the same time: they share a simulator, a page, keys or topics."""
        live = self.watch or self.ros2 or self.ros1
        return live or self.host is not None or self.keys is not None or self.record_keys is not None
