"""`prepare` loads and checks agent, sensors, routes and scenarios before a simulator starts, and returns a `Plan`."""

from __future__ import annotations

import contextlib
import importlib.util
import random
import sys
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu import plugins
from basu.agents.process.gate import closed_ports
from basu.agents.process.remote_agent import find_agent
from basu.agents.sensor_file import read_sensors
from basu.episode import seed_of
from basu.episode.world import weather_called
from basu.errors import AgentCrashedError, UserError
from basu.files import PACKAGE_FOLDER, find, places
from basu.managers.agents_manager import AgentsManager
from basu.options.sumo import SUMO_OFF
from basu.routing.route_file import OWN_ROUTE, RouteDescription, read_routes, subset
from basu.running.outputs import person_for
from basu.running.shuttles import SensorSet, Shuttle, beside
from basu.scenarios.route_scenarios import scenarios_on

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu.agents.autonomous_agent import AgentConfig
    from basu.agents.process.remote_agent import FoundAgent
    from basu.agents.sensor_file import SensorSpec
    from basu.options.drive import DriveOptions
    from basu.options.run import RunOptions
    from basu.scenarios.playable import Playable


class RequestedRun(NamedTuple):
    """One of the requested runs."""

    number: int  # from 0
    description: RouteDescription
    label: str  # of the route in a folder's name
    repetition: int  # from 0
    seed: int
    scenarios: tuple[Playable, ...] = ()  # on the way


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be run."""

    shuttles: tuple[Shuttle, ...]  # with agents for the first run; each further run makes its own
    jobs: tuple[RequestedRun, ...]

    @property
    def loaded(self) -> FoundAgent:
        """The agent of the first shuttle, mostly the only one."""
        return self.shuttles[0].loaded

    @property
    def agents(self) -> AgentsManager:
        """The manager of the agent of the first shuttle in the first run."""
        return self.shuttles[0].agents

    @property
    def sensors(self) -> SensorSet:
        """The sensors of the first shuttle."""
        return self.shuttles[0].sensors


@contextlib.contextmanager
def agents_fault(loaded: FoundAgent) -> Iterator[None]:
    """Turn wrong answers of an agent in a file into its failure: it was loaded, and could choose its drives by them.

    Raises:
        AgentCrashedError: its ``config()`` or its sensors are none.
    """
    try:
        yield
    except UserError as error:
        if loaded.file is None:
            raise
        raise AgentCrashedError(str(error)) from error


def prepare(options: RunOptions, given: FoundAgent | None = None, *, has_conditions: bool = True) -> Plan:
    """Read everything that can be wrong before anything is started.

    ``given`` is an agent that is loaded. Without ``has_conditions`` the agent asks for sensors and a track only, and
    what is wrong with them is its failure.

    Raises:
        UserError, AgentError: nothing can be started like this.
    """
    loaded = given or agent_of(options, options.agent)
    if loaded.is_human and options.watch_shuttle != 1:
        raise UserError(
            f"a person drives the first shuttle, so its page has to show that one; leave out --watch-shuttle "
            f"{options.watch_shuttle}"
        )
    with contextlib.nullcontext() if has_conditions else agents_fault(loaded):
        agents = new_agents(
            loaded,
            options,
            options.seed,
            options.routes,
            has_conditions=has_conditions,
            is_watched=options.watch_shuttle == 1,
        )
        sensors = sensor_set(agents, loaded)
    config = agents.config
    weather_called(config.weather)
    if options.host is None and (hint := camera_hint(sensors.specs)) is not None:
        print(f"basu: hint: {hint}", file=sys.stderr)
    wants_sumo = options.sumo not in (None, SUMO_OFF) or options.sumo_port is not None
    if wants_sumo and not _has_sumo():
        raise UserError(_sumo_is_missing())
    if config.sumo is not None and options.sumo is None and not _has_sumo():
        wish = f"{loaded.name} asks for SUMO's traffic, and {_sumo_is_missing()}"
        print(f"basu: warning: {wish}; the run goes on without it", file=sys.stderr)
    path, is_own = _route_file(config, options, loaded)
    routes = _chosen(read_routes(path), config, options)
    waiting = {route.id: _scenarios(route, options) for route in routes}
    jobs = [
        RequestedRun(
            number,
            description.as_own() if is_own else description,
            _label(description, len(routes)) + (OWN_ROUTE if is_own else ""),
            repetition,
            options.seed + repetition,
            waiting[description.id],
        )
        for number, (description, repetition) in enumerate(
            (description, repetition) for description in routes for repetition in range(options.repetitions)
        )
    ]
    first = Shuttle(options.agent, loaded, agents, sensors)
    return Plan((first, *_besides(options, first, given)), tuple(jobs))


def agent_of(options: DriveOptions, agent: str, shuttle: int = 1) -> FoundAgent:
    """Return an agent by its name or file, in a process of its own for each shuttle.

    Raises:
        UserError: there is none.
    """
    return find_agent(
        agent,
        options.agent_config,
        in_process=options.in_process,
        memory_gb=options.agent_memory_gb,
        writes=options.agent_writes,
        closed_ports=closed_ports(options.host, options.port, is_open=options.open),
        output=None if options.open else options.output,
        shuttle=shuttle,
    )


def _besides(options: RunOptions, first: Shuttle, given: FoundAgent | None) -> list[Shuttle]:
    """Return the shuttles beside the first, in the order in which they stand on the route.

    Raises:
        UserError, AgentError: an agent cannot be had, or two shuttles need the same person.
    """
    found: list[Shuttle] = []
    for number, each in enumerate(options.besides, 2):
        typed = each.agent or options.agent
        loaded = given if given is not None and each.agent is None else agent_of(options, typed, number)
        if loaded.is_human:
            raise UserError(
                f"'{typed}' drives by a person's keys, and a person drives the first shuttle only; give the agent of "
                f"the shuttle '{each.role}' with --beside AGENT"
            )
        with agents_fault(loaded):
            agents = new_agents(
                loaded,
                options,
                options.seed,
                has_conditions=False,
                shuttle=number,
                is_watched=options.watch_shuttle == number,
            )
            agents.config = beside(first.agents.config, agents.config)
            sensors = sensor_set(agents, loaded)
        start_m = options.headway_m * (number - 1)
        found.append(Shuttle(typed, loaded, agents, sensors, number, each.role, start_m))
    return found


def _route_file(config: AgentConfig, options: RunOptions, loaded: FoundAgent) -> tuple[Path, bool]:
    """Return the route file, and whether it is the agent's own: named by ``config()`` and not one of BASU's.

    A name of the command line means the user's file or BASU's. A file beside the agent is looked for only where there
    is none, so that it cannot take the place of an official route.

    Raises:
        UserError: there is none.
    """
    if options.routes is not None:
        known = [place / config.routes for place in places(None) if (place / config.routes).exists()]
        return (known[0] if known else find(config.routes, "route file", loaded.file)), False
    path = find(config.routes, "route file", loaded.file)
    return path, loaded.file is not None and not path.resolve().is_relative_to(PACKAGE_FOLDER.resolve())


def _scenarios(description: RouteDescription, options: RunOptions) -> tuple[Playable, ...]:
    """The scenarios of a route, unless the options skip them."""
    return scenarios_on(description, options.scenario_files) if options.with_scenarios else ()


def new_agents(
    loaded: FoundAgent,
    options: DriveOptions,
    seed: int,
    routes: str | None = None,
    *,
    has_conditions: bool = True,
    shuttle: int = 1,
    is_watched: bool = True,
) -> AgentsManager:
    """Return a fresh agent, with everything random in Python begun anew.

    ``routes`` is the route file of the command line. Without ``has_conditions`` the wishes of the agent for route,
    vehicle, weather and traffic are ignored.

    ``seed`` is the run's; each ``shuttle`` has one of its own by it. Only an agent that ``is_watched`` has a page or
    recorded keys.
    """
    seed = seed_of(seed, shuttle)
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002 - for agents that use numpy's old generator; ours use neither
    person = person_for(options, by_hand=loaded.is_human) if is_watched else None
    agents = AgentsManager(
        loaded,
        step_limit_s=options.step_limit_s,
        routes=routes,
        person=person,
        seed=seed,
        track=options.track,
        leaderboard_track=options.leaderboard_track,
        is_open=options.open,
        has_conditions=has_conditions,
    )
    agents.config = replace(
        agents.config,
        weather=options.weather or agents.config.weather,
        vehicle=options.vehicle or agents.config.vehicle,
    )
    return agents


def sumo_folder(config: AgentConfig) -> str | None:
    """The SUMO folder that an agent names; None where SUMO is not installed, which ``prepare`` has said."""
    return config.sumo if _has_sumo() else None


def _has_sumo() -> bool:
    """Whether SUMO and the plugin for it are installed; they are not loaded for that."""
    return plugins.is_installed(plugins.PARTS, "sumo") and importlib.util.find_spec("libsumo") is not None


def _sumo_is_missing() -> str:
    """Return the sentence for a user without SUMO."""
    return plugins.missing(plugins.PARTS, "sumo", "SUMO's traffic")


def _chosen(
    routes: tuple[RouteDescription, ...], config: AgentConfig, options: RunOptions
) -> tuple[RouteDescription, ...]:
    """The requested routes of the file."""
    if options.routes_subset is not None:
        return subset(routes, options.routes_subset)
    if options.route_id is None:
        return routes
    chosen = tuple(route for route in routes if route.id == options.route_id)
    if not chosen:
        ids = ", ".join(route.id for route in routes)
        raise UserError(f"{config.routes} has no route '{options.route_id}'; it has {ids}")
    return chosen


def camera_hint(specs: tuple[SensorSpec, ...]) -> str | None:
    """A sentence about what cameras cost on the CPU; None without cameras."""
    count = sum(spec.type_id.startswith("sensor.camera.") for spec in specs)
    if count == 0:
        return None
    which = "1 camera is" if count == 1 else f"{count} cameras are"
    return (
        f"{which} drawn on the CPU, which takes most of the run's time; smaller pictures or a sensor_tick make it "
        "faster, and so does a GPU: `linden serve --device cuda` and --host (docs/reference/cameras.md)"
    )


def sensor_set(agents: AgentsManager, loaded: FoundAgent) -> SensorSet:
    """The sensors that the agent wants, by its own method or by a file."""
    own = agents.own_sensors()
    if own is not None:
        source = f"sensors() of {loaded.name}"
        return SensorSet(agents.admitted(own, source) if own else own, source)
    if agents.config.sensors is None:
        return SensorSet((), "")
    path = find(agents.config.sensors, "sensor file", loaded.file)
    source = f"sensor file {path}"
    return SensorSet(agents.admitted(read_sensors(path), source), source)


def _label(description: RouteDescription, routes: int) -> str:
    """What a route is called in a folder's name: its file, and its id where several are driven."""
    stem = PurePath(description.source).stem
    return stem if routes == 1 else f"{stem}-{description.id}"
