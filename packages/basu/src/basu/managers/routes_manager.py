"""Progress along the route, its weather, and the outcome that ends a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla

from basu.errors import SimulatorError
from basu.managers.base_manager import BaseManager
from basu.managers.observations import NO_LANE, LaneFinder
from basu.metrics.delays import BLOCKED_MPS, BLOCKED_S, time_limit_s
from basu.metrics.path_following import has_arrived
from basu.metrics.validity import LOST_M, Follower, Moment
from basu.outcome import Outcome, Status
from basu.routing.planned_route import Progress, advance
from basu.routing.weather import weather_at

if TYPE_CHECKING:
    from basu.managers.base_manager import Frame, Run

WEATHER_TICKS = 20  # a second of simulated time, between two changes of weather along the route


class RoutesManager(BaseManager):
    """Follows the vehicle along the route and says when the run is over.

    Attributes:
        progress: The place along the route, wherever the vehicle is.
        lane: The lane under the vehicle.
        valid: The valid progress. Its check says whether the latest frame counts.
        outcome: The end of the run. None while it goes on.
    """

    valid: Follower

    def __init__(self, stop_after_s: float | None = None) -> None:
        """``stop_after_s`` of simulated time ends the drive before its own end."""
        self._stop_after_s = math.inf if stop_after_s is None else stop_after_s
        self.progress = Progress.at_start()
        self.lane = NO_LANE
        self.outcome: Outcome | None = None
        self._moved_tick = 0

    def setup(self, run: Run) -> None:
        """Begin at the beginning."""
        self._route = run.route
        self._lanes, self.valid = LaneFinder(run.carla_map), Follower(run.route)
        self._step_s = run.step_s
        self._limit_s = time_limit_s(run.route)
        self._world, self._weather, self._changes = run.world, run.weather, run.changes
        if self._weather:
            self._set_weather(0.0)

    def tick(self, frame: Frame) -> None:
        """Advance along the route and judge."""
        ego = frame.ego
        self.progress = advance(self._route, self.progress, ego.x_m, ego.y_m)
        self.lane = lane = self._lanes.under(ego)
        self.valid.step(
            Moment(
                route_s_m=self.progress.s_m,
                lateral_m=self.progress.lateral_m,
                x_m=ego.x_m,
                y_m=ego.y_m,
                yaw_rad=ego.yaw_rad,
                velocity_x_mps=ego.velocity_x_mps,
                velocity_y_mps=ego.velocity_y_mps,
                road_id=lane.road_id,
                lane_id=lane.lane_id,
                in_junction=lane.in_junction,
                off_lane_m=lane.off_lane_m,
            )
        )
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
        if self.valid.check.valid and has_arrived(remaining_m, speed_mps):
            return self._end_of_route(tick)
        if tick * self._step_s >= self._stop_after_s - self._step_s / 2.0:
            return Outcome(
                Status.STOPPED,
                f"stopped after {self._stop_after_s:g} s at {self.progress.s_m:.0f} m of the route's "
                f"{self._route.length_m:.0f} m, as --stop-after asks",
            )
        if self.progress.distance_m > LOST_M:
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

    def _end_of_route(self, tick: int) -> Outcome:
        """The outcome of a vehicle at the end of its route, by whichever way it came there."""
        gaps = self.valid.gaps
        if not gaps:
            return Outcome(Status.COMPLETED, f"arrived after {tick * self._step_s:.1f} s")
        longest = max(gaps, key=lambda gap: gap.length_m)
        return Outcome(
            Status.ROUTE_DEVIATION,
            f"came to the end of the route, but did not drive {sum(gap.length_m for gap in gaps):.0f} m of its "
            f"{self._route.length_m:.0f} m on its lanes: {longest.from_s_m:.0f} m to {longest.to_s_m:.0f} m and "
            f"{len(gaps) - 1} shorter pieces",
        )
