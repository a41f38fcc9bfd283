"""The agent's process: loads the agent, connects a client of its own, and answers the benchmark's calls."""

from __future__ import annotations

import io
import os
import random
import sys
import threading
import time
import traceback
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

from basu.agents.calls import AgentCalls
from basu.agents.loader import load_agent
from basu.agents.process.channel import AgentsEnd, ChannelClosedError
from basu.agents.sensor_streams import SensorSilentError, SensorStreams
from basu.errors import (
    AgentCrashedError,
    AgentInvalidControlError,
    AgentTimedOutError,
    BasuError,
    SimulatorError,
    UserError,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.agents.loader import LoadedAgent
    from basu.agents.sensor_streams import SpawnedSensor
    from basu.routing import Route

NAP_S = 0.0001  # between two looks for a snapshot that is under way
KINDS: dict[type[BaseException], str] = {
    AgentCrashedError: "crashed",
    AgentTimedOutError: "timed out",
    AgentInvalidControlError: "invalid control",
    UserError: "user",
}
"""The kinds of failure that the benchmark's side tells apart. All are the agent's failures there."""


class Wanted(NamedTuple):
    """Which agent, and for which run."""

    agent: str  # as it was typed
    agent_config: str | None
    seed: int
    step_limit_s: float


class DriveBinding(NamedTuple):
    """Where the agent drives: everything that ``bind`` needs and that can be sent."""

    address: tuple[str, int]
    timeout_s: float
    frame: int  # that the world has reached
    map_key: str  # equal for equal maps
    vehicle_id: int
    route: Route | None  # without way points
    places_m: Sequence[float]  # of the way points, along their roads
    config_values: dict[str, Any]
    time_step_s: float


class Child:
    """Holds one agent at a time; each public method is an operation that the benchmark may call by its name."""

    def __init__(self, begin: Callable[[], None]) -> None:
        """``begin`` says that the agent's part of a call begins now, and with it its time limit."""
        self._begin = begin
        self._loaded: tuple[tuple[str, str | None], LoadedAgent] | None = None
        self._calls: AgentCalls | None = None
        self._address: tuple[str, int] | None = None
        self._maps: dict[str, carla.Map] = {}
        self._world: Any = None
        self._timeout_s = 0.0
        self._streams = SensorStreams(0.0)
        self._threads = threading.active_count()

    def load(self, wanted: tuple[str, str | None]) -> dict[str, Any]:
        """Load an agent's class; its name, and whether a person drives it."""
        self._begin()
        loaded = load_agent(*wanted)
        self._loaded = (wanted, loaded)
        return {"class_name": loaded.class_name, "is_human": loaded.is_human, "name": loaded.name}

    def make(self, wanted: Wanted) -> dict[str, Any]:
        """Make a new agent from a freshly loaded file, with everything random begun anew; its config and name."""
        self._begin()
        self._calls = None
        self._seed(wanted.seed)
        key = (wanted.agent, wanted.agent_config)
        if self._loaded is None or self._loaded[0] != key:
            try:
                self._loaded = (key, load_agent(*key))
            except UserError as error:  # it did load when the command began
                raise AgentCrashedError(str(error)) from error
        loaded = self._loaded[1]
        if loaded.file is not None:
            self._loaded = None  # the next agent's module begins anew: no run depends on those before it
        self._seed(wanted.seed)
        self._calls = AgentCalls(
            loaded.agent_class, wanted.step_limit_s, is_ours=loaded.file is None, failures=(BaseException,)
        )
        config = self._calls.config()
        return {
            "name": self._calls.name,
            "config": asdict(config),
            "late": bool(self._calls.gives_sensors_late),
            "manual": self._calls.manual,
        }

    def own_route(self, _: None) -> list[Any] | None:
        """The agent's own plan."""
        self._begin()
        points = self._agent.own_route()
        return None if points is None else [[point.x_m, point.y_m, point.z_m, point.yaw_rad] for point in points]

    def sensor_set(self, _: None) -> list[Any] | None:
        """The agent's own sensors."""
        self._begin()
        specs = self._agent.sensor_set()
        return None if specs is None else [asdict(spec) for spec in specs]

    def setup(self, place: DriveBinding) -> bool:
        """Bind the agent to its run and let it get ready; whether it says that a person drives."""
        client = self._connected(place)
        world = self._arrived(client, place)
        if place.map_key not in self._maps:
            self._maps[place.map_key] = world.get_map()
        carla_map = self._maps[place.map_key]
        vehicle = world.get_actor(place.vehicle_id)
        if vehicle is None:
            raise SimulatorError(f"the agent's client does not find the vehicle {place.vehicle_id}")
        self._world, self._timeout_s = world, place.timeout_s
        self._streams = SensorStreams(place.timeout_s)
        binding = {
            "client": client,
            "world": world,
            "map": carla_map,
            "vehicle": vehicle,
            "route": None if place.route is None else _with_waypoints(place.route, place.places_m, carla_map),
            "config_values": place.config_values,
            "time_step_s": place.time_step_s,
            "server_address": place.address,
        }
        self._begin()
        self._agent.setup(binding, place.timeout_s)
        return self._agent.manual

    def open_sensor_streams(self, sensors: Sequence[SpawnedSensor]) -> None:
        """Listen to the agent's sensors."""
        self._agent.name_sensors(sensors)
        for sensor in sensors:
            actor = self._world.get_actor(sensor.actor_id)
            try:
                self._streams.listen(sensor, actor)
            except (RuntimeError, AttributeError) as error:
                raise UserError(f"sensor '{sensor.id}' cannot be served by this simulator: {error}") from error

    def close_sensor_streams(self, _: None) -> None:
        """Stop listening, while the sensors are still there."""
        self._streams.stop()

    def step(self, frame: int) -> list[Any]:
        """The control for a frame, once its snapshot and all measurements are here; and whether a person drives."""
        self._wait_for(self._world, frame, self._timeout_s)
        try:
            data = self._streams.wait(frame)
        except SensorSilentError as error:
            raise SimulatorError(str(error)) from error
        self._begin()
        control = self._agent.step(frame, data)
        values = (control.throttle, control.steer, control.brake)
        flags = (control.hand_brake, control.reverse, control.manual_gear_shift)
        return [*values, *flags, control.gear, self._agent.manual]

    def destroy(self, _: None) -> bool:
        """Let the agent put its things away; whether another agent may live here afterwards."""
        self._streams.stop()
        self._begin()
        try:
            self._agent.destroy()
        finally:
            self._calls = None
            self._streams = SensorStreams(0.0)
        return threading.active_count() <= self._threads

    @property
    def _agent(self) -> AgentCalls:
        assert self._calls is not None, "an agent is made before its methods are called"
        return self._calls

    def _seed(self, seed: int) -> None:
        random.seed(seed)
        np.random.seed(seed)  # noqa: NPY002 - for agents that use numpy's old generator; ours use neither

    def _connected(self, place: DriveBinding) -> carla.Client:
        """A new client, for each run: one that another client's reload found connected keeps the actors of before."""
        if self._address != place.address:
            self._address = place.address
            self._maps.clear()
        client = carla.Client(*place.address)
        client.set_files_base_folder(os.environ.get("BASU_AGENT_FOLDER", ""))  # its cache of maps' files
        client.set_timeout(place.timeout_s)
        return client

    def _arrived(self, client: carla.Client, place: DriveBinding) -> carla.World:
        """The world, once this client has seen what the benchmark's has seen: an episode may have begun anew."""
        self._wait_for(client.get_world(), place.frame, place.timeout_s)
        return client.get_world()

    def _wait_for(self, world: carla.World, frame: int, timeout_s: float) -> None:
        """Wait until this client has the snapshot of a frame.

        Raises:
            SimulatorError: it does not come.
        """
        deadline_s = None
        while world.get_snapshot().frame < frame:
            now_s = time.monotonic()
            if deadline_s is None:
                deadline_s = now_s + timeout_s
            elif now_s > deadline_s:
                raise SimulatorError(f"the simulator did not send frame {frame} to the agent's client in time")
            time.sleep(NAP_S)


def _with_waypoints(route: Route, places_m: Sequence[float], carla_map: carla.Map) -> Route:
    """A route with its way points on this process's map."""
    triples = zip(route.road_id.tolist(), route.lane_id.tolist(), places_m, strict=True)
    return replace(route, waypoints=tuple(carla_map.get_waypoint_xodr(*triple) for triple in triples))


def serve(descriptor: int, confinement: Sequence[str]) -> None:
    """Serve the benchmark at the other end of a socket; the first message says what confines this process."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(line_buffering=True)  # what an agent said before it was killed is seen
    end = AgentsEnd(descriptor)
    end.send([0, list(confinement)])
    number = 0
    child = Child(lambda: end.send([number, "begun"]))
    while True:
        try:
            number, operation, argument = end.receive()
        except ChannelClosedError:
            return
        end.send([number, *_answer(child, operation, argument)])


def _answer(child: Child, operation: str, argument: Any) -> list[Any]:  # noqa: ANN401 - as the operation has it
    """What comes of an operation; an error by its kind."""
    try:
        return ["done", getattr(child, operation)(argument)]
    except BaseException as error:  # noqa: BLE001 - KeyboardInterrupt as well: nothing but the agent raises it here
        trace = traceback.format_exc()
        for error_class, kind in KINDS.items():
            if isinstance(error, error_class):
                return ["failed", kind, str(error), trace]
        text = str(error) if isinstance(error, BasuError) else f"{type(error).__name__}: {error}"
        return ["failed", "other", text, trace]
