"""``basu run``: an agent, a simulator, one or more routes; each run driven, scored and left in a folder."""

from __future__ import annotations

import contextlib
import platform
import random
import sys
import traceback
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

import basu
from basu.drive import drive
from basu.errors import UserError
from basu.history.files import write_history
from basu.managers.agent_loader import load_agent
from basu.managers.agents_manager import AgentsManager
from basu.managers.base_manager import Run
from basu.managers.sensors_manager import SensorsManager
from basu.options import STEP_S
from basu.outcome import Status
from basu.progress_bar import ProgressBar
from basu.report import picture
from basu.report.console import table
from basu.report.folder import CONFIG_FILE, PICTURE_FILE, RESULT_FILE, make_folder, point_latest, write_json
from basu.report.result import result
from basu.routing import lane_graph, plan
from basu.routing.route_file import RouteDescription, read_routes
from basu.simulator import OwnServer, asking, connect, ticked_by_us, weather_called, world_of
from basu.utils.packaged import find
from basu.vehicle import vehicle_at_start

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    import carla

    from basu.drive import Driven
    from basu.managers.agent_loader import LoadedAgent
    from basu.metrics.score import Scoring
    from basu.options import RunOptions
    from basu.outcome import Outcome
    from basu.routing.lane_graph import LaneGraph


@dataclass(frozen=True, slots=True)
class Simulator:
    """A simulator that answers."""

    client: carla.Client
    own: bool
    why_gone: Callable[[], str | None]


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be run, as far as it can be known without a simulator."""

    loaded: LoadedAgent
    agents: AgentsManager  # for the first run; each further run makes its own
    sensor_file: Path | None
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
    sensor_file = None if config.sensors is None else find(config.sensors, "sensor file", loaded.file)
    SensorsManager(sensor_file)
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
    return Plan(loaded, agents, sensor_file, routes)


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
    config = agents.config
    with asking(f"loading {description.town}"):
        if repetition and simulator.own:
            simulator.client.reload_world(reset_settings=False)
        world = world_of(simulator.client, description.town)
        carla_map = world.get_map()
    lanes = lane_graph.build(carla_map)
    own_points = agents.own_route()
    if own_points is not None:
        description = RouteDescription(
            id=f"{description.id}-own", town=description.town, points=own_points, stops=(), source=prepared.loaded.name
        )
    route = plan(carla_map, description, lanes)
    sensors = SensorsManager(prepared.sensor_file)
    with (
        asking("getting the vehicle ready"),
        ticked_by_us(world, STEP_S),
        vehicle_at_start(world, route, config.vehicle) as vehicle,
        ProgressBar(route.length_m, STEP_S) as bar,
    ):
        world.set_weather(weather_called(config.weather))
        this_run = Run(
            client=simulator.client,
            world=world,
            carla_map=carla_map,
            vehicle=vehicle,
            route=route,
            config=config,
            step_s=STEP_S,
            seed=options.seed,
            timeout_s=options.timeout_s,
        )
        driven = drive(this_run, agents, sensors, scoring, why_gone=simulator.why_gone, on_tick=bar.tick)
    if options.debug and driven.agent_error is not None:
        traceback.print_exception(driven.agent_error)
    label = _label(description, prepared)
    folder = make_folder(options.output, started.astimezone(), prepared.loaded.name, label)
    _leave(folder, driven, scoring, lanes, _config(options, scoring, prepared, agents, description, simulator, started))
    if driven.bug is not None:
        raise driven.bug
    return driven.outcome


def _label(description: RouteDescription, prepared: Plan) -> str:
    """What a route is called in a folder's name: its file, and its id where the file has several."""
    stem = PurePath(description.source).stem
    return stem if len(prepared.routes) == 1 else f"{stem}-{description.id}"


def _config(
    options: RunOptions,
    scoring: Scoring,
    prepared: Plan,
    agents: AgentsManager,
    description: RouteDescription,
    simulator: Simulator,
    started: datetime,
) -> dict[str, Any]:
    """What is needed to run it again."""
    again = ["basu", "run", options.agent, "--route-id", description.id, "--seed", str(options.seed)]
    return {
        "started": started.isoformat(timespec="seconds"),
        "command": again if options.routes is None else [*again, "--routes", options.routes],
        "agent": {"name": prepared.loaded.name, "class": prepared.loaded.agent_class.__name__, "file": options.agent},
        "agent_config": asdict(agents.config),
        "route": description.id,
        "town": description.town,
        "seed": options.seed,
        "step_s": STEP_S,
        "step_limit_s": options.step_limit_s,
        "own_simulator": simulator.own,
        "scoring": {
            "penalties": {kind.value: penalty for kind, penalty in scoring.penalties.items()},
            "infraction_weight": scoring.infraction_weight,
            "path_following_weight": scoring.path_following_weight,
        },
        "versions": {
            "basu": basu.__version__,
            "carla": version("carla"),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }


def _leave(folder: Path, driven: Driven, scoring: Scoring, lanes: LaneGraph, config: dict[str, Any]) -> None:
    """Write the folder of a run and show its table."""
    history = driven.history
    ticks = 0 if history is None else len(history.frames)
    meta = {
        "simulated_s": ticks * STEP_S,
        "wall_s": round(driven.wall_s, 3),
        "ticks": ticks,
        "step_s": STEP_S,
        "first_server_frame": driven.first_frame,
        "started": config["started"],
        "seed": config["seed"],
        "agent": config["agent"],
        "vehicle": config["agent_config"]["vehicle"],
        "weather": config["agent_config"]["weather"],
        "route": config["route"],
        "town": config["town"],
        "versions": config["versions"],
    }
    document = result(driven.outcome, history, scoring, meta)
    print(table(document))
    write_json(folder / CONFIG_FILE, config)
    write_json(folder / RESULT_FILE, document)
    if history is not None:
        write_history(folder, history)
        title = f"{config['agent']['name']} on route {config['route']} of {config['town']}: {document['status']}"
        picture.draw(folder / PICTURE_FILE, history, lanes.streets(), title)
    point_latest(folder)
    print(f"result folder     {folder}")
