"""What the base classes of agents for the leaderboard and for ScenarioRunner share: their plan, and doing nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import carla

from basu.agents.leaderboard.provided.route_manipulation import downsample_route

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


class PlannedAgent:
    """An agent that is given a plan, asked for its sensors, then stepped.

    The thinned plan lies in ``_global_plan`` (dicts of lat, lon in degrees and z in m) and ``_global_plan_world_coord``
    (transforms), each entry with its ``RoadOption``; the names are those that agents read.
    """

    PLAN_SPACING_M: ClassVar[float]  # of the plan that an agent is left with, where the option stays the same

    _global_plan: list[tuple[Mapping[str, float], Any]] | None = None
    _global_plan_world_coord: list[tuple[carla.Transform, Any]] | None = None

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
        kept = downsample_route(global_plan_world_coord, self.PLAN_SPACING_M)
        self._global_plan_world_coord = [global_plan_world_coord[index] for index in kept]
        self._global_plan = [global_plan_gps[index] for index in kept]
