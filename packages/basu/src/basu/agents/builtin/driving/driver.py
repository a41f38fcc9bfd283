"""Drivers: combine path, rules and other actors into a control; the behavioral one also overtakes and pulls over.

Nothing in here knows of carla: a step is a function of what is seen, so that it can be driven in a test's own world.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.driving.controllers import PedalControl, steer_angle_rad
from basu.agents.builtin.driving.manner import BASIC, NORMAL, ComfortLimits
from basu.agents.builtin.driving.planner import Planner
from basu.agents.builtin.passing.overtaking import Overtaking, PassingPhase
from basu.agents.builtin.passing.pulling_over import PullingOver, Tailgating
from basu.agents.builtin.rules.obstacles import Obstacles
from basu.agents.builtin.scene import Restriction, Urgency

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from basu.agents.builtin.driving.controllers import DriveModel, Pedals
    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.driving.speed_profile import SpeedProfile
    from basu.agents.builtin.driving.task import Task
    from basu.agents.builtin.passing.detour import Detour
    from basu.agents.builtin.passing.road import RoadBesidePath
    from basu.agents.builtin.rules.stopping_lines import Light
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry


HORIZON_M = 160.0  # how far ahead slowdowns are looked at: from 15 m/s down to walking pace in comfort
RULES_M = 60.0  # how far ahead lines and stops are
STEER_DELAY_STEPS = 1.0  # a command takes effect one step after the measurement it is made from


class DrivingCommand(NamedTuple):
    """What hands and feet do until the next step."""

    throttle: float
    brake: float
    steer_rad: float


class Driver:
    """Drives one task with one vehicle.

    Attributes:
        path: what is driven along; the task's, unless something is gone round.
        profile: how fast its points may be driven.
        place: where the vehicle is beside the path, None before the first step.
        requested: further restrictions, from the agent, until it changes them.
    """

    place: PathPosition | None
    requested: tuple[Restriction, ...] = ()

    def __init__(
        self, task: Task, body: VehicleGeometry, model: DriveModel, dt_s: float, manner: Manner = BASIC
    ) -> None:
        self.task = task
        self.path: SampledPath = task.path
        self.profile: SpeedProfile = task.profile
        self.place = None
        self.planner = Planner(dt_s, manner.comfort)
        self._body = body
        self._pedals = PedalControl(model, dt_s)
        self._obstacles = Obstacles(task.path, body, manner.following)
        self._preview_s = STEER_DELAY_STEPS * dt_s
        self._steer_rad = 0.0

    def step(self, ego: DrivenVehicle, others: Sequence[Other], shows: Callable[[str], Light]) -> DrivingCommand:
        """Decide one step; ``shows`` tells what the light of a landmark id shows."""
        place = self._locate(ego)
        return self._drive(ego, place, others, shows, self.profile.limit_mps[place.near])

    def _locate(self, ego: DrivenVehicle) -> PathPosition:
        """Find the vehicle beside the path."""
        if self.place is None:
            self.place = self.path.find(ego.x_m, ego.y_m, ego.yaw_rad)
        else:
            self.place = self.path.track(ego.x_m, ego.y_m, ego.yaw_rad, self.place.near)
        return self.place

    def _drive(
        self,
        ego: DrivenVehicle,
        place: PathPosition,
        others: Sequence[Other],
        shows: Callable[[str], Light],
        limit_mps: float,
        demands: Iterable[Restriction] = (),
    ) -> DrivingCommand:
        """Meet all restrictions: of path, rules, other actors, and the caller's own."""
        restrictions = [
            Restriction(distance_m, speed_mps, Urgency.GENTLE, "bend or lower limit")
            for distance_m, speed_mps in self.profile.slowdowns(place.s_m, HORIZON_M)
        ]
        restrictions.append(Restriction(self.path.end_s_m - place.s_m, 0.0, Urgency.GENTLE, "end of the route"))
        restrictions.extend(demands)
        restrictions.extend(self._ruled(ego, place, others, shows))
        restrictions.extend(self._obstacles.step(ego, place, others))
        accel_mps2 = self.planner.step(ego.speed_mps, limit_mps, restrictions, self._obstacles.follow_mps2)
        pedals = self._press(ego, accel_mps2)
        if ego.speed_mps > 0.1:  # standing wheels are not turned
            self._steer_rad = steer_angle_rad(self.path, place, ego.yaw_rad, ego.speed_mps, self._body, self._preview_s)
        return DrivingCommand(pedals.throttle, pedals.brake, self._steer_rad)

    def _press(self, ego: DrivenVehicle, accel_mps2: float) -> Pedals:
        """Return the pedals that bring the vehicle to the planner's speed."""
        planner = self.planner
        return self._pedals.step(ego.speed_mps, planner.speed_mps, accel_mps2, holding=planner.holding, gear=ego.gear)

    def _ruled(
        self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], shows: Callable[[str], Light]
    ) -> list[Restriction]:
        """The restrictions of signs, lights and stops in sight, and of the parking brake."""
        s_m, front_s_m = place.s_m, place.s_m + self._body.front_m
        demands = [
            *(sign.step(ego, front_s_m, others) for sign in self.task.stop_signs if _in_sight(sign.line_s_m, s_m)),
            *(sign.step(ego, front_s_m, others) for sign in self.task.yield_signs if _in_sight(sign.line_s_m, s_m)),
            *(
                light.step(shows(light.landmark_id), front_s_m, ego.speed_mps)
                for light in self.task.lights
                if _in_sight(light.line_s_m, s_m)
            ),
            *(stop.step(ego, s_m) for stop in self.task.stops if _in_sight(stop.s_m, s_m)),
            Restriction(0.0, 0.0, Urgency.GENTLE, "parking brake") if ego.parked else None,
            *self.requested,
        ]
        return [restriction for restriction in demands if restriction is not None]


def _in_sight(mark_s_m: float, s_m: float) -> bool:
    """Whether a mark lies ahead within ``RULES_M``, or just behind the vehicle's origin."""
    return -2.0 < mark_s_m - s_m < RULES_M


NEAR_M = 150.0  # rules look at those within this, 25 mph for 13 s; only passing has to look farther
SIGHT_M = 350.0  # from standstill the cautious one needs some 21 s, in which one at 25 mph gets 240 m
SOFTER = 0.7  # share of the usual braking and jerk while an actor is close behind
HURRY_MPS = 1.0  # added to a speed below the limit then, up to the limit of basic


class BehavioralDriver(Driver):
    """A driver with a manner of its own."""

    def __init__(
        self, task: Task, road: RoadBesidePath, body: VehicleGeometry, model: DriveModel, dt_s: float, manner: Manner
    ) -> None:
        super().__init__(task, body, model, dt_s, manner)
        assert manner.passing is not None, "a behavioral manner knows how to pass"
        self.manner = manner
        self.overtaking = Overtaking(task.path, road, body, manner, manner.passing, SIGHT_M)
        self.tailgating = Tailgating(body, manner.tailgated_s)
        self.pulling_over = PullingOver(task.path, road, body, manner)
        self.detour: Detour | None = None  # what is driven instead of the lane
        self._road = road
        self._softer = ComfortLimits(SOFTER * manner.comfort.accel_mps2, SOFTER * manner.comfort.jerk_mps3)

    @property
    def posted_mps(self) -> float:
        """The limit where the vehicle is."""
        return self._road.limit_mps[0 if self.place is None else self.place.near]

    def step(self, ego: DrivenVehicle, others: Sequence[Other], shows: Callable[[str], Light]) -> DrivingCommand:
        """Decide one step."""
        near = [o for o in others if abs(o.x_m - ego.x_m) < NEAR_M and abs(o.y_m - ego.y_m) < NEAR_M]
        place = self._locate(ego)
        tailgated = self.tailgating.step(ego, self.path, place, near)
        demands = self._choose_path(ego, place, others, tailgated=tailgated)
        place = self._locate(ego)
        limit_mps = self._limit_mps(place)
        if tailgated and self.detour is None:
            self.planner.comfort = self._softer
            limit_mps = self._hurried_mps(place, limit_mps)
        else:
            self.planner.comfort = self.manner.comfort
        return self._drive(ego, place, near, shows, limit_mps, demands)

    def _choose_path(
        self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], *, tailgated: bool
    ) -> list[Restriction]:
        """Keep to the lane, pass an obstruction, or make room for a tailgater."""
        lane = self.task.path
        own = place if self.path is lane else lane.follow(ego.x_m, ego.y_m, place.near)
        demands: list[Restriction] = []
        if self.pulling_over.detour is None:
            demands = self.overtaking.step(ego, own, others)
        if self.overtaking.phase is PassingPhase.KEEPING:
            demands.extend(self.pulling_over.step(ego, own, others, tailgated=tailgated))
        self.detour = self.overtaking.detour or self.pulling_over.detour
        self.path = self._obstacles.path = lane if self.detour is None else self.detour.path
        return demands

    def _limit_mps(self, place: PathPosition) -> float:
        """The speed here, on a way round the speed of that."""
        limit_mps, detour = self.profile.limit_mps[place.near], self.detour
        if detour is not None and detour.extent.from_s_m <= place.s_m <= detour.extent.to_s_m:
            return min(limit_mps, detour.speed_mps)
        return limit_mps

    def _hurried_mps(self, place: PathPosition, limit_mps: float) -> float:
        """A little more than usual where only the manner keeps below the posted limit."""
        posted_mps = self._road.limit_mps[place.near]
        manner_mps = posted_mps + self.manner.above_limit_mps
        if limit_mps < manner_mps - 1e-6 or manner_mps > posted_mps + NORMAL.above_limit_mps:
            return limit_mps  # a bend or the vehicle's own top speed is what keeps it, or it is at the limit already
        return max(limit_mps, min(limit_mps + HURRY_MPS, posted_mps + NORMAL.above_limit_mps))
