"""Joins a service to a drive: watches each vehicle, serves its stops, and holds its brake while its doors are open."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import carla
import numpy as np

from basu.managers.base_manager import BaseManager
from basu.metrics.path_following import SERVED_M, serves
from basu.thresholds import AT_REST_MPS
from basu_service.operation import Seen, Service
from basu_service.plan import stop_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.managers import Live
    from basu.managers.base_manager import Frame, Run
    from basu_service.plan import ServicePlan

TRACE_S = 1.0  # between two places of a vehicle that are kept for the picture


class Trace(NamedTuple):
    """Where a vehicle was, once a second."""

    t_s: float
    place_m: float  # along the round, as `ServicePlan.places_m` has it


class VehicleOperator(BaseManager):
    """The doors of one vehicle, as `basu.running.shuttles.Operator` has it; a manager of its drive as well.

    Attributes:
        trace: where the vehicle was.
        last_s: the time of its latest frame.
    """

    def __init__(self, service: Service, vehicle: int, plan: ServicePlan, beside: Sequence[BaseManager] = ()) -> None:
        """Operate the vehicle at a place in the service, counted from 0; managers ``beside`` watch its drive too."""
        self._service, self._vehicle, self._plan = service, vehicle, plan
        self._beside = tuple(beside)
        self._parked = False
        self._live: Live | None = None
        self._next = 0  # among the stops of its route
        self._called = False  # at that stop
        self.trace: list[Trace] = []
        self.last_s = 0.0

    def managers(self, live: Live) -> Sequence[BaseManager]:
        """Return itself, which watches the drive, and the managers beside it."""
        self._live = live
        return (self, *self._beside)

    def interlock(self, control: carla.VehicleControl) -> carla.VehicleControl:
        """Return the agent's control, or the parking brake while the doors are not closed."""
        if not self._parked:
            return control
        return carla.VehicleControl(steer=control.steer, brake=1.0, hand_brake=True)

    def setup(self, run: Run) -> None:
        """Take the stops of the vehicle's own route."""
        self._stops, self._step_s = run.route.stops, run.step_s
        start_m, places_m = self._plan.starts_m[self._vehicle], dict(self._plan.places_m)
        self._marks_m, self._on_round_m = [0.0], [start_m]  # along its own route, and along the round and on
        for stop in self._stops:
            ahead_m = (places_m[stop_of(stop.id)] - self._on_round_m[-1]) % self._plan.length_m
            if stop.s_m > self._marks_m[-1]:
                self._marks_m.append(stop.s_m)
                self._on_round_m.append(self._on_round_m[-1] + ahead_m)

    def tick(self, frame: Frame) -> None:
        """Serve the stop at which the vehicle rests, and note the stops that it has passed."""
        assert self._live is not None, "the drive asks for its managers first"
        routes, agents = self._live.routes, self._live.agents
        t_s, s_m, speed_mps = frame.tick * self._step_s, routes.progress.s_m, frame.ego.speed_mps
        self.last_s = t_s
        while self._next < len(self._stops) and s_m > self._stops[self._next].s_m + SERVED_M:
            if not self._called:
                self._service.has_passed(t_s, self._vehicle, stop_of(self._stops[self._next].id))
            self._next, self._called = self._next + 1, False
        stop = self._stops[self._next] if self._next < len(self._stops) else None
        counts = routes.valid.check.valid
        here = stop is not None and counts and serves(stop.s_m - s_m, 0.0)
        rests = speed_mps < AT_REST_MPS and counts
        seen = Seen(stop_of(stop.id) if stop is not None and here else None, rests, agents.requested.throttle > 0.0)
        self._parked = self._service.step(t_s, self._vehicle, seen)
        self._called |= self._parked
        if not self.trace or t_s - self.trace[-1].t_s >= TRACE_S - 1e-6:
            on_m = float(np.interp(s_m, self._marks_m, self._on_round_m))
            self.trace.append(Trace(t_s, on_m % self._plan.length_m))

    def close(self) -> None:
        """Nothing was taken."""
