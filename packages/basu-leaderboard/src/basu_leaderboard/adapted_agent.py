"""Drives an agent of the leaderboard or of ScenarioRunner as one of BASU's: the same calls, in the same order."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, Any, ClassVar

import carla

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.sensor_streams import as_array
from basu_leaderboard.foreign_class import Dialect, ForeignAgent
from basu_leaderboard.global_plan import Gps, global_plan
from basu_leaderboard.provided.carla_data_provider import CarlaDataProvider, GameTime
from basu_leaderboard.sensor_sets import SPEEDOMETER, translated
from basu_leaderboard.tracks import check_declared

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


VEHICLE = "vehicle.lincoln.mkz_2020"  # the leaderboard's


class LeaderboardAgent(AutonomousAgent):
    """One of theirs; :func:`adapted` makes the class for a given one."""

    foreign: ClassVar[ForeignAgent]
    conf_file: ClassVar[str]  # the text of --agent-config, "" without
    gives_sensors_late = True  # an agent may say what it wants to see only once it is set up, in its world

    _agent: Any = None
    _gps: Gps
    _providers_of_run: RunProviders | None = None
    _pseudo: Mapping[str, str]
    _opendrive: str

    def config(self) -> dict[str, str]:
        """The leaderboard's car; the route is the user's to choose."""
        return {"vehicle": VEHICLE}

    def setup(self) -> None:
        """Make the agent, and give it its plan and its file, in the order that it is used to."""
        assert self.route is not None  # a run of BASU's has one
        self._gps = Gps(self.map)
        plan = global_plan(self.route, self._gps)
        self._providers_of_run = RunProviders(self.client, self.world, self.vehicle, plan.world)
        agent_class, dialect = self.foreign
        if dialect is Dialect.LEADERBOARD_2:
            self._agent = agent_class(*self.server_address, 0)
            self._agent.set_global_plan(plan.gps, plan.world)
            self._agent.setup(self.conf_file)
        else:
            self._agent = agent_class(self.conf_file)
            self._agent.set_global_plan(plan.gps, plan.world)

    def sensors(self) -> list[Any]:
        """What the agent wants to see; what is answered here only for the rules of a track, which count it."""
        given, source = self._agent.sensors(), f"sensors() of {self.foreign.agent_class.__name__}"
        entries, self._pseudo = translated(given, self.foreign.dialect, source)
        self._opendrive = self.map.to_opendrive()
        if (track := self.config_values.get("leaderboard_track")) is None:
            return entries
        check_declared(getattr(self._agent, "track", None), track, self.foreign.agent_class.__name__)
        return [*entries, *({"id": name, "type": kind} for name, kind in self._pseudo.items())]

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Call the agent's ``run_step`` with measurements in the leaderboard's form, and return its control."""
        assert self._providers_of_run is not None  # setup came first
        snapshot = self.world.get_snapshot()
        timestamp_s = self._providers_of_run.tick(snapshot.timestamp)
        input_data = {name: (frame, self._measured(measured)) for name, (frame, measured) in sensor_data.items()}
        input_data |= {name: (snapshot.frame, self._answer(kind)) for name, kind in self._pseudo.items()}
        control = self._agent.run_step(input_data, timestamp_s)
        if isinstance(control, carla.VehicleControl):
            control.manual_gear_shift = False  # as the leaderboard's agents do in __call__
        return control

    def destroy(self) -> None:
        """Let the agent put its things away, and take the world from it."""
        agent, self._agent = self._agent, None
        try:
            if agent is not None:
                agent.destroy()
        finally:
            if self._providers_of_run is not None:
                self._providers_of_run.close()

    def _measured(self, measured: Any) -> Any:  # noqa: ANN401 - by its sensor
        """A measurement as the leaderboard gives it, positions in its degrees."""
        array = as_array(measured)
        return self._gps.measured(array) if isinstance(measured, carla.GnssMeasurement) else array

    def _answer(self, kind: str) -> dict[str, Any]:
        """What a sensor of the leaderboard's own measures: the speed ahead in m/s, or the map's text."""
        if kind != SPEEDOMETER:
            return {"opendrive": self._opendrive}
        velocity, turned = self.vehicle.get_velocity(), self.vehicle.get_transform().rotation
        pitch, yaw = math.radians(turned.pitch), math.radians(turned.yaw)
        level = math.cos(pitch)
        return {
            "speed": (velocity.x * math.cos(yaw) + velocity.y * math.sin(yaw)) * level + velocity.z * math.sin(pitch)
        }


def adapted(foreign: ForeignAgent, conf_file: str | None) -> type[LeaderboardAgent]:
    """A class of BASU's for one of theirs, called as theirs is."""
    members = {
        "foreign": foreign,
        "conf_file": conf_file or "",
        "__doc__": foreign.agent_class.__doc__,
        "__module__": __name__,
    }
    return type(foreign.agent_class.__name__, (LeaderboardAgent,), members)


class RunProviders:
    """The providers of one run. An agent may import ScenarioRunner's modules late, so each step checks."""

    def __init__(self, client: carla.Client, world: carla.World, vehicle: carla.Vehicle, ego_route: Any) -> None:  # noqa: ANN401 - a list of (transform, option)
        self._client, self._world, self._vehicle, self._ego_route = client, world, vehicle, ego_route
        self._providers: list[Any] = []
        self._clocks: list[Any] = []
        self._begin()

    def tick(self, timestamp: carla.Timestamp) -> float:
        """Go on to a step of the simulator; the time in s since the run began, one step at the first."""
        self._begin()
        for provider in self._providers:
            provider.on_carla_tick()
        for clock in self._clocks:
            clock.on_carla_tick(timestamp)
        time_s: float = GameTime.get_time()
        return time_s

    def close(self) -> None:
        """Take the run away; what an agent spawned through ScenarioRunner's provider goes too, the vehicle does not."""
        for provider in self._providers:
            _pool(provider).pop(self._vehicle.id, None)
            provider.cleanup()
        for clock in self._clocks:
            clock.restart()
        self._providers, self._clocks = [], []

    def _begin(self) -> None:
        """Hand the run to each provider that has not got it yet."""
        for provider in _loaded(CarlaDataProvider, "srunner.scenariomanager.carla_data_provider"):
            if provider not in self._providers:
                self._providers.append(provider)
                provider.set_client(self._client)
                provider.set_world(self._world)
                provider.register_actor(self._vehicle)
                provider.set_ego_route(self._ego_route)
                _pool(provider)[self._vehicle.id] = self._vehicle
        for clock in _loaded(GameTime, "srunner.scenariomanager.timer"):
            if clock not in self._clocks:
                self._clocks.append(clock)
                clock.restart()


def _loaded(ours: type, module: str) -> Iterator[Any]:
    """Our class, and theirs of the same name where it is loaded and another one."""
    yield ours
    theirs = getattr(sys.modules.get(module), ours.__name__, ours)
    if theirs is not ours:
        yield theirs


def _pool(provider: Any) -> Any:  # noqa: ANN401 - theirs
    """Where ScenarioRunner's provider looks for the hero; the public way into it is to spawn the actor through it."""
    return vars(provider).get("_carla_actor_pool", {})
