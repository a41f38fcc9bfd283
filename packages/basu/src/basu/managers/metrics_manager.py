"""`MetricsManager`: records frames, collisions and lane invasions of a run; gives infractions and scores so far."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import carla

from basu.errors import SimulatorError
from basu.managers.base_manager import BaseManager
from basu.managers.observations import Neighbours, RouteLights, vehicle_of
from basu.metrics.incremental import SoFar
from basu.records.history import Collision, Facts, LaneInvasion, Recorder
from basu.records.history.model import NO_LIGHT

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.managers.base_manager import DriverState, Frame, Run
    from basu.managers.routes_manager import RoutesManager
    from basu.metrics.infraction import Evidence
    from basu.metrics.score import Scores
    from basu.metrics.scoring import Scoring
    from basu.records.history import History

MPS_PER_KMH = 1.0 / 3.6


class MetricsManager(BaseManager):
    """Records the run with a collision sensor of its own, and a lane-invasion sensor unless switched off.

    For that one the client reads the whole map, which of Linden's takes it 0.4 s in every world that it has begun anew.
    """

    def __init__(
        self, agents: DriverState, routes: RoutesManager, scoring: Scoring, *, lane_invasions: bool = True
    ) -> None:
        self._agents, self._routes, self._lane_invasions = agents, routes, lane_invasions
        self._so_far, self._looked_at_ticks = SoFar(scoring), 0
        self._recorder = Recorder()
        self._sensors: list[Any] = []
        self._events: list[tuple[int, Callable[[int], None]]] = []  # server frame, and what records it by tick
        self._events_lock = threading.Lock()
        self._first_frame: int | None = None

    @property
    def ticks(self) -> int:
        """How many frames are recorded."""
        return self._recorder.ticks

    @property
    def first_frame(self) -> int | None:
        """The server's number of the first recorded frame."""
        return self._first_frame

    def setup(self, run: Run) -> None:
        """Attach the benchmark's own sensors."""
        self._run = run
        self._neighbours = run.neighbours or Neighbours(run.world, run.vehicle.id)
        self._vehicle = vehicle_of(run.vehicle)
        self._lights = RouteLights(run.world, run.route, self._vehicle.rear_m)
        library = run.world.get_blueprint_library()
        heard: dict[str, Callable[[Any], None]] = {"sensor.other.collision": self._hear_collision}
        if self._lane_invasions:
            heard["sensor.other.lane_invasion"] = self._hear_lane_invasion
        for name, hear in heard.items():
            try:
                sensor = run.world.spawn_actor(library.find(name), carla.Transform(), attach_to=run.vehicle)
                self._sensors.append(sensor)
                sensor.listen(hear)
            except RuntimeError as error:  # noqa: PERF203 - two sensors, once a run
                raise SimulatorError(f"the benchmark's own {name} cannot be attached: {error}") from error

    def tick(self, frame: Frame) -> None:
        """Record a frame."""
        if self._first_frame is None:
            self._first_frame = frame.server_frame
        vehicle, progress = self._run.vehicle, self._routes.progress
        light = int(vehicle.get_traffic_light_state()) if vehicle.is_at_traffic_light() else NO_LIGHT
        self._recorder.frame(
            (
                frame.tick,
                frame.tick * self._run.step_s,
                *frame.ego,
                *_values(self._agents.requested),
                *_values(self._agents.control),
                vehicle.get_speed_limit() * MPS_PER_KMH,
                light,
                progress.s_m,
                progress.lateral_m,
                self._lights.next_state(progress.s_m),
                self._agents.manual,
                *self._routes.lane,
            )
        )
        self._recorder.others(self._neighbours.near(frame))

    def applied(self, control: carla.VehicleControl) -> None:
        """Record the control that the vehicle is given in the latest frame, where a scenario has changed it."""
        self._recorder.applied(_values(control))

    def close(self) -> None:
        """Take the sensors away."""
        while self._sensors:
            sensor = self._sensors.pop()
            try:
                sensor.stop()
                sensor.destroy()
            except RuntimeError:
                continue  # the simulator is gone, and the sensors with it

    def history(self) -> History:
        """The record until now."""
        self._take_events()
        return self._recorder.history(self._facts())

    def others(self, frame: Frame) -> list[tuple[float, ...]]:
        """Rows of ``history.OTHER`` for a frame, recorded or not yet, the nearest road user first."""
        return self._neighbours.near(frame)

    def contacts_since(self, tick: int) -> tuple[Collision, ...]:
        """The messages of the collision sensor from a tick on; cheap for the latest ones."""
        self._take_events()
        return self._recorder.contacts_since(tick)

    def infractions_so_far(self) -> tuple[Evidence, ...]:
        """Every infraction until now; cheap enough for each second of the longest run."""
        self._look()
        return self._so_far.infractions

    def scores_so_far(self) -> Scores:
        """The scores until now, the way ahead counted as not driven; as cheap."""
        self._look()
        return self._so_far.scores

    def _look(self) -> None:
        """Take what is new into account, once a frame."""
        if self.ticks == self._looked_at_ticks:
            return
        self._looked_at_ticks = self.ticks
        self._take_events()
        facts = self._facts()
        self._so_far.advance(lambda first: self._recorder.window(first, facts))

    def _facts(self) -> Facts:
        """What does not change, as far as it is known."""
        return Facts(
            step_s=self._run.step_s,
            vehicle=self._vehicle,
            route=self._run.route,
            actor_types=dict(self._neighbours.met),
            actor_sizes=dict(self._neighbours.sizes),
        )

    def _take_events(self) -> None:
        """Move what the client's threads have brought into the record, by tick."""
        with self._events_lock:
            events, self._events = self._events, []
        for server_frame, event in events:
            event(server_frame - (self._first_frame or 0))

    def _later(self, server_frame: int, record: Callable[[int], None]) -> None:
        """Keep an event until the recorder is free; called on threads of the client."""
        with self._events_lock:
            self._events.append((server_frame, record))

    def _hear_collision(self, event: carla.CollisionEvent) -> None:
        """Record one frame of a contact, once the tick of its frame is known."""
        other_id, other_type = event.other_actor.id, event.other_actor.type_id
        impulse_ns = (event.normal_impulse.x, event.normal_impulse.y, event.normal_impulse.z)

        def record(tick: int) -> None:
            self._recorder.collision(
                Collision(tick=tick, other_id=other_id, other_type=other_type, impulse_ns=impulse_ns)
            )

        self._later(event.frame, record)

    def _hear_lane_invasion(self, event: carla.LaneInvasionEvent) -> None:
        """Record the markings that the vehicle crossed, once the tick of their frame is known."""
        markings = tuple(sorted(f"{marking.type}/{marking.color}" for marking in event.crossed_lane_markings))

        def record(tick: int) -> None:
            self._recorder.lane_invasion(LaneInvasion(tick=tick, markings=markings))

        self._later(event.frame, record)


def _values(control: carla.VehicleControl) -> tuple[float, ...]:
    """A control in the order of ``history.CONTROL``."""
    return (control.throttle, control.steer, control.brake, float(control.hand_brake), float(control.reverse))
