"""One case with one agent: a fresh world, the ego at its place, the scenario played, its verdict and its folder."""

from __future__ import annotations

import math
import shutil
import time
import traceback
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.errors import AgentError, ScenarioError, SimulatorError, UserError
from basu.managers.base_manager import Run
from basu.managers.scenario_manager import ScenarioManager
from basu.managers.sensors_manager import SensorsManager
from basu.managers.stage.weather import changed
from basu.managers.traffic_manager import TrafficManager
from basu.metrics.score import Scoring
from basu.options import NOBODY, STEP_S
from basu.outcome import Outcome, Status
from basu.output.report.folder import CONFIG_FILE, RESULT_FILE, make_draft, plain, publish, write_json
from basu.output.report.scenarios.pictures import PICTURE_FILE, case_picture
from basu.output.report.streets import around, write_streets
from basu.records.history.files import write_history
from basu.routing import lane_graph, plan
from basu.routing.route_file import RouteDescription, RoutePoint
from basu.running.drive import drive
from basu.running.preparation import SensorSet, new_agents, sensor_set
from basu.running.scenario_runs.document import case_config, document_of
from basu.scenarios.paths.lanes import followed, waypoint_at
from basu.scenarios.verdict import judge
from basu.simulator import asking, ticked_by_us, world_of
from basu.utils.atomic import write_bytes
from basu.vehicle import vehicle_at_start

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from basu.agents.process.remote_agent import FoundAgent
    from basu.managers.agents_manager import AgentsManager
    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.routing.lane_graph import LaneGraph
    from basu.running.drive import Driven
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.cases import Playable
    from basu.scenarios.config.model import Case
    from basu.scenarios.scenario import Scenario
    from basu.scenarios.verdict import Judged
    from basu.simulator import Simulator

POINT_M = 20.0  # between the points of a way that goes straight on
JUNCTION_WITHIN_M, BEHIND_JUNCTION_M = 250.0, 30  # such a way goes on to behind a junction, where that is needed


class Town(NamedTuple):
    """A town's map and its lanes, made once: to read a map again takes the client as long as to drive a case."""

    carla_map: carla.Map
    lanes: LaneGraph
    streets_m: list[NDArray[np.float64]]  # the lanes' centre lines, (K, 2) each


@dataclass(slots=True)
class Theatre:
    """What all cases of one worker share."""

    options: ScenarioOptions
    simulator: Simulator
    names: frozenset[str]  # of the towns that the simulator has
    towns: dict[str, Town] = field(default_factory=dict)  # that were played in
    loaded: str | None = None  # the town that we have loaded; None: whatever was there

    def fresh_world(self, playable: Playable) -> carla.World:
        """A world begun anew, in the town of a case.

        Raises:
            ScenarioError: the simulator does not have it.
            SimulatorError: the simulator does not load it.
        """
        client, town = self.simulator.client, playable.case.town
        check_town(playable.case, self.names)
        with asking(f"loading {town}"):
            client.reload_world(reset_settings=False)
            world = client.get_world() if self.loaded == town else world_of(client, town)
        self.loaded = town
        return world

    def town(self, name: str, world: carla.World) -> Town:
        """The map of the town that is loaded, and its lanes."""
        if name not in self.towns:
            carla_map = world.get_map()
            lanes = lane_graph.build(carla_map)
            self.towns[name] = Town(carla_map, lanes, lanes.streets())
        return self.towns[name]


def check_town(case: Case, names: frozenset[str]) -> None:
    """Whether a case can be played in a simulator with towns of these names.

    Raises:
        ScenarioError: its town is not among them.
    """
    if case.town not in names:
        there = ", ".join(sorted(names))
        raise ScenarioError(
            f"{case.name} is in {case.town}, which this simulator does not have (it has {there}): play it on one that "
            f"has, with --host, or give the case a place in {there} ({case.source})"
        )


class Performed(NamedTuple):
    """A case that is over and written."""

    document: dict[str, Any]
    folder: Path
    outcome: Outcome


class _Attempt(NamedTuple):
    """What came of a case, whatever that is."""

    driven: Driven | None
    playing: Playing | None
    outcome: Outcome
    town: Town | None


def perform(theatre: Theatre, loaded: FoundAgent, playable: Playable, output: Path) -> Performed:
    """Play a case and write its folder below ``output``; whatever goes wrong becomes its verdict."""
    began_s = time.perf_counter()
    case, options = playable.case, theatre.options
    draft = make_draft(output, plain(case.name))
    try:
        attempt = _attempt(theatre, loaded, playable, draft)
        history = None if attempt.driven is None else attempt.driven.history
        judged = _judged(attempt, history)
        document = document_of(
            playable, loaded, attempt.playing, judged, options, history=history, wall_s=time.perf_counter() - began_s
        )
        write_json(draft / RESULT_FILE, document)
        write_json(draft / CONFIG_FILE, case_config(playable, options, loaded))
        if history is not None:
            write_history(draft, history)
            streets = [] if attempt.town is None else around(attempt.town.streets_m, history)
            write_streets(draft, streets)
            write_bytes(draft / PICTURE_FILE, case_picture(document, history, streets).encode())
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    return Performed(document, publish(draft, plain(case.name)), attempt.outcome)


def _judged(attempt: _Attempt, history: History | None) -> Judged:
    """The verdict."""
    if attempt.playing is None or history is None:
        return judge((), None, attempt.outcome, triggered=False)
    return attempt.playing.judged(history, attempt.outcome)


def _attempt(theatre: Theatre, loaded: FoundAgent, playable: Playable, draft: Path) -> _Attempt:
    """Drive it, or know why not."""
    town = None
    try:
        agents = new_agents(loaded, theatre.options.run_options(loaded.name), theatre.options.drive_seed)
        sensors = _sensors(agents, loaded)
        world = theatre.fresh_world(playable)
        town = theatre.town(playable.case.town, world)
        scenes = ScenarioManager([playable], own=True)
        driven = _driven(theatre, agents, sensors, playable, world, town, scenes, draft)
    except UserError as error:
        return _Attempt(None, None, Outcome(Status.SETUP_FAILED, str(error)), town)
    except AgentError as error:
        return _Attempt(None, None, Outcome(Status.AGENT_CRASHED, str(error)), town)
    except SimulatorError as error:
        return _Attempt(None, None, Outcome(Status.SIMULATOR_FAILED, str(error)), town)
    for failure in (driven.bug, driven.agent_error if theatre.options.debug else None):
        if failure is not None:
            traceback.print_exception(failure)
    return _Attempt(driven, next(iter(scenes.playing), None), driven.outcome, town)


def _sensors(agents: AgentsManager, loaded: FoundAgent) -> SensorSet:
    """What the agent senses with; those of our own read no sensors, theirs are for who looks on, as nobody does here.

    Raises:
        UserError: the agent asks for what is no sensor set.
    """
    return SensorSet((), loaded.name) if loaded.file is None else sensor_set(agents, loaded)


def _driven(
    theatre: Theatre,
    agents: AgentsManager,
    sensors: SensorSet,
    playable: Playable,
    world: carla.World,
    town: Town,
    scenes: ScenarioManager,
    folder: Path,
) -> Driven:
    """The drive, with everything that the simulator was asked for given back afterwards."""
    options, simulator, case = theatre.options, theatre.simulator, playable.case
    blueprint = options.vehicle or case.ego.model
    route = plan(town.carla_map, description_of(playable, town.carla_map), town.lanes)
    agents.config = replace(agents.config, vehicle=blueprint)
    with (
        asking("getting the vehicle ready"),
        ticked_by_us(world, STEP_S),
        vehicle_at_start(world, route, blueprint) as vehicle,
    ):
        world.set_weather(_weather(playable))
        run = Run(
            client=simulator.client,
            world=world,
            carla_map=town.carla_map,
            vehicle=vehicle,
            route=route,
            config=agents.config,
            step_s=STEP_S,
            seed=options.drive_seed,
            timeout_s=options.timeout_s,
            folder=folder,
            server_address=simulator.address,
            own_simulator=simulator.own,
        )
        return drive(
            run,
            agents,
            SensorsManager(*sensors, late=agents.late_sensors, listener=agents),
            TrafficManager(NOBODY),
            Scoring(),
            why_gone=simulator.why_gone,
            ended=simulator.ended,
            observers=lambda _live: (),
            scenarios=scenes,
            lane_invasions=False,  # no criterion asks for them
        )


def _weather(playable: Playable) -> carla.WeatherParameters:
    """As the case says, else as the scenario does, from CARLA's clear noon on."""
    given = playable.scenario.weather if playable.case.weather is None else playable.case.weather
    noon = carla.WeatherParameters.ClearNoon
    fresh = carla.WeatherParameters(
        **{name: getattr(noon, name) for name in ("sun_azimuth_angle", "sun_altitude_angle")}
    )
    return changed(fresh, given)


def description_of(playable: Playable, carla_map: carla.Map) -> RouteDescription:
    """The ego's route: through the points that the case gives, or straight on along the lanes.

    Raises:
        UserError: no road lies where it begins.
    """
    case = playable.case
    start = case.ego.pose
    points = [RoutePoint(start.x_m, start.y_m, start.z_m, start.yaw_rad)]
    if case.way:
        points += [RoutePoint(pose.x_m, pose.y_m, pose.z_m) for pose in case.way]
    else:
        way = _straight_on(waypoint_at(carla_map, start), playable.scenario)
        places = [waypoint.transform.location for waypoint in [*way[int(POINT_M) :: int(POINT_M)], way[-1]]]
        points += [RoutePoint(at.x, at.y, at.z) for at in places]
    return RouteDescription(id=case.name, town=case.town, points=tuple(points), stops=case.stops, source=case.source)


def _straight_on(start: carla.Waypoint, scenario: type[Scenario]) -> list[carla.Waypoint]:
    """A way point a metre, as far as the scenario needs: ScenarioRunner's cases name no end."""
    if not scenario.needs_junction:
        return followed(start, scenario.needs_m)
    way = followed(start, max(JUNCTION_WITHIN_M, scenario.needs_m))
    inside = [waypoint.is_junction for waypoint in way]
    entry = inside.index(True) if True in inside else len(way)
    behind = inside.index(False, entry) if False in inside[entry:] else len(way)
    return way[: 1 + max(math.ceil(scenario.needs_m), behind + BEHIND_JUNCTION_M)]
