"""Progress along the route, its weather, and the outcome that ends a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla

from basu.errors import SimulatorError
from basu.managers.base_manager import BaseManager
from basu.metrics.delays import BLOCKED_MPS, BLOCKED_S, time_limit_s
from basu.metrics.path_following import has_arrived
from basu.outcome import Outcome, Status
from basu.routing.planned_route import Progress, advance
from basu.routing.weather import weather_at

if TYPE_CHECKING:
    from basu.managers.base_manager import Frame, Run

DEVIATION_M = 30.0  # from the route; the CARLA leaderboard's InRouteTest has the same
WEATHER_TICKS = 20  # a second of simulated time, between two changes of weather along the route


class RoutesManager(BaseManager):
    """Follows the vehicle along the route and says when the run is over."""

    def __init__(self, stop_after_s: float | None = None) -> None:
        """``stop_after_s`` of simulated time ends the drive before its own end."""
        self._stop_after_s = math.inf if stop_after_s is None else stop_after_s
        self.progress = Progress.at_start()
        self.outcome: Outcome | None = None  # None while the run goes on
        self._moved_tick = 0

    def setup(self, run: Run) -> None:
        """Begin at the beginning."""
        self._route = run.route
        self._step_s = run.step_s
        self._limit_s = time_limit_s(run.route)
        self._world, self._weather, self._changes = run.world, run.weather, run.changes
        if self._weather:
            self._set_weather(0.0)

    def tick(self, frame: Frame) -> None:
        """Advance along the route and judge."""
        ego = frame.ego
        self.progress = advance(self._route, self.progress, ego.x_m, ego.y_m)
        speed_mps = ego.speed_mps
        if speed_mps >= BLOCKED_MPS:
            self._moved_tick = frame.tick
        self.outcome = self._judge(frame.tick, speed_mps)

    def change_weather(self, frame: Frame) -> None:
        """Set the weather that the route file gives for this place, once a second of simulated time.

        Raises:
            SimulatorError: the simulator does not take it.
        """
        if len(self._weather) > 1 and frame.tick % WEATHER_TICKS == 0:
            self._set_weather(100.0 * self.progress.s_m / self._route.length_m)

    def close(self) -> None:
        """Nothing was taken."""

    def _set_weather(self, percent: float) -> None:
        """Set the weather that the route file has so far along the way."""
        weather = carla.WeatherParameters()
        for name, value in weather_at(self._weather, percent).items():
            setattr(weather, name, value)
        try:
            self._world.set_weather(weather)
            self._changes.weather = weather
        except RuntimeError as error:
            raise SimulatorError(f"the simulator did not take the weather of the route: {error}") from error

    def _judge(self, tick: int, speed_mps: float) -> Outcome | None:
        """The end of the run, if this is it."""
        remaining_m = self._route.length_m - self.progress.s_m
        if has_arrived(remaining_m, speed_mps):
            return Outcome(Status.COMPLETED, f"arrived after {tick * self._step_s:.1f} s")
        if tick * self._step_s >= self._stop_after_s - self._step_s / 2.0:
            return Outcome(
                Status.STOPPED,
                f"stopped after {self._stop_after_s:g} s at {self.progress.s_m:.0f} m of the route's "
                f"{self._route.length_m:.0f} m, as --stop-after asks",
            )
        if self.progress.distance_m > DEVIATION_M:
            return Outcome(
                Status.ROUTE_DEVIATION,
                f"{self.progress.distance_m:.0f} m off the route at {self.progress.s_m:.0f} m of its "
                f"{self._route.length_m:.0f} m",
            )
        still_s = (tick - self._moved_tick) * self._step_s
        if still_s > BLOCKED_S:
            return Outcome(
                Status.ROUTE_BLOCKED, f"stood still for {still_s:.0f} s at {self.progress.s_m:.0f} m of the route"
            )
        if tick * self._step_s > self._limit_s:
            return Outcome(
                Status.ROUTE_TIMEOUT,
                f"{self.progress.s_m:.0f} m of {self._route.length_m:.0f} m after {self._limit_s:.0f} s",
            )
        return None
