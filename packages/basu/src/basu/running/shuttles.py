"""The vehicles under test of a run, each with its agent, its sensors and its role."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, Protocol

from basu.conditions import ROLE
from basu.output.report.shuttles import folder_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    import carla

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.agents.sensor_file import SensorSpec
    from basu.managers import Live
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.base_manager import BaseManager


class SensorSet(NamedTuple):
    """The sensors of a run, and their origin in words."""

    specs: tuple[SensorSpec, ...]
    source: str


class Operator(Protocol):
    """The operation of one vehicle beside its agent, such as its doors, which a plugin brings."""

    def managers(self, live: Live) -> Sequence[BaseManager]:
        """Return managers that observe the vehicle's drive."""

    def interlock(self, control: carla.VehicleControl) -> carla.VehicleControl:
        """Return the control that the vehicle is given in place of the agent's."""


class Shuttle(NamedTuple):
    """One vehicle under test, with the agent that drives it."""

    typed: str  # the agent as the user named it
    loaded: FoundAgent
    agents: AgentsManager  # with an agent for one drive
    sensors: SensorSet
    number: int = 1  # in the run; the first has the whole route
    role: str = ROLE
    start_m: float = 0.0  # along the route, where its own begins
    operator: Operator | None = None  # None: the agent alone operates it

    @property
    def folder(self) -> str:
        """The name of the folder of its record below the run's; empty for the first, which has the run's own."""
        return folder_of(self.number)


def beside(first: AgentConfig, own: AgentConfig) -> AgentConfig:
    """Return the configuration of a further shuttle: conditions and vehicle of the first, sensors and track its own."""
    return replace(first, sensors=own.sensors, track=own.track)
