"""One drive: a world begins anew, takes a control each step, records every frame, and says when and why it is over.

An episode knows nothing of the agent. The benchmark, a gymnasium environment or a notebook call ``reset`` once and
``step`` with a control until the step has an outcome.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu import plugins
from basu.episode.failures import outcome_of
from basu.episode.world import Towns, asking, next_frame, ticked_by_us, vehicle_at_start
from basu.errors import (
    AgentError,
    SimulatorError,
    UserError,
)
from basu.managers import Live
from basu.managers.base_manager import BaseManager, CoSimulation, DriverState, Frame, Run, WorldChanges
from basu.managers.metrics_manager import MetricsManager
from basu.managers.observations import Neighbours
from basu.managers.routes_manager import RoutesManager
from basu.managers.scenario_manager import ScenarioManager
from basu.managers.sensors_manager import SensorsManager
from basu.managers.traffic_manager import TrafficManager
from basu.outcome import Outcome, Status
from basu.routing import plan
from basu.simulator import linden_command

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.conditions import Sumo
    from basu.episode.spec import EpisodeSpec
    from basu.episode.world import Town
    from basu.managers.scenario_manager import Playing
    from basu.records.history import History
    from basu.routing import Route
    from basu.routing.planned_route import Progress
    from basu.routing.route_file import RouteDescription
    from basu.simulator import Simulator

FAILED_TIMEOUT_S = 1.0  # wall time for each call to a simulator that has failed
LATE_EVENTS_S = 0.05  # wall time for events of the last frame, which come on connections of their own


class Observation(NamedTuple):
    """One frame before its control is known."""

    frame: Frame
    sensor_data: dict[str, tuple[int, Any]]  # the latest measurement of each sensor, with its frame
    progress: Progress  # along the route
    driven_m: float  # of the route, validly
    in_lane: bool  # whether place and direction are those of the route


class Step(NamedTuple):
    """What a control has led to."""

    observation: Observation  # the next frame; the same one again where the episode is over
    outcome: Outcome | None  # None while the episode goes on
    ending: Outcome | None  # of the frame in ``observation`` where it is the last one, whatever its control will be


class Ground(NamedTuple):
    """The town, the route on its lanes, and the scenarios on the route."""

    world: carla.World
    town: Town
    description: RouteDescription
    route: Route
    scenarios: ScenarioManager


class _Managers(NamedTuple):
    """The managers of one drive."""

    routes: RoutesManager
    metrics: MetricsManager
    traffic: TrafficManager
    sumo: CoSimulation | None
    sensors: SensorsManager
    observers: tuple[BaseManager, ...]


class Episode:
    """A drive that can begin again. ``prepare`` and ``reset`` begin it, ``step`` drives it, ``close`` ends it."""

    def __init__(
        self,
        simulator: Simulator,
        spec: EpisodeSpec,
        *,
        towns: Towns | None = None,
        sensors: Callable[[], SensorsManager] = lambda: SensorsManager((), ""),
        participants: Sequence[BaseManager] = (),
        observers: Callable[[Live], Sequence[BaseManager]] = lambda _live: (),
        folder: Path = Path(),
    ) -> None:
        """Describe an episode; the simulator gets no call yet.

        ``towns`` are shared by all episodes of a simulator. ``sensors`` makes the agent's sensors for one drive.
        ``participants`` are set up between the traffic and the sensors and are not ticked. ``observers`` makes managers
        that change nothing and are ticked after all others but the scenarios. ``folder`` is the run's.
        """
        self._simulator, self._spec = simulator, spec
        self._towns = towns
        self._new_sensors, self._participants, self._new_observers = sensors, tuple(participants), observers
        self._folder = folder
        self._resources = contextlib.ExitStack()
        self._set_up: list[BaseManager] = []
        self._prepared = False  # a vehicle stands at the start, and the drive is still to come
        self._laid = False  # the ground is new
        self.ground: Ground | None = None  # of the current drive, and of the last one until the next begins
        self.history: History | None = None  # the whole record, once ``end`` has made it
        self.outcome: Outcome | None = None
        self.bug: Exception | None = None  # an error of the benchmark itself
        self.agent_error: AgentError | None = None
        self.traffic: dict[str, int] = {"vehicles": 0, "walkers": 0}  # what the drive has had, once it is over
        self.first_frame: int | None = None  # the server's number of the first recorded frame, likewise
        self._managers: _Managers | None = None
        self._run: Run | None = None
        self._driver = DriverState()
        self._unrecorded: Observation | None = None  # a frame that waits for its control

    # -- the beginning

    def lay(self) -> Ground:
        """Load the town, plan the route, and lay the scenarios on it; the vehicle is still to come.

        Raises:
            UserError: the route or a scenario has no place there.
            SimulatorError: the simulator failed.
        """
        self.close()
        if self._towns is None:
            self._towns = Towns(self._simulator)
        spec = self._spec
        world, town = self._towns.load(spec.town, reload=spec.reload)
        description = spec.description(town.carla_map)
        scenarios = ScenarioManager(spec.scenarios, own=spec.is_case)
        route = plan(town.carla_map, description, town.lanes)
        if not spec.is_case:
            scenarios.lay(route, town.carla_map)
        self.ground, self._laid = Ground(world, town, description, route, scenarios), True
        return self.ground

    def prepare(self, seed: int, folder: Path | None = None) -> None:
        """Put the vehicle at the start of its route; ``reset`` does so by itself where this was not called.

        ``folder``, where the run is written, may be given now if it was not known before.

        Raises:
            UserError: the vehicle, the route or a scenario has no place in the world.
            SimulatorError: the simulator failed.
        """
        ground = self.ground if self.ground is not None and self._laid else self.lay()
        self._laid = False
        spec, world = self._spec, ground.world
        try:
            with asking("getting the vehicle ready"):
                self._resources.enter_context(ticked_by_us(world, spec.step_s))
                if not self._simulator.own:
                    world.reset_all_traffic_lights()  # nothing was loaded anew: they show what the drive before left
                vehicle = self._resources.enter_context(vehicle_at_start(world, ground.route, spec.config.vehicle))
                world.set_weather(spec.weather)
                if not spec.is_case:
                    ground.scenarios.try_out(self._simulator.client, world)
        except BaseException:
            self.close()
            raise
        self._run = Run(
            client=self._simulator.client,
            world=world,
            carla_map=ground.town.carla_map,
            vehicle=vehicle,
            route=ground.route,
            config=spec.config,
            step_s=spec.step_s,
            seed=seed,
            timeout_s=spec.timeout_s,
            folder=self._folder if folder is None else folder,
            server_address=self._simulator.address,
            own_simulator=self._simulator.own,
            gate=self._simulator.gate,
            weather=spec.weather_along,
            neighbours=Neighbours(world, vehicle.id),
            changes=WorldChanges(control=carla.VehicleControl(brake=1.0), weather=spec.weather),
        )
        self._prepared = True

    def reset(self, seed: int | None = None) -> Observation:
        """Begin a drive and return its first frame; the drive before is closed.

        ``seed`` may be left out where ``prepare`` was given it, and is 0 otherwise.

        Raises:
            UserError, SimulatorError: it cannot begin, see ``prepare``; or a manager is not ready.
            AgentError: a participant is not ready.
        """
        if not self._prepared:
            self.prepare(seed or 0)
        self._prepared = False
        run, ground = self._run, self.ground
        assert run is not None, "it is prepared"
        assert ground is not None, "likewise"
        self.history = self.outcome = self.bug = self.agent_error = None
        self._driver = DriverState()
        routes = RoutesManager(self._spec.stop_after_s)
        metrics = MetricsManager(self._driver, routes, self._spec.scoring, lane_invasions=self._spec.lane_invasions)
        ground.scenarios.join(routes, metrics)
        sensors, traffic = self._new_sensors(), TrafficManager(self._spec.traffic, self._reserved_m(run, ground))
        sumo = None if self._spec.sumo is None else _cosimulation(self._spec.sumo, routes)
        observers = tuple(self._new_observers(Live(self._driver, sensors, routes, metrics)))
        self._managers = _Managers(routes, metrics, traffic, sumo, sensors, observers)
        # participants before sensors: another program's agent says only once it is set up what it wants to sense
        joined = () if sumo is None else (sumo,)
        for manager in (traffic, *joined, *self._participants, sensors, routes, metrics, ground.scenarios, *observers):
            self._set_up.append(manager)
            manager.setup(run)
        return self._observe(None)

    def _reserved_m(self, run: Run, ground: Ground) -> list[tuple[float, float]]:
        """Return the places that traffic leaves free: a case's actors come after it, and all of them must come.

        Raises:
            ScenarioError: the case has no place on its route.
        """
        if not self._spec.is_case or self._spec.traffic.is_empty:
            return []
        ground.scenarios.lay(run.route, run.carla_map)
        return ground.scenarios.reserved_m()

    # -- the drive

    def step(
        self, control: carla.VehicleControl, *, requested: carla.VehicleControl | None = None, manual: bool = False
    ) -> Step:
        """Record the current frame with its control, apply the control, and let the simulator make the next frame.

        ``manual`` says that a person gave the control; ``requested`` is then the agent's own. The outcome belongs to
        the frame that was just recorded.

        Raises:
            UserError, SimulatorError: the drive cannot go on; ``fail`` says what that means for its outcome.
        """
        managers, run, ground = self._managers, self._run, self.ground
        observation = self._unrecorded
        if managers is None or run is None or ground is None or observation is None:
            raise UserError("this episode does not wait for a control; call reset() first")
        frame = observation.frame
        self._driver.control, self._driver.manual = control, manual
        self._driver.requested = control if requested is None else requested
        self._record()
        managers.routes.change_weather(frame)
        for observer in managers.observers:
            observer.tick(frame)
        ground.scenarios.tick(frame)
        self.outcome = managers.routes.outcome or ground.scenarios.outcome
        if self.outcome is not None:
            return Step(observation, self.outcome, self.outcome)
        # A simulator that has ended gets no further step: the Traffic Manager's thread in the official client would run
        # into its own time-out meanwhile, and that ends the whole process.
        if self._simulator.ended():
            raise SimulatorError("the simulator ended")
        applied = ground.scenarios.through(control)
        managers.metrics.applied(applied)
        if managers.sumo is not None:
            managers.sumo.tick(frame)
        run.vehicle.apply_control(applied)
        run.changes.control = applied
        return Step(self._observe(frame), None, managers.routes.outcome)

    def _observe(self, before: Frame | None) -> Observation:
        """Make the next frame, wait for its sensors, and advance along the route."""
        run, managers = self._run, self._managers
        assert run is not None, "reset has prepared it"
        assert managers is not None, "likewise"
        frame = next_frame(run, before)
        managers.sensors.tick(frame)
        managers.routes.tick(frame)
        routes = managers.routes
        self._unrecorded = Observation(
            frame, managers.sensors.data, routes.progress, routes.valid.driven_m, routes.valid.check.in_lane
        )
        return self._unrecorded

    def _record(self) -> None:
        """Record the frame that waits for its control."""
        observation, self._unrecorded = self._unrecorded, None
        if observation is not None and self._managers is not None:
            self._managers.metrics.tick(observation.frame)

    # -- the end

    def fail(self, error: BaseException) -> Outcome:
        """Classify what ended the drive and set the outcome; what the agent failed in is recorded as well.

        Raises:
            BaseException: ``error`` itself, where it is neither an exception nor the user's interruption.
        """
        with contextlib.suppress(RuntimeError):  # the simulator is gone
            self._record()
        if isinstance(error, AgentError):
            self.agent_error = error
        outcome = outcome_of(error, self._simulator.why_gone)
        if outcome.status is Status.BENCHMARK_FAILED and isinstance(error, Exception):
            self.bug = error
        self.outcome = outcome
        return outcome

    def end(self) -> None:
        """Make the record of the drive, ``history``, and close everything; an agent's error in that joins the outcome.

        The last frame's events may be under way still: one more step, which is not recorded, and a moment bring them.
        """
        if self._run is not None and self._managers is not None:
            if self.outcome is not None and self.outcome.status is Status.SIMULATOR_FAILED:
                self._run.client.set_timeout(FAILED_TIMEOUT_S)
            if self._managers.metrics.ticks:
                with contextlib.suppress(RuntimeError):  # the simulator is gone, and sends no more events
                    self._run.world.tick(self._run.timeout_s)
                    time.sleep(LATE_EVENTS_S)
                sumo = None if self._managers.sumo is None else self._managers.sumo.record()
                self.history = replace(self._run.numbering.applied(self._managers.metrics.history()), sumo=sumo)
        self.close()

    def close(self) -> None:
        """Put away managers, vehicle and settings; may be called at any time and more than once."""
        while self._set_up:
            try:
                self._set_up.pop().close()
            except AgentError as error:  # noqa: PERF203 - some managers, once a drive
                if self.outcome is not None:  # the drive is over and keeps its status
                    self.outcome = self.outcome._replace(message=f"{self.outcome.message}; afterwards {error}")
        if self._managers is not None:
            self.traffic, self.first_frame = dict(self._managers.traffic.count), self._managers.metrics.first_frame
            if self._managers.sumo is not None:
                self.traffic = {kind: n + self._managers.sumo.count[kind] for kind, n in self.traffic.items()}
        self._managers = self._run = self._unrecorded = None
        self._prepared = self._laid = False
        self._resources.close()

    # -- what it has found

    @property
    def metrics(self) -> MetricsManager:
        """The record of the current drive while it lasts."""
        assert self._managers is not None, "the drive lasts from reset to end"
        return self._managers.metrics

    @property
    def run(self) -> Run:
        """The current drive's client, world, vehicle and route."""
        assert self._run is not None, "the drive lasts from prepare to end"
        return self._run

    @property
    def playing(self) -> Sequence[Playing]:
        """The scenarios of the drive."""
        return () if self.ground is None else self.ground.scenarios.playing


def _cosimulation(sumo: Sumo, routes: RoutesManager) -> CoSimulation:
    """Return the manager of SUMO's traffic, which a plugin brings.

    Raises:
        UserError: the plugin is not installed.
    """
    made: CoSimulation = plugins.load(plugins.PARTS, "sumo", "SUMO's traffic")(sumo, linden_command(), routes)
    return made
