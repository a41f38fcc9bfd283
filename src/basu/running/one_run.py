"""One run: a fresh world, the vehicle at the beginning of its route, the drive, and the draft of its folder."""

from __future__ import annotations

import shutil
import sys
import traceback
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.managers.base_manager import BaseManager, Live, Run
from basu.managers.recording_manager import RecordingManager
from basu.managers.route_scenarios import told
from basu.managers.scenario_manager import ScenarioManager
from basu.managers.sensors_manager import SensorsManager
from basu.managers.traffic_manager import TrafficManager
from basu.metrics.registry import user_metrics
from basu.options import STEP_S
from basu.output.hud.person_input import onlookers_for
from basu.output.progress import ProgressBar
from basu.output.report.folder import make_draft
from basu.output.viewer.onlooker import viewer_for
from basu.records.carla_log.sources import LOG_FILE
from basu.routing import lane_graph, plan
from basu.running.drive import drive
from basu.running.run_folder import OWN_ROUTE, run_config, write_run_folder
from basu.simulator import asking, ticked_by_us, weather_called, world_of
from basu.vehicle import vehicle_at_start

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    import carla

    from basu.managers.agents_manager import AgentsManager
    from basu.metrics.score import Scoring
    from basu.options import RunOptions
    from basu.outcome import Outcome
    from basu.routing import Route
    from basu.routing.lane_graph import LaneGraph
    from basu.routing.route_file import RouteDescription
    from basu.running.drive import Driven
    from basu.running.preparation import Job, Plan
    from basu.simulator import Simulator


@dataclass(frozen=True, slots=True)
class Session:
    """What all runs of one command share."""

    options: RunOptions
    scoring: Scoring
    plan: Plan
    simulator: Simulator
    lanes: dict[str, LaneGraph] = field(default_factory=dict)  # of the towns that were there, by their OpenDRIVE text

    def lanes_of(self, carla_map: carla.Map) -> LaneGraph:
        """The lanes of a map, made once."""
        text = carla_map.to_opendrive()
        if text not in self.lanes:
            self.lanes[text] = lane_graph.build(carla_map)
        return self.lanes[text]


class Finished(NamedTuple):
    """A run that is over and written."""

    outcome: Outcome
    draft: Path  # its folder, not yet under its name
    document: dict[str, Any]  # its result
    bug: Exception | None  # an error of our own, to be raised once all is in its place


class Ground(NamedTuple):
    """The town with the route on it."""

    world: carla.World
    carla_map: carla.Map
    lanes: LaneGraph
    description: RouteDescription
    route: Route
    scenarios: ScenarioManager  # laid on it


def run_one(session: Session, agents: AgentsManager, job: Job, *, output: Path, name: str, fresh: bool) -> Finished:
    """Make one run and write its folder as a draft for ``name`` in ``output``.

    ``fresh`` begins the world anew, where the simulator is our own.

    Raises:
        UserError, AgentError: it cannot be begun like this.
        SimulatorError: the simulator failed before it began.
    """
    started = datetime.now(timezone.utc)
    ground = _ground(session, agents, job, fresh=fresh)
    draft = make_draft(output, name)
    traffic = TrafficManager(session.options.traffic)
    log = str((draft / LOG_FILE).resolve()) if session.simulator.own else f"{name}.log"
    recording = RecordingManager(log) if session.options.record else None
    try:
        driven = _driven(session, agents, ground, job.seed, draft, traffic, recording)
    except BaseException:  # nothing was driven: nothing is left behind
        shutil.rmtree(draft, ignore_errors=True)
        raise
    if session.options.debug and driven.agent_error is not None:
        traceback.print_exception(driven.agent_error)
    config = run_config(
        session.options,
        session.scoring,
        session.plan.loaded,
        agents.config,
        ground.description,
        own_simulator=session.simulator.own,
        started=started,
        seed=job.seed,
        traffic=traffic.count,
        log=None if recording is None else recording.path,
    )
    met = told(ground.scenarios.playing, driven.history, driven.outcome)
    own = user_metrics(session.options.metric_files)
    document = write_run_folder(draft, driven, session.scoring, ground.lanes, config, met, own)
    return Finished(driven.outcome, draft, document, driven.bug)


def _ground(session: Session, agents: AgentsManager, job: Job, *, fresh: bool) -> Ground:
    """The world with the route's town in it, the route on its lanes, and its scenarios on the route."""
    town, simulator = job.description.town, session.simulator
    with asking(f"loading {town}"):
        if fresh and simulator.own:
            simulator.client.reload_world(reset_settings=False)
        world = world_of(simulator.client, town)
    carla_map = world.get_map()
    lanes = session.lanes_of(carla_map)
    points = agents.own_route()
    description, waiting = job.description, job.scenarios
    if points is not None:
        description = replace(description, id=f"{description.id}{OWN_ROUTE}", points=points, stops=())
        if waiting:
            sys.stderr.write(
                f"basu: warning: the agent goes a way of its own, so the {len(waiting)} scenarios on the way of route "
                f"'{job.description.id}' are left away\n"
            )
            waiting = ()
    route = plan(carla_map, description, lanes)
    scenarios = ScenarioManager(waiting, own=False)
    scenarios.lay(route, carla_map)
    return Ground(world, carla_map, lanes, description, route, scenarios)


def _driven(
    session: Session,
    agents: AgentsManager,
    ground: Ground,
    seed: int,
    folder: Path,
    traffic: TrafficManager,
    recording: RecordingManager | None,
) -> Driven:
    """The drive, with everything that the simulator was asked for given back afterwards."""
    options, simulator, world = session.options, session.simulator, ground.world

    def observers(live: Live) -> Sequence[BaseManager]:
        recorder = [] if recording is None else [recording]
        return [ProgressBar(live), *recorder, *onlookers_for(options, live), *viewer_for(options, live)]

    with (
        asking("getting the vehicle ready"),
        ticked_by_us(world, STEP_S),
        vehicle_at_start(world, ground.route, agents.config.vehicle) as vehicle,
    ):
        world.set_weather(weather_called(agents.config.weather))
        ground.scenarios.try_out(simulator.client, world)
        this_run = Run(
            client=simulator.client,
            world=world,
            carla_map=ground.carla_map,
            vehicle=vehicle,
            route=ground.route,
            config=agents.config,
            step_s=STEP_S,
            seed=seed,
            timeout_s=options.timeout_s,
            folder=folder,
            server_address=simulator.address,
            own_simulator=simulator.own,
            weather=() if options.weather is not None else ground.description.weather,
        )
        watched = options.hud is not None or options.viewer or agents.person is not None
        sensors = SensorsManager(*session.plan.sensors, late=agents.late_sensors, listener=agents, is_watched=watched)
        return drive(
            this_run,
            agents,
            sensors,
            traffic,
            session.scoring,
            why_gone=simulator.why_gone,
            ended=simulator.ended,
            observers=observers,
            scenarios=ground.scenarios,
        )
