"""`BasuAgent`: runs a BASU agent in the CARLA leaderboard or ScenarioRunner; pass this file as ``--agent``.

Which agent it is stands in the file of ``--agent-config`` (leaderboard) or ``--agentConfig`` (ScenarioRunner):
``{"agent": "basic"}``, and see :class:`basu_leaderboard.exported_agent.ExportConfig`. ScenarioRunner finds the
class by this file's name, the leaderboard by ``get_entry_point``.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING, Any

from basu_leaderboard.exported_agent import ExportedAgent, read_config

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import carla

LEADERBOARD, SCENARIO_RUNNER = "leaderboard.autoagents.autonomous_agent", "srunner.autoagents.autonomous_agent"
# a host that loads this file has loaded its own base class before
HOST: Any = importlib.import_module(LEADERBOARD if LEADERBOARD in sys.modules else SCENARIO_RUNNER)


def get_entry_point() -> str:
    """The name of the class below."""
    return "BasuAgent"


class BasuAgent(HOST.AutonomousAgent):  # type: ignore[misc]  # the base is found at run time
    """One of theirs, with one of BASU's inside."""

    _plan: Sequence[tuple[carla.Transform, Any]] = ()
    _exported: ExportedAgent | None = None
    _address = ("127.0.0.1", 2000)

    def __init__(self, *arguments: Any) -> None:  # noqa: ANN401 - a path, or host, port and debug
        if len(arguments) > 1:
            self._address = (str(arguments[0]), int(arguments[1]))
        super().__init__(*arguments)

    def setup(self, path_to_conf_file: str) -> None:
        """Make the agent that the file names."""
        config = read_config(path_to_conf_file)
        self._exported = ExportedAgent(config)
        if hasattr(HOST, "Track"):
            self.track = HOST.Track(config.track)

    def sensors(self) -> list[dict[str, Any]]:
        """The agent's sensors in the host's fields."""
        assert self._exported is not None  # setup came first
        return self._exported.sensors()

    def set_global_plan(
        self, global_plan_gps: Sequence[tuple[Any, Any]], global_plan_world_coord: Sequence[tuple[Any, Any]]
    ) -> None:
        """Keep the whole plan; the host's base class thins it."""
        super().set_global_plan(global_plan_gps, global_plan_world_coord)
        self._plan = global_plan_world_coord

    def run_step(self, input_data: Mapping[str, tuple[int, Any]], timestamp: float) -> carla.VehicleControl:
        """One step of the agent; before the first one it is bound to the host's world."""
        assert self._exported is not None  # setup came first
        if not self._exported.bound:
            self._exported.bind(self._plan, self._address)
        return self._exported.step(input_data, timestamp)

    def destroy(self) -> None:
        """Let the agent put its things away."""
        if self._exported is not None:
            self._exported.close()
