"""The behavioral agent: follows, takes gaps, goes round what stands in its lane; named after CARLA's BehaviorAgent.

Its three profiles are ``behavioral`` (normal), ``behavioral-cautious`` and ``behavioral-aggressive``; what they differ
in, with sources, stands in `docs/agents.md`. Like the basic agent it uses no sensors and no clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import carla
import numpy as np

from basu.agents.builtin.basic import BasicAgent
from basu.agents.builtin.driving.behavioral_driver import SIGHT_M, BehavioralDriver
from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL
from basu.agents.builtin.driving.task import make_task
from basu.agents.builtin.passing.road import make_road
from basu.agents.builtin.vehicle_facts import OTHERS_TOP_MPS, read_facts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.vehicle_facts import VehicleFacts
    from basu.routing import Route

DRIVEN = (carla.LaneType.Driving, carla.LaneType.Bidirectional)
UNPOSTED_MPS = OTHERS_TOP_MPS  # how fast others may come where no limit is posted


class BehavioralAgent(BasicAgent):
    """The normal profile, and the base of the other two."""

    manner: Manner = NORMAL
    sight_m = SIGHT_M
    driver: BehavioralDriver | None = None

    def _get_in(self, pose: carla.Transform) -> tuple[BehavioralDriver, VehicleFacts]:
        """Read the vehicle, lay out the route for it, and look at the lanes beside it."""
        assert self.route is not None  # setup refuses
        facts = read_facts(self.vehicle, pose)
        task = make_task(self.route, facts.body, facts.top_mps, self.manner)
        left_width_m, right_lane_m = beside(self.route)
        road = make_road(self.route, task.path, left_width_m, right_lane_m, UNPOSTED_MPS)
        return BehavioralDriver(task, road, facts.body, facts.model, self.time_step_s, self.manner), facts


class CautiousAgent(BehavioralAgent):
    """The cautious profile; `docs/agents.md` has its figures."""

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
