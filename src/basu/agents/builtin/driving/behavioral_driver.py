"""The head of the behavioral agents: a driver that goes round what stands in its way and minds who is behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.agents.builtin.driving.comfort import Limits
from basu.agents.builtin.driving.driver import Driver
from basu.agents.builtin.driving.manner import NORMAL
from basu.agents.builtin.passing.overtaking import Overtaking, Phase
from basu.agents.builtin.passing.pulling_over import PullingOver
from basu.agents.builtin.passing.tailgating import Tailgating

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu.agents.builtin.driving.driver import Command
    from basu.agents.builtin.driving.longitudinal import DriveModel
    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import Place
    from basu.agents.builtin.driving.task import Task
    from basu.agents.builtin.passing.detour import Detour
    from basu.agents.builtin.passing.road import Road
    from basu.agents.builtin.rules.traffic_lights import Light
    from basu.agents.builtin.scene import Body, Ego, Other, Restriction

NEAR_M = 150.0  # rules look at those within this, 25 mph for 13 s; only passing has to look farther
SIGHT_M = 350.0  # from standstill the cautious one needs some 21 s, in which one at 25 mph gets 240 m
SOFTER = 0.7  # share of the usual comfort that is left of braking and its jerk while somebody is close behind
HURRY_MPS = 1.0  # one who drives below the limit may be this much faster then, up to the limit as basic has it


class BehavioralDriver(Driver):
    """A driver with a manner of its own."""

    def __init__(self, task: Task, road: Road, body: Body, model: DriveModel, dt_s: float, manner: Manner) -> None:
        super().__init__(task, body, model, dt_s, manner)
        assert manner.passing is not None, "a behavioral manner knows how to pass"
        self.manner = manner
        self.overtaking = Overtaking(task.path, road, body, manner, manner.passing, SIGHT_M)
        self.tailgating = Tailgating(body, manner.tailgated_s)
        self.pulling_over = PullingOver(task.path, road, body, manner)
        self.detour: Detour | None = None  # what is driven instead of the lane
        self._road = road
        self._softer = Limits(SOFTER * manner.comfort.accel_mps2, SOFTER * manner.comfort.jerk_mps3)

    @property
    def posted_mps(self) -> float:
        """The limit where the vehicle is."""
        return self._road.limit_mps[0 if self.place is None else self.place.near]

    def step(self, ego: Ego, others: Sequence[Other], shows: Callable[[str], Light]) -> Command:
        """Decide one step."""
        near = [o for o in others if abs(o.x_m - ego.x_m) < NEAR_M and abs(o.y_m - ego.y_m) < NEAR_M]
        place = self._locate(ego)
        tailgated = self.tailgating.step(ego, self.path, place, near)
        asked = self._choose_path(ego, place, others, tailgated=tailgated)
        place = self._locate(ego)
        limit_mps = self._limit_mps(place)
        if tailgated and self.detour is None:
            self.planner.comfort = self._softer
            limit_mps = self._hurried_mps(place, limit_mps)
        else:
            self.planner.comfort = self.manner.comfort
        return self._drive(ego, place, near, shows, limit_mps, asked)

    def _choose_path(self, ego: Ego, place: Place, others: Sequence[Other], *, tailgated: bool) -> list[Restriction]:
        """Keep to the lane, go round what stands in it, or make room for who is close behind."""
        lane = self.task.path
        own = place if self.path is lane else lane.follow(ego.x_m, ego.y_m, place.near)
        asked: list[Restriction] = []
        if self.pulling_over.detour is None:
            asked = self.overtaking.step(ego, own, others)
        if self.overtaking.phase is Phase.KEEPING:
            asked.extend(self.pulling_over.step(ego, own, others, tailgated=tailgated))
        self.detour = self.overtaking.detour or self.pulling_over.detour
        self.path = self._obstacles.path = lane if self.detour is None else self.detour.path
        return asked

    def _limit_mps(self, place: Place) -> float:
        """The speed here, on a way round the speed of that."""
        limit_mps, detour = self.profile.limit_mps[place.near], self.detour
        if detour is not None and detour.extent.from_s_m <= place.s_m <= detour.extent.to_s_m:
            return min(limit_mps, detour.speed_mps)
        return limit_mps

    def _hurried_mps(self, place: Place, limit_mps: float) -> float:
        """A little more than usual where only the manner keeps below the posted limit."""
        posted_mps = self._road.limit_mps[place.near]
        manner_mps = posted_mps + self.manner.above_limit_mps
        if limit_mps < manner_mps - 1e-6 or manner_mps > posted_mps + NORMAL.above_limit_mps:
            return limit_mps  # a bend or the vehicle's own top speed is what keeps it, or it is at the limit already
        return max(limit_mps, min(limit_mps + HURRY_MPS, posted_mps + NORMAL.above_limit_mps))
