"""A driver's head: gathers what path, rules and other people ask for, and hands it to planner, feet and hands.

Nothing in here knows of carla: a step is a function of what is seen, so that it can be driven in a test's own world.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.driving.lateral import steer_angle_rad
from basu.agents.builtin.driving.longitudinal import PedalControl
from basu.agents.builtin.driving.manner import BASIC
from basu.agents.builtin.driving.planner import Planner
from basu.agents.builtin.rules.obstacles import Obstacles
from basu.agents.builtin.scene import Restriction, Urgency

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from basu.agents.builtin.driving.longitudinal import DriveModel, Pedals
    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import Path, Place
    from basu.agents.builtin.driving.speed_profile import SpeedProfile
    from basu.agents.builtin.driving.task import Task
    from basu.agents.builtin.rules.traffic_lights import Light
    from basu.agents.builtin.scene import Body, Ego, Other

HORIZON_M = 160.0  # how far ahead slowdowns are looked at: from 15 m/s down to walking pace in comfort
RULES_M = 60.0  # how far ahead lines and stops are
STEER_DELAY_STEPS = 1.0  # a command takes effect one step after the measurement it is made from


class Command(NamedTuple):
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
    """

    place: Place | None

    def __init__(self, task: Task, body: Body, model: DriveModel, dt_s: float, manner: Manner = BASIC) -> None:
        self.task = task
        self.path: Path = task.path
        self.profile: SpeedProfile = task.profile
        self.place = None
        self.planner = Planner(dt_s, manner.comfort)
        self._body = body
        self._pedals = PedalControl(model, dt_s)
        self._obstacles = Obstacles(task.path, body, manner.following)
        self._preview_s = STEER_DELAY_STEPS * dt_s
        self._steer_rad = 0.0

    def step(self, ego: Ego, others: Sequence[Other], shows: Callable[[str], Light]) -> Command:
        """Decide one step; ``shows`` tells what the light of a landmark id shows."""
        place = self._locate(ego)
        return self._drive(ego, place, others, shows, self.profile.limit_mps[place.near])

    def _locate(self, ego: Ego) -> Place:
        """Find the vehicle beside the path."""
        if self.place is None:
            self.place = self.path.find(ego.x_m, ego.y_m, ego.yaw_rad)
        else:
            self.place = self.path.track(ego.x_m, ego.y_m, ego.yaw_rad, self.place.near)
        return self.place

    def _drive(
        self,
        ego: Ego,
        place: Place,
        others: Sequence[Other],
        shows: Callable[[str], Light],
        limit_mps: float,
        asked: Iterable[Restriction] = (),
    ) -> Command:
        """Meet everything that is asked for: path, rules, other people, and what the caller adds."""
        restrictions = [
            Restriction(distance_m, speed_mps, Urgency.GENTLE, "bend or lower limit")
            for distance_m, speed_mps in self.profile.slowdowns(place.s_m, HORIZON_M)
        ]
        restrictions.append(Restriction(self.path.end_s_m - place.s_m, 0.0, Urgency.GENTLE, "end of the route"))
        restrictions.extend(asked)
        restrictions.extend(self._ruled(ego, place, others, shows))
        restrictions.extend(self._obstacles.step(ego, place, others))
        accel_mps2 = self.planner.step(ego.speed_mps, limit_mps, restrictions, self._obstacles.follow_mps2)
        pedals = self._press(ego, accel_mps2)
        if ego.speed_mps > 0.1:  # standing wheels are not turned
            self._steer_rad = steer_angle_rad(self.path, place, ego.yaw_rad, ego.speed_mps, self._body, self._preview_s)
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
