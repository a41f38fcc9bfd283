"""The base class of agents for ScenarioRunner: ``srunner.autoagents.autonomous_agent``."""

from __future__ import annotations

from basu_leaderboard.provided.planned_agent import PlannedAgent


class AutonomousAgent(PlannedAgent):
    """An agent of ScenarioRunner, which is set up while it is made, and given its plan afterwards."""

    PLAN_SPACING_M = 1.0

    def __init__(self, path_to_conf_file: str) -> None:
        self.setup(path_to_conf_file)
