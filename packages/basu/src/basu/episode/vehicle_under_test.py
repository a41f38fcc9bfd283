"""`VehicleUnderTest`: one vehicle of an episode, with what drives and watches it, its record, and the end of its drive.

An episode has one or more of them in one world. Each has a route, a record and an outcome of its own. The town, the
clock, the weather, the traffic and the scenarios belong to the episode.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import carla

from basu.conditions import ROLE
from basu.episode.world import frame_in
from basu.errors import AgentError, UserError
from basu.managers import Live
from basu.managers.base_manager import DriverState
from basu.managers.metrics_manager import MetricsManager
from basu.managers.routes_manager import RoutesManager
from basu.managers.sensors_manager import PARTING_TICKS, SensorsManager
from basu.outcome import Outcome, Status

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.agents.autonomous_agent import AgentConfig
    from basu.episode.spec import EpisodeSpec
    from basu.managers.base_manager import BaseManager, Frame, Run
    from basu.records.history import History
    from basu.records.history.sumo import SumoRecord
    from basu.routing.planned_route import Progress


@dataclass(frozen=True, slots=True, kw_only=True)
class DriverSetup:
    """What drives one vehicle under test and what watches it.

    ``sensors`` makes the sensors for one drive.

    ``participants`` are set up before them and are not ticked.

    ``observers`` makes managers that change nothing and are ticked after all others but the scenarios.

    ``interlock`` changes the driver's control on its way to the vehicle, as open doors hold the brake.
    """

    role: str = ROLE  # `role_name` of the vehicle
    start_m: float = 0.0  # along the episode's route, where this vehicle's own route begins
    config: AgentConfig | None = None  # None: the episode's
    folder: str = ""  # below the run's folder, for files of this drive; "": the run's folder itself
    sensors: Callable[[], SensorsManager] = lambda: SensorsManager((), "")
    participants: Sequence[BaseManager] = ()
    observers: Callable[[Live], Sequence[BaseManager]] = lambda _live: ()
    interlock: Callable[[carla.VehicleControl], carla.VehicleControl] = lambda control: control


SEEDS_APART = 10_007
"""Between the seeds of two vehicles of a run: more than a series has drives, each of which has the next seed."""


def seed_of(seed: int, number: int) -> int:
    """Return the seed of the agent and the sensors of a vehicle in a run with ``seed``; ``number`` counts from 1."""
    return seed + SEEDS_APART * (number - 1)


class Observation(NamedTuple):
    """One frame before its control is known."""

    frame: Frame
    sensor_data: dict[str, tuple[int, Any]]  # the latest measurement of each sensor, with its frame
    progress: Progress  # along the route
    driven_m: float  # of the route, validly
    in_lane: bool  # whether place and direction are those of the route


class DriverResponse(NamedTuple):
    """What a driver answers to an observation."""

    control: carla.VehicleControl
    requested: carla.VehicleControl | None = None  # the agent's own, where a person gave ``control``; None: the same
    manual: bool = False  # a person gave the control


class VehicleUnderTest:
    """A vehicle in one drive.

    Attributes:
        run: client, world, vehicle and route.
        metrics: the record while the drive lasts.
        outcome: how the drive ended. None while it goes on.
        history: the whole record, once the drive is over and the record is made.
        bug: an error of the benchmark itself.
        agent_error: what the agent failed with.
    """

    def __init__(self, driver: DriverSetup, run: Run, spec: EpisodeSpec, remove: Callable[[], None]) -> None:
        """Describe a vehicle that stands at its start; ``remove`` takes it out of the world."""
        self._driver, self.run, self._remove = driver, run, remove
        self._state = DriverState()
        self.routes = RoutesManager(spec.stop_after_s)
        self.metrics = MetricsManager(self._state, self.routes, spec.scoring, lane_invasions=spec.lane_invasions)
        self._sensors = driver.sensors()
        self._set_up: list[BaseManager] = []
        self._observers: tuple[BaseManager, ...] = ()
        self._observation: Observation | None = None
        self._is_recorded = True  # whether the frame of the observation is in the record
        self._parting_ticks = 0  # since `halt`
        self.outcome: Outcome | None = None
        self.history: History | None = None
        self.bug: Exception | None = None
        self.agent_error: AgentError | None = None

    # -- its state

    @property
    def role(self) -> str:
        """The role of the vehicle in the world."""
        return self._driver.role

    @property
    def observation(self) -> Observation:
        """The latest frame of the drive.

        Raises:
            UserError: there has been none.
        """
        if self._observation is None:
            raise UserError("this episode has no frame yet; call reset() first")
        return self._observation

    @property
    def waits(self) -> bool:
        """Whether the drive goes on and waits for an answer to its observation."""
        return self.outcome is None and not self._is_recorded

    @property
    def ending(self) -> Outcome | None:
        """The outcome; before that, the outcome that the frame of the observation brings, whatever its control."""
        return self.outcome or self.routes.outcome

    @property
    def first_frame(self) -> int | None:
        """The server's number of the first recorded frame."""
        return self.metrics.first_frame

    # -- the drive

    def set_up(self, shared: Sequence[BaseManager]) -> None:
        """Set up what drives and watches it; ``shared`` are managers of the episode that need its record.

        Raises:
            UserError, SimulatorError: a manager is not ready.
            AgentError: a participant is not ready.
        """
        self._observers = tuple(self._driver.observers(Live(self._state, self._sensors, self.routes, self.metrics)))
        # participants before sensors: another program's agent says only once it is set up what it wants to sense
        parts = (*self._driver.participants, self._sensors, self.routes, self.metrics, *shared, *self._observers)
        for manager in parts:
            self._set_up.append(manager)
            manager.setup(self.run)

    def see(self, snapshot: carla.WorldSnapshot, tick: int) -> None:
        """Take in the next frame: wait for its sensors, and advance along the route.

        Raises:
            AgentError: the vehicle is gone from a world that only agents and the benchmark change.
            SimulatorError: it is gone from another one, or a sensor is silent.
        """
        frame = frame_in(snapshot, tick, self.run)
        self._sensors.tick(frame)
        self.routes.tick(frame)
        routes = self.routes
        self._observation = Observation(
            frame, self._sensors.data, routes.progress, routes.valid.driven_m, routes.valid.check.in_lane
        )
        self._is_recorded = False

    def take(self, answer: DriverResponse) -> None:
        """Record the frame of the observation with its answer, and show it.

        Raises:
            UserError, SimulatorError: a manager cannot go on.
        """
        self._state.control, self._state.manual = answer.control, answer.manual
        self._state.requested = answer.control if answer.requested is None else answer.requested
        self._record()
        frame = self.observation.frame
        self.routes.change_weather(frame)
        for observer in self._observers:
            observer.tick(frame)

    def record_applied(self, through: Callable[[carla.VehicleControl], carla.VehicleControl]) -> None:
        """Record the control that the vehicle is to be given: the answer's, after ``through`` and the interlock."""
        self.run.changes.control = applied = self._driver.interlock(through(self._state.control))
        self.metrics.applied(applied)

    def apply(self) -> None:
        """Give the vehicle its control for the step to the next frame."""
        self.run.vehicle.apply_control(self.run.changes.control)

    def _record(self) -> None:
        if not self._is_recorded:
            self._is_recorded = True
            self.metrics.tick(self.observation.frame)

    # -- the end

    def fail(self, error: BaseException, outcome: Outcome) -> None:
        """Set the outcome that ``error`` brings; what the agent failed in is recorded as well."""
        with contextlib.suppress(RuntimeError):  # the simulator is gone
            self._record()
        if isinstance(error, AgentError):
            self.agent_error = error
        if outcome.status is Status.BENCHMARK_FAILED and isinstance(error, Exception):
            self.bug = error
        self.outcome = outcome

    def halt(self) -> None:
        """Brake, and listen to no sensor any more: the drive is over, and others go on in this world."""
        with contextlib.suppress(RuntimeError):
            self.run.vehicle.apply_control(carla.VehicleControl(brake=1.0))
        self._guarded(self._sensors.stop)

    def parts(self) -> bool:
        """Count a step of the world since `halt`; whether nothing of the drive is under way any more."""
        self._parting_ticks += 1
        return self._parting_ticks >= PARTING_TICKS

    def make_history(self, sumo: SumoRecord | None) -> None:
        """Make the whole record, if anything was driven."""
        if self.history is None and self.metrics.ticks:
            self.history = replace(self.run.numbering.applied(self.metrics.history()), sumo=sumo)

    def close(self) -> None:
        """Put away what drives and watches it; an agent's error in that joins the outcome."""
        while self._set_up:
            self._guarded(self._set_up.pop().close)

    def leave(self) -> None:
        """Close it, and take it out of the world in which others go on."""
        self.close()
        self._remove()

    def _guarded(self, put_away: Callable[[], None]) -> None:
        try:
            put_away()
        except AgentError as error:
            if self.outcome is not None:  # the drive is over and keeps its status
                self.outcome = self.outcome._replace(message=f"{self.outcome.message}; afterwards {error}")
