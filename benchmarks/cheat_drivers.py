"""Drivers that cheat by where and how they drive. Each docstring says what it tries; see ``cheats.py``.

basu run benchmarks/cheat_drivers.py:OppositeLaneAtLines --routes benchmarks/cheats.xml
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import carla
import numpy as np

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.builtin.behavioral import BehavioralAgent

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

WHEELBASE_M, AHEAD_M, SPEED_MPS = 2.8, 5.0, 6.0
LEFT_M = -3.4  # the middle of the oncoming lane
ROUNDABOUT_M = (566.4, -376.4)  # its middle, on the route of cheats.xml


class Honest(BehavioralAgent):
    """Drives as ``behavioral``: what a cheat is compared with, and the base of drivers that do something more."""

    def config(self) -> dict[str, str]:
        return {}


class Polyline(AutonomousAgent):
    """Pure pursuit along a line of its own, at a speed of its own, without a look at anything."""

    slows = True

    def setup(self) -> None:
        self.most_steer_rad = math.radians(self.vehicle.get_physics_control().wheels[0].max_steer_angle)
        self.line = self.way()
        self.at = self.steps = 0

    def config(self) -> dict[str, str]:
        return {}

    def way(self) -> NDArray[np.float64]:
        """Return the line to drive, (N, 2) in m."""
        return self.beside(lambda _: 0.0)

    def beside(self, offset_m: Any) -> NDArray[np.float64]:  # noqa: ANN401 - a function of the place along the route
        """Return the route, shifted to the right by ``offset_m(s_m)``."""
        assert self.route is not None
        right = np.column_stack([-np.sin(self.route.yaw_rad), np.cos(self.route.yaw_rad)])
        return self.route.points_m[:, :2] + right * np.array([[offset_m(s)] for s in self.route.s_m])

    def speed_mps(self) -> float:
        """Return the speed that it wants now."""
        return SPEED_MPS

    @property
    def s_m(self) -> float:
        """The place along its own line: a point a metre."""
        return float(self.at)

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        del sensor_data
        self.steps += 1
        pose, now_mps = self.vehicle.get_transform(), self.vehicle.get_velocity().length()
        here = (pose.location.x, pose.location.y)
        near = self.line[self.at : self.at + 12]
        self.at += int(np.hypot(*(near - here).T).argmin())
        x_m, y_m = self.line[min(self.at + round(AHEAD_M), len(self.line) - 1)]
        bearing_rad = math.atan2(y_m - here[1], x_m - here[0]) - math.radians(pose.rotation.yaw)
        steer = math.atan(2.0 * math.sin(bearing_rad) * WHEELBASE_M / AHEAD_M) / self.most_steer_rad
        wanted_mps = self.speed_mps()
        if self.slows and abs(steer) > 0.3:
            wanted_mps = min(wanted_mps, 3.0)
        push = 0.6 * (wanted_mps - now_mps)
        if wanted_mps <= 0.0:
            return carla.VehicleControl(brake=1.0, steer=max(-1.0, min(1.0, steer)))
        return carla.VehicleControl(
            throttle=max(0.0, min(1.0, push)), brake=max(0.0, min(1.0, -push)), steer=max(-1.0, min(1.0, steer))
        )


def through(*points_m: tuple[float, float]) -> NDArray[np.float64]:
    """Return points a metre apart on straight lines through the given ones."""
    legs = [np.linspace(one, two, max(2, round(math.dist(one, two)))) for one, two in pairwise(points_m)]
    return np.vstack(legs)


def bump(from_m: float, to_m: float, offset_m: float) -> Any:  # noqa: ANN401 - a function
    """Return the offset that is ``offset_m`` between two places, with 6 m to get there."""
    return lambda s: offset_m * float(np.interp(s, [from_m - 6, from_m, to_m, to_m + 6], [0, 1, 1, 0]))


# -- named in issue 24


class OppositeLaneAtLines(Polyline):
    """Takes the opposite lane at each stop line, without a stop."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        lines_m = [control.s_m for control in self.route.controls]
        return self.beside(lambda s: sum(bump(line - 14, line + 4, LEFT_M)(s) for line in lines_m))


class FourMetresLeft(Polyline):
    """Drives the whole route 4 m left."""

    def way(self) -> NDArray[np.float64]:
        return self.beside(lambda s: -4.0 * min(1.0, s / 8.0))


class FarBeside(Polyline):
    """Drives 29 m beside the road, and rests beside the service stop."""

    def way(self) -> NDArray[np.float64]:
        return self.beside(lambda s: 29.0 * min(1.0, s / 30.0))


class OverTheBlock(Polyline):
    """Leaves a block of the route out, straight across."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        points = self.route.points_m[:, :2]
        return np.vstack([points[:150], through(tuple(points[150]), tuple(points[250])), points[250:]])


class RoundaboutBackwards(Polyline):
    """Takes the roundabout backwards."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        points, (x, y) = self.route.points_m[:, :2], ROUNDABOUT_M
        turn = np.radians(np.linspace(90.0, 360.0, 40))  # over the west; y points south
        ring = np.column_stack([x + 8.5 * np.cos(turn), y + 8.5 * np.sin(turn)])
        return np.vstack([points[:108], ring, points[137:]])


class RoundTheConflict(Polyline):
    """Goes round the conflict of a case, off the road."""

    def way(self) -> NDArray[np.float64]:
        return self.beside(bump(25.0, 90.0, 7.0))


class PastTheSigns(Polyline):
    """Passes stop signs without a stop, and else drives well."""


class ThreeTimesTheLimit(Polyline):
    """Drives as fast as the vehicle goes."""

    slows = False

    def speed_mps(self) -> float:
        return 40.0


class TwoPoints(Honest):
    """Gives itself a route of two points 10 m apart."""

    def get_initial_route_locations(self) -> list[tuple[float, float, float]]:
        return [(562.0, -249.1, 250.6), (562.5, -259.1, 250.6)]


class OtherConditions(Honest):
    """Wishes for another route, vehicle and weather."""

    def config(self) -> dict[str, str]:
        return {"routes": "routes/linden_short.xml", "vehicle": "vehicle.tesla.model3", "weather": "ClearNoon"}


class ByHand(Honest):
    """Says that a person drives."""

    manual = True


class DiesAtOnce(Honest):
    """Fails in its first step, while nothing has gone wrong yet."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        del sensor_data
        raise RuntimeError("no step")


# -- not named


class ReversesAlong(Polyline):
    """Turns round and drives the route backwards, in reverse."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        del sensor_data
        self.steps += 1
        if self.steps < 140:  # a turn on the spot, as tight as it goes
            return carla.VehicleControl(throttle=0.4, steer=1.0)
        return carla.VehicleControl(throttle=0.4, reverse=True)


class StopsShort(Honest):
    """Stops where no conflict begins and waits for the end."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        moved = self.route is not None and math.dist(
            self.route.points_m[0, :2], (self.vehicle.get_location().x, self.vehicle.get_location().y)
        )
        return carla.VehicleControl(brake=1.0, steer=control.steer) if moved and moved > 8.0 else control


class Crawls(Honest):
    """Drives at 0.6 m/s, so that partners have gone by."""

    cruise_mps = 0.6

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        if self.vehicle.get_velocity().length() > self.cruise_mps:
            control.throttle, control.brake = 0.0, max(control.brake, 0.3)
        return control


class WaitsThenRuns(Honest):
    """Stands until the scenario's partner must have gone, then drives to the end."""

    wait_steps = 500

    def setup(self) -> None:
        super().setup()
        self.steps = 0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        self.steps += 1
        control = super().run_step(sensor_data)
        return carla.VehicleControl(brake=1.0) if self.steps < self.wait_steps else control


class Shuttles(Polyline):
    """Drives back and forth over the first stop line's approach, so that it has stopped there many times."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        phase = self.steps % 160
        if 500 < self.steps < 1400 and phase >= 80:
            return carla.VehicleControl(throttle=0.4, reverse=True)
        return control


class Circles(Polyline):
    """Drives circles beside the service stop, for length and service."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        points = self.route.points_m[:, :2]
        x, y = points[173]
        turn = np.radians(np.tile(np.linspace(180.0, 540.0, 45), 6))
        rings = np.column_stack([x + 7.0 + 7.0 * np.cos(turn), y + 7.0 * np.sin(turn)])
        return np.vstack([points[:173], rings, points[174:]])


class OneWheelInLane(Polyline):
    """Drives beside its lane with one wheel in it."""

    def way(self) -> NDArray[np.float64]:
        return self.beside(lambda s: 2.4 * min(1.0, s / 8.0))


class StopsBesideTheLine(Polyline):
    """Rests off the road beside each line and stop, where it is in the way of no one."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        places_m = [place.s_m for place in (*self.route.controls, *self.route.stops)]
        return self.beside(lambda s: sum(bump(place - 8, place + 1, 3.5)(s) for place in places_m))

    def speed_mps(self) -> float:
        assert self.route is not None
        for place in (*self.route.controls, *self.route.stops):
            if 0.0 < place.s_m - 2.0 - self.s_m < 1.5 and self.vehicle.get_velocity().length() > 0.05:
                return 0.0
        return SPEED_MPS


class Weaves(Polyline):
    """Weaves within the bounds of the lane, so that its path is longer than the plan."""

    def way(self) -> NDArray[np.float64]:
        return self.beside(lambda s: 0.9 * math.sin(s / 3.0))


class SkipsTheEnd(Polyline):
    """Drives fast to the end over the lawn beside the last stop sign's junction."""

    def way(self) -> NDArray[np.float64]:
        assert self.route is not None
        points = self.route.points_m[:, :2]
        return np.vstack([points[:335], through(tuple(points[335]), tuple(points[395])), points[395:]])


class TooMuchControl(Polyline):
    """Answers with controls far beyond their bounds, negative brakes among them."""

    slows = False

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        return carla.VehicleControl(throttle=100.0, brake=-50.0, steer=control.steer * 9.0, gear=-1)


class ShiftsByHand(Honest):
    """Holds the engine in a gear that its speed does not fit, for more power."""

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        control = super().run_step(sensor_data)
        control.manual_gear_shift, control.gear = True, 99
        return control
