"""The options of ``basu run``: all groups in one model."""

from __future__ import annotations

from dataclasses import dataclass

from basu.options.agent import AgentOptions
from basu.options.folders import FolderOptions
from basu.options.routes import RouteOptions
from basu.options.simulator import SimulatorOptions
from basu.options.sumo import SumoOptions
from basu.options.window import WindowOptions


@dataclass(frozen=True, kw_only=True)
class RunOptions(WindowOptions, FolderOptions, SimulatorOptions, SumoOptions, RouteOptions, AgentOptions):
    """The options of ``basu run`` without the scoring, which is a model of its own.

    Python collects the fields of a dataclass from the last base to the first: the help page begins with the agent.
    """
