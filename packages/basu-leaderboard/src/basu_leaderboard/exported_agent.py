"""`ExportedAgent`: a BASU agent for a foreign host; reads a config file, binds to the host's world, steps on arrays."""

from __future__ import annotations

import difflib
import importlib
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.agents.autonomous_agent import parse_config
from basu.agents.loader import load_agent
from basu.agents.sensor_file import SensorSpec, parse_sensors, read_sensors
from basu.conditions import STEP_S
from basu.errors import UserError
from basu.files import find, read_json
from basu.routing import plan
from basu.routing.route_file import RouteDescription, RoutePoint
from basu_leaderboard.adapted_agent import LeaderboardAgent
from basu_leaderboard.measurements import as_measurement
from basu_leaderboard.sensor_sets import theirs

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import carla

    from basu.routing import Route


POINT_EVERY_M = 10.0  # of the host's plan, which has one a metre; joined along the lanes again
HERO = "hero"


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportConfig:
    """What the host's agent config may say."""

    agent: str = "basic"  # a name of BASU's, FILE.py, or FILE.py:Class
    sensors: str | None = None  # a sensor file; None: as the agent says
    track: str = "SENSORS"  # of the leaderboard; the evaluator's --track must be the same


def read_config(name: str) -> ExportConfig:
    """Read the file, ``{"agent": "basic"}``; without a file every default.

    Raises:
        UserError: it cannot be read, or says something that means nothing.
    """
    if not name:
        return ExportConfig()
    path = Path(name)
    document = read_json(path, "agent config")
    if not isinstance(document, dict):
        raise UserError(f'agent config {path} must hold an object, such as {{"agent": "basic"}}')
    known = [field.name for field in fields(ExportConfig)]
    for key, value in document.items():
        if key not in known:
            close = difflib.get_close_matches(key, known, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(known)}"
            raise UserError(f"agent config {path} has the key '{key}', which means nothing here; {hint}")
        if not isinstance(value, str) or not value:
            raise UserError(f"agent config {path}: '{key}' is {value!r}; it must be a text")
    return ExportConfig(**document)


class ExportedAgent:
    """The life of it: ``sensors``, ``bind``, ``step`` each tick, ``close``."""

    def __init__(self, config: ExportConfig) -> None:
        self._loaded = load_agent(config.agent)
        if issubclass(self._loaded.agent_class, LeaderboardAgent):
            raise UserError(f"the agent '{config.agent}' is one of the leaderboard's already; give it as --agent")
        self._agent = self._loaded.agent_class()
        self._wishes = parse_config(self._agent.config(), self._loaded.name)
        self._entries, self._specs = theirs(self._sensor_set(config))
        self.bound = False

    def sensors(self) -> list[dict[str, Any]]:
        """The sensor set in the host's fields."""
        return self._entries

    def bind(self, dense: Sequence[tuple[carla.Transform, Any]], address: tuple[str, int]) -> None:
        """Hand the agent the host's world, and the host's plan as a route.

        Raises:
            UserError: there is no vehicle to drive, or no way along the lanes follows the plan.
        """
        provider = importlib.import_module("srunner.scenariomanager.carla_data_provider").CarlaDataProvider
        world, carla_map = provider.get_world(), provider.get_map()
        vehicle = provider.get_hero_actor()
        if vehicle is None:
            raise UserError(f"the host has no vehicle with the role '{HERO}' in its world")
        self._agent.bind(
            client=provider.get_client(),
            world=world,
            map=carla_map,
            vehicle=vehicle,
            route=route_along(dense, carla_map),
            config_values=asdict(self._wishes),
            time_step_s=world.get_settings().fixed_delta_seconds or STEP_S,
            server_address=address,
        )
        self.bound = True
        self._agent.setup()

    def step(self, input_data: Mapping[str, tuple[int, Any]], timestamp_s: float) -> carla.VehicleControl:
        """One step of the agent's."""
        seen = {
            name: (frame, as_measurement(self._specs[name], frame, timestamp_s, data))
            for name, (frame, data) in input_data.items()
            if name in self._specs
        }
        return self._agent.run_step(seen)

    def close(self) -> None:
        """Let the agent put its things away, where it was bound."""
        if self.bound:
            self.bound = False
            self._agent.destroy()

    def _sensor_set(self, config: ExportConfig) -> tuple[SensorSpec, ...]:
        """The sensors: the config's, else the agent's own, else the file that the agent names."""
        own = self._agent.sensors() if config.sensors is None else None
        if own is not None:
            return parse_sensors(own, f"sensors() of {self._loaded.name}")
        name = config.sensors or self._wishes.sensors
        return () if name is None else read_sensors(find(name, "sensor file", self._loaded.file))


def route_along(dense: Sequence[tuple[carla.Transform, Any]], carla_map: carla.Map) -> Route:
    """The host's plan joined along the lanes, with limits and signs.

    Raises:
        UserError: it changes lanes, which BASU's agents do not, or leaves the road.
    """
    if len(dense) < 2:
        raise UserError("the host gave no plan; BASU's agents follow a route")
    kept = [dense[0][0]]
    for pose, _ in dense[1:-1]:
        if pose.location.distance(kept[-1].location) >= POINT_EVERY_M:
            kept.append(pose)
    points = tuple(_point(pose) for pose in (*kept, dense[-1][0]))
    description = RouteDescription(
        id="plan", town=carla_map.name.rpartition("/")[2], points=points, stops=(), source="the host's plan"
    )
    return plan(carla_map, description)


def _point(pose: carla.Transform) -> RoutePoint:
    at = pose.location
    return RoutePoint(at.x, at.y, at.z, math.radians(pose.rotation.yaw))
