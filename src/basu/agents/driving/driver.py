"""The basic agent's head: gathers what path, rules and other people ask for, and hands it to planner, feet and hands.

Nothing in here knows of carla: a step is a function of what is seen, so that it can be driven in a test's own world.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.agents.driving.lateral import steer_angle_rad
from basu.agents.driving.longitudinal import DriveModel, PedalControl, Pedals
from basu.agents.driving.path import SPACING_M, Path, make_path
from basu.agents.driving.planner import Planner
from basu.agents.driving.speed_profile import SpeedProfile, make_profile
from basu.agents.rules.conflicts import make_zone
from basu.agents.rules.obstacles import Obstacles
from basu.agents.rules.service_stops import ServiceStop
from basu.agents.rules.stop_signs import StopSign
from basu.agents.rules.traffic_lights import Light, TrafficLight
from basu.agents.rules.yielding import YieldSign
from basu.agents.scene import Body, Ego, Other, Restriction, Urgency
from basu.routing import ControlKind, Route

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.agents.driving.path import Place

HORIZON_M = 160.0  # how far ahead slowdowns are looked at: from 15 m/s down to walking pace in comfort
RULES_M = 60.0  # how far ahead lines and stops are
STEER_DELAY_STEPS = 1.0  # a command takes effect one step after the measurement it is made from
JUNCTION_AFTER_M = 15.0  # the crossing a line belongs to begins within this
CROSSING_M = (8.0, 30.0)  # the shortest and longest stretch that is taken for a crossing
MERGE_M = 10.0  # after a yield line: the stretch on which one joins the circulating traffic


class Command(NamedTuple):
    """What hands and feet do until the next step."""

    throttle: float
    brake: float
    steer_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What is to be driven, laid out once."""

    path: Path
    profile: SpeedProfile
    stop_signs: tuple[StopSign, ...]
    yield_signs: tuple[YieldSign, ...]
    lights: tuple[TrafficLight, ...]
    stops: tuple[ServiceStop, ...]


def make_task(route: Route, body: Body, cap_mps: float) -> Task:
    """Lay out a route for a vehicle that drives ``cap_mps`` at most."""
    path = make_path(route.points_m, route.s_m, route.lane_width_m, body)
    nearest = np.searchsorted(route.s_m, path.s_m).clip(0, len(route.s_m) - 1)
    profile = make_profile(path, route.speed_limit_mps[nearest], cap_mps, SPACING_M)
    length_m = body.front_m + body.rear_m
    of = {kind: [c for c in route.controls if c.kind is kind] for kind in ControlKind}
    return Task(
        path,
        profile,
        tuple(
            StopSign(c.s_m, make_zone(path, c.s_m, _crossing_end_s_m(route, c.s_m), body), length_m)
            for c in of[ControlKind.STOP_SIGN]
        ),
        tuple(
            YieldSign(c.s_m, make_zone(path, c.s_m + 1.0, c.s_m + MERGE_M, body), length_m)
            for c in of[ControlKind.YIELD_SIGN]
        ),
        tuple(TrafficLight(c.s_m, c.landmark_id) for c in of[ControlKind.TRAFFIC_LIGHT]),
        tuple(ServiceStop(stop.s_m, stop.name) for stop in route.stops),
    )


def _crossing_end_s_m(route: Route, line_s_m: float) -> float:
    """Where the junction behind a line is left."""
    shortest_m, longest_m = CROSSING_M
    after = (route.s_m >= line_s_m) & (route.s_m <= line_s_m + longest_m)
    s_m, inside = route.s_m[after], route.is_junction[after]
    if not inside.any() or s_m[inside][0] > line_s_m + JUNCTION_AFTER_M:
        return line_s_m + shortest_m
    begins = int(np.argmax(inside))
    left = np.flatnonzero(~inside[begins:])
    end_s_m = float(s_m[begins + left[0]]) if len(left) else float(s_m[-1])
    return max(end_s_m, line_s_m + shortest_m)


class Driver:
    """Drives one task with one vehicle."""

    def __init__(self, task: Task, body: Body, model: DriveModel, dt_s: float) -> None:
        self.task = task
        self.planner = Planner(dt_s)
        self.place: Place | None = None
        self._body = body
        self._pedals = PedalControl(model, dt_s)
        self._obstacles = Obstacles(task.path, body)
        self._preview_s = STEER_DELAY_STEPS * dt_s
        self._steer_rad = 0.0

    def step(self, ego: Ego, others: Sequence[Other], shows: Callable[[str], Light]) -> Command:
        """Decide one step; ``shows`` tells what the light of a landmark id shows."""
        path, profile = self.task.path, self.task.profile
        if self.place is None:
            self.place = path.find(ego.x_m, ego.y_m, ego.yaw_rad)
        else:
            self.place = path.track(ego.x_m, ego.y_m, ego.yaw_rad, self.place.near)
        place = self.place
        restrictions = [
            Restriction(distance_m, speed_mps, Urgency.GENTLE, "bend or lower limit")
            for distance_m, speed_mps in profile.slowdowns(place.s_m, HORIZON_M)
        ]
        restrictions.append(Restriction(path.end_s_m - place.s_m, 0.0, Urgency.GENTLE, "end of the route"))
        restrictions.extend(self._ruled(ego, place, others, shows))
        restrictions.extend(self._obstacles.step(ego, place, others))
        accel_mps2 = self.planner.step(ego.speed_mps, profile.limit_mps[place.near], restrictions)
        pedals = self._press(ego, accel_mps2)
        if ego.speed_mps > 0.1:  # standing wheels are not turned
            self._steer_rad = steer_angle_rad(path, place, ego.yaw_rad, ego.speed_mps, self._body, self._preview_s)
        return Command(pedals.throttle, pedals.brake, self._steer_rad)

    def _press(self, ego: Ego, accel_mps2: float) -> Pedals:
        """The feet follow the planner."""
        planner = self.planner
        return self._pedals.step(ego.speed_mps, planner.speed_mps, accel_mps2, holding=planner.holding, gear=ego.gear)

    def _ruled(
        self, ego: Ego, place: Place, others: Sequence[Other], shows: Callable[[str], Light]
    ) -> list[Restriction]:
        """What signs, lights and stops ask for; those not yet in sight and those long passed are not asked."""
        s_m, front_s_m = place.s_m, place.s_m + self._body.front_m
        asked = [
            *(sign.step(ego, front_s_m, others) for sign in self.task.stop_signs if _in_sight(sign.line_s_m, s_m)),
            *(sign.step(ego, front_s_m, others) for sign in self.task.yield_signs if _in_sight(sign.line_s_m, s_m)),
            *(
                light.step(shows(light.landmark_id), front_s_m, ego.speed_mps)
                for light in self.task.lights
                if _in_sight(light.line_s_m, s_m)
            ),
            *(stop.step(ego, s_m) for stop in self.task.stops if _in_sight(stop.s_m, s_m)),
        ]
        return [restriction for restriction in asked if restriction is not None]


def _in_sight(mark_s_m: float, s_m: float) -> bool:
    """Whether a mark lies ahead within ``RULES_M``, or just behind the vehicle's origin."""
    return -2.0 < mark_s_m - s_m < RULES_M
