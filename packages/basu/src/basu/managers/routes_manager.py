"""Progress along the route, its weather, and the outcome that ends a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import carla

from basu.errors import SimulatorError
from basu.managers.base_manager import BaseManager
from basu.managers.observations import NO_LANE, LaneFinder
from basu.metrics.delays import BLOCKED_MPS, time_limit_s
from basu.metrics.ending import ARRIVED, BLOCKED, GOES_ON, LEFT_OUT, LOST, STATUS_OF, STOPPED, ending_of
from basu.metrics.path_following import has_arrived
from basu.metrics.validity import Follower, Moment
from basu.outcome import Outcome
from basu.routing.planned_route import Progress, advance
from basu.routing.weather import weather_at

if TYPE_CHECKING:
    from basu.managers.base_manager import Ego, Frame, Run
    from basu.managers.observations import LaneUnder

WEATHER_TICKS = 20  # a second of simulated time, between two changes of weather along the route


def moment_at(ego: Ego, progress: Progress, lane: LaneUnder) -> Moment:
    """Return what decides about a frame: the vehicle's motion, its place along the route, and the lane under it."""
    return Moment(
        route_s_m=progress.s_m,
        lateral_m=progress.lateral_m,
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
        self.valid.step(moment_at(ego, self.progress, lane))
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
        """Do nothing, because the manager took nothing."""

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
        """Return the end of the run, if this is it."""
        remaining_m, t_s = self._route.length_m - self.progress.s_m, tick * self._step_s
        still_s = (tick - self._moved_tick) * self._step_s
        ending = ending_of(
            self.valid.check.valid and has_arrived(remaining_m, speed_mps),
            len(self.valid.gaps),
            self.progress.distance_m,
            still_s,
            t_s,
            self._limit_s,
            self._stop_after_s - self._step_s / 2.0,
        )
        return None if ending == GOES_ON else Outcome(STATUS_OF[ending], self._sentence(ending, t_s, still_s))

    def _sentence(self, ending: int, t_s: float, still_s: float) -> str:
        """Return the end of the run in words."""
        s_m, length_m = self.progress.s_m, self._route.length_m
        if ending == ARRIVED:
            return f"arrived after {t_s:.1f} s"
        if ending == LEFT_OUT:
            gaps = self.valid.gaps
            longest = max(gaps, key=lambda gap: gap.length_m)
            return (
                f"came to the end of the route, but did not drive {sum(gap.length_m for gap in gaps):.0f} m of its "
                f"{length_m:.0f} m on its lanes: {longest.from_s_m:.0f} m to {longest.to_s_m:.0f} m and "
                f"{len(gaps) - 1} shorter pieces"
            )
        if ending == STOPPED:
            return (
                f"stopped after {self._stop_after_s:g} s at {s_m:.0f} m of the route's {length_m:.0f} m, "
                "as --stop-after asks"
            )
        if ending == LOST:
            return f"{self.progress.distance_m:.0f} m off the route at {s_m:.0f} m of its {length_m:.0f} m"
        if ending == BLOCKED:
            return f"stood still for {still_s:.0f} s at {s_m:.0f} m of the route"
        return f"{s_m:.0f} m of {length_m:.0f} m after {self._limit_s:.0f} s"
