"""`Episode`: a world begins anew, takes an answer for each vehicle under test each step, and ends each vehicle's drive.

An episode knows nothing of agents. The benchmark, a gymnasium environment or a notebook call ``reset`` once and
``step`` with answers until no vehicle waits for one.
"""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import carla

from basu import plugins
from basu.episode.failures import outcome_of
from basu.episode.vehicle_under_test import DriverSetup, VehicleUnderTest, seed_of
from basu.episode.world import Towns, asking, next_snapshot, settle, spawned_at_start, ticked_by_us
from basu.errors import AgentError, SimulatorError, UserError
from basu.managers.base_manager import BaseManager, CoSimulation, Run, WorldChanges
from basu.managers.observations import Neighbours
from basu.managers.scenario_manager import ScenarioManager
from basu.managers.traffic_manager import TrafficManager
from basu.outcome import Status
from basu.routing import plan
from basu.routing.planned_route import beginning_at
from basu.simulator import linden_command

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.agents.autonomous_agent import AgentConfig
    from basu.conditions import Sumo
    from basu.episode.spec import EpisodeSpec
    from basu.episode.vehicle_under_test import DriverResponse
    from basu.episode.world import Town
    from basu.managers.routes_manager import RoutesManager
    from basu.managers.scenario_manager import Playing
    from basu.outcome import Outcome
    from basu.records.history.sumo import SumoRecord
    from basu.routing import Route
    from basu.routing.route_file import RouteDescription
    from basu.simulator import Simulator

FAILED_TIMEOUT_S = 1.0  # wall time for each call to a simulator that has failed
LATE_EVENTS_S = 0.05  # wall time for events of the last frame, which come on connections of their own


class Ground(NamedTuple):
    """The town, the route on its lanes, and the scenarios on the route."""

    world: carla.World
    town: Town
    description: RouteDescription
    route: Route
    scenarios: ScenarioManager


class _Placed(NamedTuple):
    """A vehicle that stands at the start of its route."""

    driver: DriverSetup
    config: AgentConfig
    route: Route
    actor: carla.Vehicle
    remove: Callable[[], None]


class Episode:
    """A drive that can begin again. ``prepare`` and ``reset`` begin it, ``step`` drives it, ``close`` ends it.

    The first vehicle under test has the whole route, the scenarios on it and its weather. Each of the others begins
    farther along the route. A vehicle leaves the world when its drive is over; the others go on.

    Attributes:
        ground: the town and the route of the current drive, and of the last one until the next begins.
        vehicles: the vehicles under test of the current drive, and of the last one until the next begins.
        traffic: how many others the drive has had, once it is over.
    """

    def __init__(
        self,
        simulator: Simulator,
        spec: EpisodeSpec,
        *,
        towns: Towns | None = None,
        drivers: Sequence[DriverSetup] = (DriverSetup(),),
        folder: Path = Path(),
    ) -> None:
        """Describe an episode with a vehicle under test for each driver; the simulator gets no call yet.

        ``towns`` are shared by all episodes of a simulator. ``folder`` is the run's.
        """
        self._simulator, self._spec = simulator, spec
        self._towns = towns
        self._drivers = tuple(drivers)
        self._folder = folder
        self._resources = contextlib.ExitStack()
        self._shared: list[BaseManager] = []  # managers of all vehicles that are set up
        self._traffic: TrafficManager | None = None
        self._sumo: CoSimulation | None = None
        self._leaving: list[VehicleUnderTest] = []
        self._prepared = False  # the vehicles stand at their starts, and the drive is still to come
        self._laid = False  # the ground is new
        self._snapshot: carla.WorldSnapshot | None = None  # the latest of the drive
        self._tick = 0  # of it
        self.ground: Ground | None = None
        self.vehicles: tuple[VehicleUnderTest, ...] = ()
        self.traffic: dict[str, int] = {"vehicles": 0, "walkers": 0}

    # -- the beginning

    def lay(self) -> Ground:
        """Load the town, plan the route, and lay the scenarios on it; the vehicles are still to come.

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
        """Put each vehicle at the start of its route; ``reset`` does so by itself where this was not called.

        ``folder``, where the run is written, may be given now if it was not known before.

        Raises:
            UserError: a vehicle, the route or a scenario has no place in the world.
            SimulatorError: the simulator failed.
        """
        ground = self.ground if self.ground is not None and self._laid else self.lay()
        self._laid = False
        spec, world = self._spec, ground.world
        routes = [beginning_at(ground.route, driver.start_m) for driver in self._drivers]
        placed: list[_Placed] = []
        try:
            with asking("getting the vehicle ready"):
                self._resources.enter_context(ticked_by_us(world, spec.step_s))
                if not self._simulator.own:
                    world.reset_all_traffic_lights()  # nothing was loaded anew: they show what the drive before left
                for driver, route in zip(self._drivers, routes, strict=True):
                    stack = contextlib.ExitStack()
                    self._resources.callback(stack.close)
                    config = driver.config or spec.config
                    actor = stack.enter_context(spawned_at_start(world, route, config.vehicle, driver.role))
                    placed.append(_Placed(driver, config, route, actor, stack.close))
                settle(world)
                world.set_weather(spec.weather)
                if not spec.is_case:
                    ground.scenarios.try_out(self._simulator.client, world)
        except BaseException:
            self.close()
            raise
        below = self._folder if folder is None else folder
        self.vehicles = tuple(
            VehicleUnderTest(each.driver, self._run(ground, each, number, seed, below), spec, each.remove)
            for number, each in enumerate(placed, 1)
        )
        self._prepared = True

    def _run(self, ground: Ground, placed: _Placed, number: int, seed: int, folder: Path) -> Run:
        """Return the data of a vehicle's drive; ``number`` counts from 1, ``seed`` and ``folder`` are the run's."""
        spec = self._spec
        return Run(
            client=self._simulator.client,
            world=ground.world,
            carla_map=ground.town.carla_map,
            vehicle=placed.actor,
            route=placed.route,
            config=placed.config,
            step_s=spec.step_s,
            seed=seed_of(seed, number),
            timeout_s=spec.timeout_s,
            folder=folder / placed.driver.folder,
            server_address=self._simulator.address,
            own_simulator=self._simulator.own,
            gates=self._simulator.gates,
            weather=spec.weather_along if number == 1 else (),
            neighbours=Neighbours(ground.world, placed.actor.id),
            changes=WorldChanges(control=carla.VehicleControl(brake=1.0), weather=spec.weather),
        )

    def reset(self, seed: int | None = None) -> None:
        """Begin a drive with its first frame; the drive before is closed.

        A vehicle has its outcome already if its agent is not ready. ``seed`` may be left out where ``prepare`` was
        given it, and is 0 otherwise.

        Raises:
            UserError, SimulatorError: it cannot begin, see ``prepare``; or a manager is not ready.
        """
        if not self._prepared:
            self.prepare(seed or 0)
        self._prepared = False
        ground = self.ground
        assert ground is not None, "it is prepared"
        self._snapshot, self._tick = None, 0
        first = self.vehicle
        ground.scenarios.join(first.routes, first.metrics)
        self._traffic = TrafficManager(self._spec.traffic, self._reserved_m(ground))
        self._sumo = None if self._spec.sumo is None else _cosimulation(self._spec.sumo, first.routes)
        for manager in (self._traffic, *(() if self._sumo is None else (self._sumo,))):
            self._shared.append(manager)
            manager.setup(first.run)
        for vehicle in self.vehicles:
            try:
                vehicle.set_up((ground.scenarios,) if vehicle is first else ())
            except AgentError as error:  # noqa: PERF203 - once for each vehicle
                self.fail(error, vehicle)
        if self.driving:
            self._observe()

    def _reserved_m(self, ground: Ground) -> list[tuple[float, float]]:
        """Return the places that traffic leaves free.

        A case's actors come after it, and all of them must come. The traffic itself keeps away from the first vehicle.

        Raises:
            ScenarioError: the case has no place on its route.
        """
        if self._spec.traffic.is_empty:
            return []
        starts_m = [vehicle.run.route.points_m[0] for vehicle in self.vehicles[1:]]
        reserved_m = [(float(x_m), float(y_m)) for x_m, y_m, _ in starts_m]
        if self._spec.is_case:
            ground.scenarios.lay(ground.route, ground.town.carla_map)
            reserved_m += ground.scenarios.reserved_m()
        return reserved_m

    # -- the drive

    @property
    def driving(self) -> list[VehicleUnderTest]:
        """The vehicles that drive: those without an outcome."""
        return [vehicle for vehicle in self.vehicles if vehicle.outcome is None]

    def step(self, answers: Sequence[DriverResponse | None]) -> None:
        """Record the current frame with the answers, apply the controls, and let the simulator make the next frame.

        ``answers`` has one for each vehicle that waits for it, in the order of ``vehicles``; None for the others. An
        outcome that a vehicle has afterwards belongs to the frame that was just recorded. Where no vehicle goes on,
        the simulator makes no frame.

        Raises:
            UserError, SimulatorError: the drive cannot go on; ``fail`` says what that means for its outcome.
        """
        waiting, ground = [vehicle for vehicle in self.vehicles if vehicle.waits], self.ground
        if not waiting or ground is None:
            raise UserError("this episode does not wait for a control; call reset() first")
        for vehicle, answer in zip(self.vehicles, answers, strict=True):
            if vehicle.waits:
                self._take(vehicle, answer, ground.scenarios)
        if not self.driving:
            return
        # A simulator that has ended gets no further step: the Traffic Manager's thread in the official client would run
        # into its own time-out meanwhile, and that ends the whole process.
        if self._simulator.ended():
            raise SimulatorError("the simulator ended")
        self._apply(ground.scenarios)
        for vehicle in waiting:
            if vehicle.outcome is not None:
                self._send_away(vehicle)
        self._observe()

    def _take(self, vehicle: VehicleUnderTest, answer: DriverResponse | None, scenarios: ScenarioManager) -> None:
        """Take an answer of one vehicle, and judge whether its drive is over.

        Raises:
            UserError, SimulatorError: the drive cannot go on.
        """
        if answer is None:
            raise UserError(f"the vehicle '{vehicle.role}' waits for an answer; give one for each vehicle")
        vehicle.take(answer)
        ended_by_scenario = None
        if vehicle is self.vehicle:
            scenarios.tick(vehicle.observation.frame)
            ended_by_scenario = scenarios.outcome
        vehicle.outcome = vehicle.routes.outcome or ended_by_scenario

    def _apply(self, scenarios: ScenarioManager) -> None:
        """Give each vehicle that drives its control, and let SUMO make its part of the next step."""
        for vehicle in self.driving:
            vehicle.record_applied(scenarios.through if vehicle is self.vehicle else lambda control: control)
        if self._sumo is not None:
            self._sumo.tick(self.driving[0].observation.frame)
        for vehicle in self.driving:
            vehicle.apply()

    def _observe(self) -> None:
        """Make the next frame, and let each vehicle that drives take it in."""
        run = self.vehicle.run
        is_first = self._snapshot is None
        self._snapshot = snapshot = next_snapshot(run, self._snapshot)
        self._tick = 0 if is_first else self._tick + 1
        for vehicle in self.driving:
            try:
                vehicle.see(snapshot, self._tick)
            except AgentError as error:  # noqa: PERF203 - once for each vehicle
                self.fail(error, vehicle)
        for vehicle in [each for each in self._leaving if each.parts()]:
            self._leaving.remove(vehicle)
            time.sleep(LATE_EVENTS_S)
            vehicle.make_history(self._sumo_record(vehicle))
            vehicle.leave()

    def _send_away(self, vehicle: VehicleUnderTest) -> None:
        """Let a vehicle stop where it is and leave the world a few steps later: its drive is over."""
        vehicle.halt()
        self._leaving.append(vehicle)

    # -- the end

    def fail(self, error: BaseException, vehicle: VehicleUnderTest | None = None) -> Outcome:
        """Classify what ended the drive of ``vehicle``, or of each that drives without it, and set the outcomes.

        Raises:
            BaseException: ``error`` itself, where it is neither an exception nor the user's interruption.
        """
        ended = self.driving if vehicle is None else [vehicle]
        outcome = outcome_of(error, self._simulator.why_gone)
        for each in ended:
            each.fail(error, outcome)
        if vehicle is not None and self.driving:
            self._send_away(vehicle)
        return outcome

    def end(self) -> None:
        """Make the record of each vehicle, ``history``, and close everything.

        The last frame's events may be under way still: one more step, which is not recorded, and a moment bring them.
        """
        if self._traffic is not None:
            run, outcomes = self.vehicle.run, [vehicle.outcome for vehicle in self.vehicles]
            if any(outcome is not None and outcome.status is Status.SIMULATOR_FAILED for outcome in outcomes):
                run.client.set_timeout(FAILED_TIMEOUT_S)
            unrecorded = [vehicle for vehicle in self.vehicles if vehicle.history is None and vehicle.metrics.ticks]
            if unrecorded:
                with contextlib.suppress(RuntimeError):  # the simulator is gone, and sends no more events
                    run.world.tick(run.timeout_s)
                    time.sleep(LATE_EVENTS_S)
            for vehicle in unrecorded:
                vehicle.make_history(self._sumo_record(vehicle))
        self.close()

    def close(self) -> None:
        """Put away managers, vehicles and settings; may be called at any time and more than once."""
        for vehicle in reversed(self.vehicles):
            vehicle.close()
        while self._shared:
            self._shared.pop().close()
        if self._traffic is not None:
            self.traffic = dict(self._traffic.count)
            if self._sumo is not None:
                self.traffic = {kind: n + self._sumo.count[kind] for kind, n in self.traffic.items()}
        self._traffic = self._sumo = None
        self._leaving.clear()
        self._prepared = self._laid = False
        self._resources.close()

    def _sumo_record(self, vehicle: VehicleUnderTest) -> SumoRecord | None:
        """Return the record of SUMO's traffic, which is written with that of the first vehicle."""
        return None if self._sumo is None or vehicle is not self.vehicle else self._sumo.record()

    # -- what it has found

    @property
    def vehicle(self) -> VehicleUnderTest:
        """The first vehicle under test, mostly the only one.

        Raises:
            UserError: no vehicle stands in the world yet.
        """
        if not self.vehicles:
            raise UserError("this episode has no vehicle yet; call reset() first")
        return self.vehicles[0]

    @property
    def is_case(self) -> bool:
        """Whether the episode begins and ends with one scenario."""
        return self._spec.is_case

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
