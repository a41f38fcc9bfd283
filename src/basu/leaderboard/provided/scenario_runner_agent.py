"""The base class of agents for ScenarioRunner: ``srunner.autoagents.autonomous_agent``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import carla

from basu.leaderboard.provided.route_manipulation import downsample_route

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

PLAN_SPACING_M = 1.0  # of the plan that an agent is left with


class AutonomousAgent:
    """An agent of ScenarioRunner, which is set up while it is made, and given its plan afterwards.

    ``_global_plan`` and ``_global_plan_world_coord`` are as in the leaderboard's base class.
    """

    def __init__(self, path_to_conf_file: str) -> None:
        self._global_plan: list[tuple[Mapping[str, float], Any]] | None = None
        self._global_plan_world_coord: list[tuple[carla.Transform, Any]] | None = None
        self.setup(path_to_conf_file)

    def setup(self, path_to_conf_file: str) -> None:
        """Get ready; the file is that of ``--agent-config``, the empty text where there is none."""

    def sensors(self) -> Sequence[Mapping[str, Any]]:
        """Say which sensors are wanted: none."""
        return []

    def run_step(self, input_data: Mapping[str, tuple[int, Any]], timestamp: float) -> carla.VehicleControl:
        """Answer a step: neither throttle nor brake."""
        del input_data, timestamp
        return carla.VehicleControl()

    def destroy(self) -> None:
        """Put away what ``setup`` took."""

    def set_global_plan(
        self,
        global_plan_gps: Sequence[tuple[Mapping[str, float], Any]],
        global_plan_world_coord: Sequence[tuple[carla.Transform, Any]],
    ) -> None:
        """Keep the plan, thinned."""
        kept = downsample_route(global_plan_world_coord, PLAN_SPACING_M)
        self._global_plan_world_coord = [global_plan_world_coord[index] for index in kept]
        self._global_plan = [global_plan_gps[index] for index in kept]
