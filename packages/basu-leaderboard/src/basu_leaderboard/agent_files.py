"""The plugin: how ``basu`` reads agents' files of the leaderboard and of ScenarioRunner."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_leaderboard.adapted_agent import LeaderboardAgent, adapted
from basu_leaderboard.foreign_class import ENTRY_POINT, foreign_agent
from basu_leaderboard.replacement_modules import install
from basu_leaderboard.tracks import TrackRules

if TYPE_CHECKING:
    from basu.agents.agent_files import AgentFile
    from basu.agents.autonomous_agent import AutonomousAgent
    from basu.conditions import LeaderboardTrack


def prepare() -> None:
    """Let a file import ``leaderboard``, ``srunner`` and ``agents`` where they are not installed."""
    install()


def is_ours(file: AgentFile) -> bool:
    """Return whether a file has the leaderboard's ``get_entry_point``."""
    return ENTRY_POINT in file.namespace


def agent_in(file: AgentFile, agent_config: str | None) -> type[AutonomousAgent] | None:
    """Return the file's agent, adapted to BASU; None where it has none of the leaderboard or of ScenarioRunner.

    Raises:
        UserError: there is one, and it is not as an agent has to be.
    """
    foreign = foreign_agent(file.namespace, file.module_name, file.path, file.class_name)
    return None if foreign is None else adapted(foreign, agent_config)


def takes_config(agent: type[AutonomousAgent]) -> bool:
    """Return whether an agent is an adapted one."""
    return issubclass(agent, LeaderboardAgent)


def sensor_rules(track: LeaderboardTrack) -> TrackRules:
    """Return the rules of a track of the leaderboard."""
    return TrackRules(track)
