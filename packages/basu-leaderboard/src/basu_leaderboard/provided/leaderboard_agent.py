"""The base class of agents for the CARLA leaderboard, and its tracks: ``leaderboard.autoagents.autonomous_agent``."""

from __future__ import annotations

import enum

from basu_leaderboard.provided.planned_agent import PlannedAgent


class Track(enum.Enum):
    """What an agent says it takes part in; ``--leaderboard-track`` of ``basu run`` must be the same."""

    SENSORS = "SENSORS"
    MAP = "MAP"
    SENSORS_QUALIFIER = "SENSORS_QUALIFIER"
    MAP_QUALIFIER = "MAP_QUALIFIER"


class AutonomousAgent(PlannedAgent):
    """An agent of the leaderboard 2.x: it is made, gets its plan, is set up, names its sensors, then steps."""

    PLAN_SPACING_M = 200.0

    def __init__(self, carla_host: str, carla_port: int, debug: bool = False) -> None:  # noqa: FBT001, FBT002 - theirs
        del carla_host, carla_port, debug  # for agents that connect by themselves
        self.track = Track.SENSORS

    @staticmethod
    def get_ros_version() -> int:
        """Which ROS an agent is for: none."""
        return -1
