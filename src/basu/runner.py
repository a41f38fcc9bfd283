"""``basu run``: an agent, a simulator, one or more routes; each run driven, scored and left in a folder."""

from __future__ import annotations

import contextlib
import random
import sys
import traceback
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.drive import drive
from basu.errors import UserError
from basu.managers.agent_loader import load_agent
from basu.managers.agents_manager import AgentsManager
from basu.managers.base_manager import BaseManager, Live, Run
from basu.managers.sensor_file import read_sensors
from basu.managers.sensors_manager import SensorsManager
from basu.options import STEP_S
from basu.outcome import Status
from basu.progress_bar import ProgressBar
from basu.remains import leave, run_config
from basu.report.folder import make_folder
from basu.routing import lane_graph, plan
from basu.routing.route_file import RouteDescription, read_routes
from basu.simulator import OwnServer, asking, connect, ticked_by_us, weather_called, world_of
from basu.utils.packaged import find
from basu.vehicle import vehicle_at_start

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import carla

    from basu.managers.agent_loader import LoadedAgent
    from basu.managers.sensor_file import SensorSpec
    from basu.metrics.score import Scoring
    from basu.options import RunOptions
    from basu.outcome import Outcome


@dataclass(frozen=True, slots=True)
class Simulator:
    """A simulator that answers."""

    client: carla.Client
    own: bool
    why_gone: Callable[[], str | None]


class SensorSet(NamedTuple):
    """The sensors of a run, and in words who gave them."""

    specs: tuple[SensorSpec, ...]
    source: str


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be run, as far as it can be known without a simulator."""

    loaded: LoadedAgent
    agents: AgentsManager  # for the first run; each further run makes its own
    sensors: SensorSet
    routes: tuple[RouteDescription, ...]


def run(options: RunOptions, scoring: Scoring) -> int:
    """Run everything that was asked for; the exit code is that of the worst outcome.

    Raises:
        UserError, AgentError: nothing can be started like this.
        SimulatorError: there is no simulator to run in.
    """
    prepared = _prepare(options)
    worst = 0
    agents: AgentsManager | None = prepared.agents
    with _simulator(options) as simulator:
        for description in prepared.routes:
            for repetition in range(options.repetitions):
                agents = agents or _new_agents(prepared.loaded, options)
                outcome = _one(options, scoring, prepared, agents, simulator, description, repetition)
                agents = None
                worst = max(worst, outcome.status.fault.value)
                if outcome.status in {Status.INTERRUPTED, Status.SIMULATOR_FAILED}:
                    return worst
    return worst


def _prepare(options: RunOptions) -> Plan:
    """Read everything that can be wrong before anything is started."""
    loaded = load_agent(options.agent)
    agents = _new_agents(loaded, options)
    config = agents.config
    weather_called(config.weather)
    sensors = _sensor_set(agents, loaded)
    if config.sumo is not None:
        print(
            f"basu: warning: {loaded.name} asks for the SUMO network {config.sumo}; co-simulation follows in a later "
            "version, the run goes on without it",
            file=sys.stderr,
        )
    routes = read_routes(find(config.routes, "route file", loaded.file))
    if options.route_id is not None:
        chosen = tuple(route for route in routes if route.id == options.route_id)
        if not chosen:
            ids = ", ".join(route.id for route in routes)
            raise UserError(f"{config.routes} has no route '{options.route_id}'; it has {ids}")
        routes = chosen
    return Plan(loaded, agents, sensors, routes)


def _sensor_set(agents: AgentsManager, loaded: LoadedAgent) -> SensorSet:
    """The sensors that the agent wants, by its own method or by a file."""
    own = agents.own_sensors()
    if own is not None:
        return SensorSet(own, f"sensors() of {loaded.name}")
    if agents.config.sensors is None:
        return SensorSet((), "")
    path = find(agents.config.sensors, "sensor file", loaded.file)
    return SensorSet(read_sensors(path), f"sensor file {path}")


def _new_agents(loaded: LoadedAgent, options: RunOptions) -> AgentsManager:
    """A fresh agent, with everything random in Python begun anew."""
    random.seed(options.seed)
    np.random.seed(options.seed)  # noqa: NPY002 - for agents that use numpy's old generator; ours use neither
    return AgentsManager(loaded, step_limit_s=options.step_limit_s, routes=options.routes)


@contextlib.contextmanager
def _simulator(options: RunOptions) -> Iterator[Simulator]:
    """The simulator at --host, or one of our own that is ended in every case."""
    if options.host is not None:
        client = connect(options.host, options.port, options.timeout_s)
        yield Simulator(client, own=False, why_gone=lambda: _silence(client, options))
        return
    server = OwnServer()
    try:
        yield Simulator(connect("127.0.0.1", server.port, options.timeout_s), own=True, why_gone=server.gone)
    finally:
        server.end()


def _silence(client: carla.Client, options: RunOptions) -> str | None:
    """Ask somebody else's simulator whether it is still there."""
    try:
        client.get_server_version()
    except RuntimeError:
        return f"the simulator at {options.host}:{options.port} does not answer any more"
    return None


def _one(
    options: RunOptions,
    scoring: Scoring,
    prepared: Plan,
    agents: AgentsManager,
    simulator: Simulator,
    description: RouteDescription,
    repetition: int,
) -> Outcome:
    """One run from an empty road to its folder."""
    started = datetime.now(timezone.utc)
    world = _world(simulator, description.town, fresh=repetition > 0)
    carla_map = world.get_map()
    lanes = lane_graph.build(carla_map)
    description = _agents_own(agents, description) or description
    route = plan(carla_map, description, lanes)
    sensors = SensorsManager(*prepared.sensors)
    with (
        asking("getting the vehicle ready"),
        ticked_by_us(world, STEP_S),
        vehicle_at_start(world, route, agents.config.vehicle) as vehicle,
    ):
        world.set_weather(weather_called(agents.config.weather))
        this_run = Run(
            client=simulator.client,
            world=world,
            carla_map=carla_map,
            vehicle=vehicle,
            route=route,
            config=agents.config,
            step_s=STEP_S,
            seed=options.seed,
            timeout_s=options.timeout_s,
        )
        driven = drive(this_run, agents, sensors, scoring, why_gone=simulator.why_gone, observers=_observers)
    if options.debug and driven.agent_error is not None:
        traceback.print_exception(driven.agent_error)
    label = _label(description, prepared)
    config = run_config(options, scoring, prepared.loaded, agents.config, description, simulator.own, started)
    leave(
        make_folder(options.output, started.astimezone(), prepared.loaded.name, label), driven, scoring, lanes, config
    )
    if driven.bug is not None:
        raise driven.bug
    return driven.outcome


def _world(simulator: Simulator, town: str, *, fresh: bool) -> carla.World:
    """The world with ``town`` in it; begun anew between runs in a simulator of our own."""
    with asking(f"loading {town}"):
        if fresh and simulator.own:
            simulator.client.reload_world(reset_settings=False)
        return world_of(simulator.client, town)


def _agents_own(agents: AgentsManager, given: RouteDescription) -> RouteDescription | None:
    """The agent's own plan in the town of the route it was given, where it has one."""
    points = agents.own_route()
    if points is None:
        return None
    return RouteDescription(id=f"{given.id}-own", town=given.town, points=points, stops=(), source=given.source)


def _observers(live: Live) -> list[BaseManager]:
    """Who looks on while a run lasts."""
    return [ProgressBar(live)]


def _label(description: RouteDescription, prepared: Plan) -> str:
    """What a route is called in a folder's name: its file, and its id where the file has several."""
    stem = PurePath(description.source).stem
    return stem if len(prepared.routes) == 1 else f"{stem}-{description.id}"
