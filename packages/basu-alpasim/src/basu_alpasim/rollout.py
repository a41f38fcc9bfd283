"""`PlanningDriver`: turns a decision of BASU's driver into a trajectory by repeating the planner's step.

A trajectory repeats the planner's step with the restrictions of this moment: bends, lower limits, lines, other actors.
They come nearer as the vehicle goes on. Nothing moves meanwhile: a red light stays red, and an actor keeps its place.
The next request sees what has become of it.
"""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.builtin.driving.controllers import DriveModel
from basu.agents.builtin.driving.planner import Planner

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from basu.agents.builtin.driving.driver import Driver
    from basu.agents.builtin.rules.stopping_lines import Light
    from basu.agents.builtin.scene import DrivenVehicle, Other, Restriction, VehicleGeometry

HORIZON_S = 4.0  # of a trajectory, as the reference policies of carla-driver-interface have it
EVERY_S = 0.1  # between two poses
UNUSED_PEDALS = DriveModel((0.0, 40.0), (3.0, 3.0), 8.0)
"""What a driver's pedals do: the simulator's controller presses others, so these figures change nothing."""


class Rolled(NamedTuple):
    """A pose of the vehicle's origin, CARLA frame, ``after_s`` from now."""

    after_s: float
    x_m: float
    y_m: float
    yaw_rad: float


class RememberingPlanner(Planner):
    """A planner that keeps what it was given in its last step."""

    given: tuple[float, tuple[Restriction, ...], float] = (0.0, (), math.inf)

    def step(
        self,
        measured_mps: float,
        limit_mps: float,
        restrictions: Iterable[Restriction],
        follow_mps2: float = math.inf,
    ) -> float:
        """Advance the reference, as `Planner` does."""
        kept = tuple(restrictions)
        self.given = (limit_mps, kept, follow_mps2)
        return super().step(measured_mps, limit_mps, kept, follow_mps2)


class PlanningDriver:
    """Drives one task by trajectories in the place of pedals and wheel."""

    def __init__(self, driver: Driver, body: VehicleGeometry, step_s: float) -> None:
        """Take a driver with its task; ``step_s`` is the time between two requests."""
        self._driver = driver
        self._planner = RememberingPlanner(step_s)
        self._driver.planner = self._planner
        self._body = body

    def take_over(self, before: PlanningDriver) -> None:
        """Go on at the speed and the acceleration that another driver has planned, after its route was sent anew."""
        self._planner.speed_mps = before._planner.speed_mps
        self._planner.accel_mps2 = before._planner.accel_mps2

    def plan(self, ego: DrivenVehicle, others: Sequence[Other], shows: Callable[[str], Light]) -> list[Rolled]:
        """Decide one step, and return where the vehicle is to be after 0.1 s, 0.2 s and so on."""
        held_mps, held_mps2 = self._planner.speed_mps, self._planner.accel_mps2
        self._driver.step(ego, others, shows)
        _, restrictions, follow_mps2 = self._planner.given
        roll = copy.copy(self._planner)
        roll.dt_s, roll.speed_mps, roll.accel_mps2 = EVERY_S, held_mps, held_mps2
        place = self._driver.place
        assert place is not None  # the driver has just found it
        profile, s_m, driven_m = self._driver.profile, place.s_m, 0.0
        rolled = []
        measured_mps = ego.speed_mps
        for number in range(1, round(HORIZON_S / EVERY_S) + 1):
            nearer = (each._replace(distance_m=each.distance_m - driven_m) for each in restrictions)
            limit_mps = profile.limit_mps[self._driver.path.index_at(s_m + driven_m)]
            roll.step(measured_mps, limit_mps, nearer, follow_mps2)
            measured_mps = roll.speed_mps
            driven_m += roll.speed_mps * EVERY_S
            rolled.append(self._pose(number * EVERY_S, s_m + driven_m))
        return rolled

    def _pose(self, after_s: float, s_m: float) -> Rolled:
        """The vehicle on its path: the axis stands off the path by the slip of its origin."""
        path = self._driver.path
        along_m = min(max(s_m, 0.0), path.end_s_m)
        index = path.index_at(along_m)
        heading_rad = path.heading_at_rad(along_m)
        beyond_m = s_m - path.s_m[index]
        slip = max(-0.9, min(0.9, path.curvature_at_1pm(along_m) * self._body.rear_axle_m))
        x_m = path.x_m[index] + beyond_m * math.cos(heading_rad)
        y_m = path.y_m[index] + beyond_m * math.sin(heading_rad)
        return Rolled(after_s, x_m, y_m, heading_rad - math.asin(slip))
