"""The behavioral agents, named after CARLA's BehaviorAgent, and the thesis's run that leaves its path on purpose.

Its three profiles are ``behavioral`` (normal), ``behavioral-cautious`` and ``behavioral-aggressive``; what they differ
in, with sources, stands in `docs/reference/agents.md`. Like the basic agent it uses no sensors and no clock.

Table 5.1 has it with one collision, one speeding and 0.56 of the path. This one drives as ``behavioral`` does up to a
share of the route, then speeds up beyond the limit, drives at something that stands still beside the street, and stays
where that ends.
"""

from __future__ import annotations

import enum
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import carla
import numpy as np

from basu.agents.builtin.basic import TEST_RUNS, BasicAgent
from basu.agents.builtin.driving.driver import SIGHT_M, BehavioralDriver
from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL
from basu.agents.builtin.driving.task import make_task
from basu.agents.builtin.passing.road import make_road
from basu.agents.builtin.perception import OTHERS_TOP_MPS, read_facts, see_ego
from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import SampledPath
    from basu.agents.builtin.perception import VehicleFacts
    from basu.agents.builtin.scene import DrivenVehicle
    from basu.routing import Route


DRIVEN = (carla.LaneType.Driving, carla.LaneType.Bidirectional)
UNPOSTED_MPS = OTHERS_TOP_MPS  # how fast others may come where no limit is posted


class BehavioralAgent(BasicAgent):
    """The normal profile, and the base of the other two."""

    manner: Manner = NORMAL
    sight_m = SIGHT_M
    driver: BehavioralDriver | None = None

    def _get_in(self, pose: carla.Transform) -> tuple[BehavioralDriver, VehicleFacts]:
        """Read the vehicle, plan its task, and read the lanes beside the route."""
        route = self.seen_route
        facts = read_facts(self.vehicle, pose)
        task = make_task(route, facts.body, facts.top_mps, self.manner)
        left_width_m, right_lane_m = beside(route)
        road = make_road(route, task.path, left_width_m, right_lane_m, UNPOSTED_MPS)
        return BehavioralDriver(task, road, facts.body, facts.model, self.time_step_s, self.manner), facts


class CautiousAgent(BehavioralAgent):
    """The cautious profile; `docs/reference/agents.md` has its figures."""

    manner = CAUTIOUS


class AggressiveAgent(BehavioralAgent):
    """The aggressive profile."""

    manner = AGGRESSIVE


def beside(route: Route) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(N,) width of the driving lane to the left and (N,) way to the middle of a lane to the right that leads our way.

    Both in m, 0 where there is none; in junctions lanes lie over one another, and none is beside another.
    """
    left_m, right_m = np.zeros(len(route.s_m)), np.zeros(len(route.s_m))
    for number, waypoint in enumerate(route.waypoints):
        if waypoint.is_junction:
            continue
        left, right = waypoint.get_left_lane(), waypoint.get_right_lane()
        if left is not None and left.lane_type in DRIVEN:
            left_m[number] = left.lane_width
        if right is not None and right.lane_type == carla.LaneType.Driving and right.lane_id * waypoint.lane_id > 0:
            right_m[number] = 0.5 * (waypoint.lane_width + right.lane_width)
    return left_m, right_m


SHARE = 0.56  # of the route, where it ends: table 5.1
RUN_UP_M = 60.0  # before the path is left: from a stop to beyond the limit
ABOVE_LIMIT_MPS = 2.5  # well beyond the tolerance of 1 m/s; 5.6 mph
BLOW_MPS = 2.0  # so much speed is lost in one step only in a crash
HARD_THINGS = ("Buildings", "Poles", "Vegetation", "TrafficSigns", "Fences", "Walls", "Static")
LOWEST_M, HIGHEST_M = 1.0, 0.5  # above the road: a box that begins higher or ends lower is not hit by a bumper
AROUND_M = 60.0  # from the requested place: the searched surroundings
NEAREST_M, FARTHEST_M = 4.5, 20.0  # beside the path: off the road, and not so far that the run ends on the way
LEFT_M = 25.0  # what stands to the left, across the other lane, has to be so much nearer to the place
LEAVES_M, LEAVES_PER_M = 10.0, 1.8  # so far before the thing, plus so much for each metre that it lies aside
CLEAR_M = 1.5  # kept free to both sides on the way to it: half a car, and what its steering may be off
TIGHTEST_MPS2 = 6.0  # sideways, when the wheel is turned at speed
AIM_M = 8.0  # from farther away one aims this far ahead


class StreetBox(NamedTuple):
    """An upright box beside the street; CARLA frame, m and rad."""

    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: float
    half_width_m: float


class Deviation(NamedTuple):
    """Leave the path at ``leaves_s_m`` and drive straight at the thing, which stands beside ``hits_s_m``."""

    leaves_s_m: float
    hits_s_m: float
    thing: StreetBox


def choose(path: SampledPath, things: Sequence[StreetBox], at_s_m: float) -> Deviation | None:
    """The thing nearest to beside ``at_s_m`` that can be driven at with nothing between; None where there is none."""
    middle = path.index_at(at_s_m)
    near = [t for t in things if math.hypot(t.x_m - path.x_m[middle], t.y_m - path.y_m[middle]) < AROUND_M]
    candidates = []
    for number, thing in enumerate(near):
        place = path.follow(thing.x_m, thing.y_m, middle)
        if NEAREST_M < abs(place.lateral_m) < FARTHEST_M:
            cost_m = abs(place.s_m - at_s_m) + (LEFT_M if place.lateral_m < 0.0 else 0.0)
            candidates.append((cost_m, number, place))
    for _, number, place in sorted(candidates):
        leaves_s_m = place.s_m - LEAVES_M - LEAVES_PER_M * abs(place.lateral_m)
        others = [thing for other, thing in enumerate(near) if other != number]
        if leaves_s_m > 0.0 and _is_clear(path, leaves_s_m, near[number], others):
            return Deviation(leaves_s_m, place.s_m, near[number])
    return None


def _is_clear(path: SampledPath, from_s_m: float, thing: StreetBox, others: Sequence[StreetBox]) -> bool:
    """Whether nothing else stands on the way from a place on the path to the thing's nearer side."""
    start = path.index_at(from_s_m)
    x_m, y_m = path.x_m[start], path.y_m[start]
    distance_m = math.hypot(thing.x_m - x_m, thing.y_m - y_m)
    share = np.arange(0.0, max(distance_m - max(thing.half_length_m, thing.half_width_m), 0.0), 0.5) / distance_m
    way_m = np.column_stack([x_m + share * (thing.x_m - x_m), y_m + share * (thing.y_m - y_m)])
    return not any(_reaches(other, way_m) for other in others)


def _reaches(thing: StreetBox, points_m: NDArray[np.float64]) -> bool:
    """Whether a box, grown by ``CLEAR_M``, holds one of the points (N, 2)."""
    gaps_m = points_m - (thing.x_m, thing.y_m)
    cos, sin = math.cos(thing.yaw_rad), math.sin(thing.yaw_rad)
    along_m = np.abs(gaps_m[:, 0] * cos + gaps_m[:, 1] * sin)
    across_m = np.abs(gaps_m[:, 1] * cos - gaps_m[:, 0] * sin)
    return bool(((along_m < thing.half_length_m + CLEAR_M) & (across_m < thing.half_width_m + CLEAR_M)).any())


def aim_rad(ego: DrivenVehicle, thing: StreetBox, wheelbase_m: float) -> float:
    """The front wheels' angle with which to drive at the thing, positive to the right.

    Pure pursuit (Coulter 1992, "Implementation of the pure pursuit path tracking algorithm"), no tighter than tyres
    bear.
    """
    dx_m, dy_m = thing.x_m - ego.x_m, thing.y_m - ego.y_m
    off_rad = math.remainder(math.atan2(dy_m, dx_m) - ego.yaw_rad, math.tau)
    bend_1pm = 2.0 * math.sin(max(-1.5, min(1.5, off_rad))) / max(min(math.hypot(dx_m, dy_m), AIM_M), 1.0)
    tightest_1pm = TIGHTEST_MPS2 / max(ego.speed_mps, 1.0) ** 2
    return math.atan(wheelbase_m * max(-tightest_1pm, min(tightest_1pm, bend_1pm)))


class IntentionPhase(enum.Enum):
    """How far it has come with its bad intentions."""

    DRIVING = "driving"
    SPEEDING = "speeding"
    LEAVING = "leaving"
    STAYING = "staying"


class DeviatingAgent(BehavioralAgent):
    """Drives well at first."""

    phase = IntentionPhase.DRIVING
    deviation: Deviation | None = None
    _before_mps = 0.0

    def run_step(self, sensor_data: Mapping[str, tuple[int, Any]]) -> carla.VehicleControl:
        """Drive as the behavioral agent does, and then not any more."""
        if self.phase is IntentionPhase.STAYING:
            return carla.VehicleControl(brake=1.0, hand_brake=True)
        control = super().run_step(sensor_data)
        snapshot = self.world.get_snapshot()
        own = snapshot.find(self.vehicle.id)
        if own is None or self.driver is None or self.facts is None:
            return control
        ego = see_ego(snapshot, own, self.vehicle.get_control())
        self._advance(ego, self.driver)
        self._before_mps = ego.speed_mps
        return self._spoilt(control, ego, self.driver, self.facts)

    def _spoilt(
        self, control: carla.VehicleControl, ego: DrivenVehicle, driver: BehavioralDriver, facts: VehicleFacts
    ) -> carla.VehicleControl:
        """What becomes of a good driver's control."""
        if self.phase is IntentionPhase.STAYING:
            return carla.VehicleControl(brake=1.0, hand_brake=True)
        if self.phase is not IntentionPhase.DRIVING:
            control.throttle, control.brake = self._pedals(ego, driver)
        if self.phase is IntentionPhase.LEAVING and self.deviation is not None:
            angle_rad = aim_rad(ego, self.deviation.thing, facts.body.wheelbase_m)
            control.steer = facts.steering.command(angle_rad, ego.speed_mps)
        return control

    def config(self) -> dict[str, str]:
        """Return the route, car and weather of the thesis's test runs."""
        return dict(TEST_RUNS)

    def _get_in(self, pose: carla.Transform) -> tuple[BehavioralDriver, VehicleFacts]:
        """Choose what to hit, too."""
        driver, facts = super()._get_in(pose)
        path = driver.task.path
        self.deviation = choose(path, self._things(), SHARE * path.end_s_m)
        if self.deviation is None:
            raise UserError(
                f"nothing stands beside the street at {SHARE:.0%} of the route that could be driven at; "
                "choose another route for the agent 'deviating'"
            )
        return driver, facts

    def _advance(self, ego: DrivenVehicle, driver: BehavioralDriver) -> None:
        """Go from one phase to the next when it is due."""
        assert self.deviation is not None
        assert driver.place is not None
        s_m = driver.place.s_m
        if self.phase is IntentionPhase.DRIVING and s_m >= self.deviation.leaves_s_m - RUN_UP_M:
            self.phase = IntentionPhase.SPEEDING
        elif self.phase is IntentionPhase.SPEEDING and s_m >= self.deviation.leaves_s_m:
            self.phase = IntentionPhase.LEAVING
        elif self.phase is IntentionPhase.LEAVING and self._before_mps - ego.speed_mps > BLOW_MPS:
            self.phase = IntentionPhase.STAYING

    def _pedals(self, ego: DrivenVehicle, driver: BehavioralDriver) -> tuple[float, float]:
        """Throttle and brake for a speed beyond the limit."""
        assert driver.place is not None
        wanted_mps = driver.posted_mps + ABOVE_LIMIT_MPS
        return min(1.0, max(0.0, 0.4 + 0.5 * (wanted_mps - ego.speed_mps))), 0.0

    def _things(self) -> list[StreetBox]:
        """Everything hard that a bumper may hit, as far as the simulator tells."""
        assert self.route is not None
        road_z_m = float(self.route.points_m[np.searchsorted(self.route.s_m, SHARE * self.route.length_m), 2])
        found = []
        for name in HARD_THINGS:
            for box in self.world.get_level_bbs(getattr(carla.CityObjectLabel, name)):
                at, half = box.location, box.extent
                if at.z - half.z < road_z_m + LOWEST_M and at.z + half.z > road_z_m + HIGHEST_M:
                    found.append(StreetBox(at.x, at.y, math.radians(box.rotation.yaw), half.x, half.y))
        return found
