"""The vehicles under test of a run, each with its agent, its sensors and its role."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from basu.conditions import ROLE
from basu.output.report.shuttles import folder_of

if TYPE_CHECKING:
    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.agents.sensor_file import SensorSpec
    from basu.managers.agents_manager import AgentsManager


class SensorSet(NamedTuple):
    """The sensors of a run, and their origin in words."""

    specs: tuple[SensorSpec, ...]
    source: str


class Shuttle(NamedTuple):
    """One vehicle under test, with the agent that drives it."""

    typed: str  # the agent as the user named it
    loaded: FoundAgent
    agents: AgentsManager  # with an agent for one drive
    sensors: SensorSet
    number: int = 1  # in the run; the first has the whole route
    role: str = ROLE
    start_m: float = 0.0  # along the route, where its own begins

    @property
    def folder(self) -> str:
        """The name of the folder of its record below the run's; empty for the first, which has the run's own."""
        return folder_of(self.number)


def beside(first: AgentConfig, own: AgentConfig) -> AgentConfig:
    """Return the configuration of a further shuttle: conditions and vehicle of the first, sensors and track its own."""
    return replace(first, sensors=own.sensors, track=own.track)
