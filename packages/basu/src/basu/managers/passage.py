"""`Passage`: one agent's way to the simulator, through a gate or without one, and what its track lets it see of others.

The gate holds each frame of the track ``objects`` until it knows which actors the agent sees in it. The benchmark says
so, by the line-of-sight filter of the built-in agents (:mod:`basu.agents.sight`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from basu.agents.loader import LoadedAgent
from basu.agents.process.remote_agent import RemoteAgent
from basu.agents.sight import Sight
from basu.conditions import OBJECTS, SENSORS, WORLD

if TYPE_CHECKING:
    from collections.abc import Sequence

    import carla

    from basu.agents.calls import AgentCalls
    from basu.agents.process.gate import Gate
    from basu.agents.process.remote_agent import FoundAgent
    from basu.agents.sensor_streams import SpawnedSensor
    from basu.managers.base_manager import Frame, Run
    from basu.routing import Route

UNNAMED = "route"  # what a route is called where its name is hidden
MAP_ACTORS = "traffic.*"  # lights and signs: the map tells of them as well


class Passage:
    """Opens the gate at the agent's setup and closes it at its end."""

    def __init__(self, agent: AgentCalls | RemoteAgent, loaded: FoundAgent, *, is_open: bool) -> None:
        """``is_open``: the agent's process connects to the simulator itself."""
        self._process = agent.process_id if isinstance(agent, RemoteAgent) else None
        self._is_remote = isinstance(agent, RemoteAgent)
        # an agent of BASU's own in this process passes no gate, and is trusted
        self._is_open = is_open if self._is_remote else isinstance(loaded, LoadedAgent) and loaded.file is not None
        self._gate: Gate | None = None
        self._sight: Sight | None = None
        self.refused: dict[str, int] = {}

    def open(self, run: Run, track: str) -> tuple[str, int]:
        """Open the gate, and return the address that the agent's client connects to.

        Raises:
            SimulatorError: the gate has ended.
        """
        if not self._is_remote or self._is_open or run.gates is None:
            self._is_open = self._is_open or self._is_remote
            return run.server_address
        known: list[int] = []
        if track == OBJECTS:
            known = [actor.id for actor in run.world.get_actors().filter(MAP_ACTORS)]
            self._sight = Sight(run.world, run.vehicle)
        self._gate = run.gates.open(track, run.vehicle.id, known, self._process)
        self._see(run.world.get_snapshot())
        return self._gate.address

    def told(self, route: Route, config_values: dict[str, Any]) -> dict[str, Any]:
        """What an agent learns of its route and configuration; outside of the track ``world`` no name of either.

        The name of a case says which conflict comes, and so may the file of a route.
        """
        if self._is_remote and not self._is_open and config_values["track"] != WORLD:
            route, config_values = replace(route, id=UNNAMED), {**config_values, "routes": "", "sumo": None}
        return {"route": route, "config_values": config_values}

    def add_sensors(self, sensors: Sequence[SpawnedSensor]) -> None:
        """Let the agent's client hear its sensors.

        Raises:
            SimulatorError: the gate has ended.
        """
        if self._gate is not None:
            self._gate.add_sensors(sensor.actor_id for sensor in sensors)

    def see(self, frame: Frame) -> None:
        """Say which actors the agent sees in a frame.

        Raises:
            SimulatorError: the gate has ended.
        """
        if self._sight is not None:
            self._see(frame.snapshot)

    def close(self) -> None:
        """Close the gate, and take down what it refused."""
        if self._gate is not None:
            self.refused = self._gate.close()
            self._gate = self._sight = None

    def document(self, track: str) -> dict[str, Any]:
        """Return the agent's track, whether it was open, and what was refused, as documents have it.

        An agent of BASU's own in this process reads the world through its own filter: so it is never of the track
        ``sensors``.
        """
        is_open = self._is_open or (track == SENSORS and not self._is_remote)
        return {"track": track, "open": is_open, "refused": dict(sorted(self.refused.items()))}

    def _see(self, snapshot: carla.WorldSnapshot) -> None:
        if self._gate is not None and self._sight is not None:
            seen = self._sight.others(snapshot)
            self._gate.see(snapshot.frame, [other.id for other in seen if not other.unseen_s])
