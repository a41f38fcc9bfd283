"""Passes an obstruction through the oncoming lane while that lane is free.

::

    KEEPING ── it stood long enough, there is room, lane free ──► PASSING ── back in the lane ──► KEEPING
       ▲                                                                │
       └──────── a vehicle comes, and there is room to stop ───────────┘

Ohio Revised Code 4511.25 (A)(2) allows the left half of the road where an obstruction makes it necessary, giving way
to oncoming traffic. Not passed are people on foot, moving actors, queues before a line or a junction, jams, and
anything so near to a junction, a line or a service stop that the vehicle could not return to its lane before it.
"""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING

from basu.agents.builtin.driving.manner import slowing_distance_m
from basu.agents.builtin.driving.planner import ARRIVED_M, FIRM
from basu.agents.builtin.passing.detour import Extent, make_detour, swing_m, tightest_swing_m
from basu.agents.builtin.passing.obstruction import LONGEST_BLOCK_M, Standing
from basu.agents.builtin.passing.opposite_lane import Need, is_free
from basu.agents.builtin.rules.gap_acceptance import USED_SHARE
from basu.agents.builtin.scene import Restriction, Urgency
from basu.thresholds import STANDING_TRAFFIC_MPS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.driving.manner import Manner, Passing
    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.passing.detour import Detour
    from basu.agents.builtin.passing.obstruction import StandingRow
    from basu.agents.builtin.passing.road import RoadBesidePath
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry

STRAIGHT_S = 1.5  # the full offset is reached so long before the bumpers are level, against a near miss …
ALONG_M = 0.5  # … or, where that is not to be had, so much before; and until so much after
EDGE_M = 0.2  # kept to the left edge of the road
LEAST_BESIDE_M = 0.45  # what is enough beside a block where the road is narrow
LINE_M = 0.1  # kept to the middle line where one need not cross it
AGAIN_S = 2.0  # after giving up, nothing is begun for so long
SAME_M = 0.05  # two ways round that differ by less are one
SURE_S = 0.5  # the way has to have been free for so long before one goes


class PassingPhase(enum.Enum):
    """Where a driver is with what stands in its lane."""

    KEEPING = "keeping the lane"
    WAITING = "waiting to pass"
    PASSING = "passing"


class Overtaking:
    """The state of going round; ``detour`` is what to drive instead of the path, None while one keeps to it."""

    def __init__(
        self,
        path: SampledPath,
        road: RoadBesidePath,
        body: VehicleGeometry,
        manner: Manner,
        passing: Passing,
        sight_m: float,
    ) -> None:
        self.phase = PassingPhase.KEEPING
        self.detour: Detour | None = None
        self._path, self._road, self._body = path, road, body
        self._manner, self._passing, self._sight_m = manner, passing, sight_m
        self._standing = Standing(body)
        self._need: Need | None = None
        self._planned: Detour | None = None  # the last way round that was thought of
        self._latest_s_m = 0.0  # by where one has to be all the way aside
        self._not_before_s = 0.0
        self._free_since_s: float | None = None

    def step(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other]) -> list[Restriction]:
        """What going round asks for now; ``place`` is beside the task's own path."""
        if self.detour is not None and self._need is not None:
            return self._pass(ego, place, others, self._need)
        block = self._standing.block(self._path, self._road, ego, place, others)
        detour = None if block is None else self._plan(block, place)
        if block is None or detour is None:
            self.phase, self._free_since_s = PassingPhase.KEEPING, None
            return []
        patience_s = max(self._passing.patience_s * block.patience_factor, block.least_patience_s)
        need = self._need_of(detour, block)
        if block.stood_s >= patience_s and self._is_free_for_sure(ego, place, others, need):
            self.phase, self.detour, self._need = PassingPhase.PASSING, detour, need
            return self._slowed(place)
        return self._hold_back(ego, place, detour, block)

    def _is_free_for_sure(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], need: Need) -> bool:
        """Whether the way round is free, and has been for a moment."""
        if ego.time_s < self._not_before_s or not self._is_free(ego, place, others, need):
            self._free_since_s = None
            return False
        self._free_since_s = ego.time_s if self._free_since_s is None else self._free_since_s
        return ego.time_s - self._free_since_s >= SURE_S

    def _plan(self, block: StandingRow, place: PathPosition) -> Detour | None:
        """The way round a block, None where there is none."""
        body, passing, road = self._body, self._passing, self._road
        if block.to_s_m - block.from_s_m > LONGEST_BLOCK_M:
            return None
        begin_m = min(0.0, place.lateral_m)
        latest_s_m = block.from_s_m - body.front_m - ALONG_M
        aside_s_m = latest_s_m - STRAIGHT_S * passing.top_mps
        until_s_m = block.to_s_m + body.rear_m + ALONG_M
        if road.meets_junction(aside_s_m, until_s_m):
            return None
        room_m = road.least_left_room_m(self._path, aside_s_m, until_s_m) - EDGE_M - body.half_width_m
        beside_m = min(passing.beside_m, room_m + block.left_m - body.half_width_m)
        offset_m = block.left_m - body.half_width_m - beside_m
        if beside_m < LEAST_BESIDE_M or offset_m >= 0.0:
            return None
        usual_m = swing_m(offset_m, passing.top_mps, self._manner.lateral_accel_mps2)
        from_s_m = max(aside_s_m - usual_m, place.s_m)
        to_s_m = min(until_s_m + usual_m, road.next_line_s_m(until_s_m) - body.front_m - ALONG_M)
        aside_s_m = max(aside_s_m, from_s_m + tightest_swing_m(offset_m - begin_m))
        if aside_s_m > latest_s_m or to_s_m - until_s_m < tightest_swing_m(offset_m):
            return None
        self._latest_s_m = latest_s_m
        extent = Extent(from_s_m, aside_s_m, until_s_m, to_s_m)
        if self._is_forbidden(extent):
            return None
        if self._planned is None or _differs(self._planned, extent, offset_m):
            self._planned = make_detour(self._path, extent, offset_m, self._manner, passing.top_mps, begin_m)
        return self._planned

    def _is_forbidden(self, extent: Extent) -> bool:
        """Whether a junction, a line or a service stop lies where one would be out of the lane."""
        marks = (*self._road.lines_s_m, *self._road.stops_s_m)
        inside = any(extent.from_s_m < mark < extent.to_s_m for mark in marks)
        return inside or self._road.meets_junction(extent.from_s_m, extent.to_s_m)

    def _need_of(self, detour: Detour, block: StandingRow) -> Need:
        """What the way round needs of others."""
        accel_mps2 = USED_SHARE * self._manner.comfort.accel_mps2
        return Need(detour, block.members, accel_mps2, self._passing.margin_s, self._sight_m)

    def _is_free(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], need: Need) -> bool:
        """Whether the way is free of actors; a detour within the own lane always is."""
        half_lane_m = self._road.half_lane_m[self._path.index_at(need.detour.extent.aside_s_m)]
        if need.detour.offset_m - self._body.half_width_m > LINE_M - half_lane_m:
            return True
        return is_free(self._path, self._road, self._body, ego, place, others, need)

    def _hold_back(
        self, ego: DrivenVehicle, place: PathPosition, detour: Detour, block: StandingRow
    ) -> list[Restriction]:
        """Wait where there is still room to get out of the lane; in a queue, and where it is too late, close up."""
        left_m = detour.extent.from_s_m - place.s_m
        too_late = slowing_distance_m(max(ego.speed_mps, 0.0), 0.0, 0.0, FIRM) > left_m + ARRIVED_M
        if block.least_patience_s > 0.0 or too_late:
            self.phase = PassingPhase.KEEPING
            return []
        self.phase = PassingPhase.WAITING
        return [Restriction(left_m, 0.0, Urgency.FIRM, "waiting to pass")]

    def _slowed(self, place: PathPosition) -> list[Restriction]:
        """The speed of the way round, where it begins."""
        assert self.detour is not None
        left_m = self.detour.extent.from_s_m - place.s_m
        return [Restriction(left_m, self.detour.speed_mps, Urgency.GENTLE, "passing")] if left_m > 0.0 else []

    def _pass(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], need: Need) -> list[Restriction]:
        """On the way round: go on, give up while one can, and come back."""
        extent = need.detour.extent
        if place.s_m - self._body.rear_m > extent.to_s_m:
            self._end(PassingPhase.KEEPING)
            return []
        if self._can_give_up(ego, place, need.detour):
            if not self._is_free(ego, place, others, need._replace(margin_s=0.0)):
                self._end(PassingPhase.WAITING)
                self._not_before_s = ego.time_s + AGAIN_S
                stop_m = slowing_distance_m(max(ego.speed_mps, 0.0), 0.0, 0.0, FIRM)
                return [Restriction(stop_m, 0.0, Urgency.FIRM, "oncoming traffic")]
        elif self._drives_beside(place, others, need):
            return [Restriction(0.0, 0.0, Urgency.FIRM, "it drives on")]
        return self._slowed(place)

    def _can_give_up(self, ego: DrivenVehicle, place: PathPosition, detour: Detour) -> bool:
        """Whether one could still stop and set out again from there later."""
        stop_m = slowing_distance_m(max(ego.speed_mps, 0.0), 0.0, 0.0, FIRM)
        left_m = detour.offset_m - min(0.0, place.lateral_m)
        return place.s_m + stop_m + tightest_swing_m(left_m) <= self._latest_s_m

    def _drives_beside(self, place: PathPosition, others: Sequence[Other], need: Need) -> bool:
        """Whether an actor that was to be passed has begun to drive beside us; it goes first."""
        for other in others:
            if other.id in need.members and other.speed_mps > STANDING_TRAFFIC_MPS:
                s_m = self._path.follow(other.x_m, other.y_m, place.near).s_m
                ahead_m = s_m - place.s_m
                reach_m = other.half_length_m + 1.0
                if -self._body.rear_m - reach_m < ahead_m < self._body.front_m + reach_m:
                    return True
        return False

    def _end(self, phase: PassingPhase) -> None:
        """Drop the detour and go to the phase that follows."""
        self.phase, self.detour, self._need, self._free_since_s = phase, None, None, None


def _differs(planned: Detour, extent: Extent, offset_m: float) -> bool:
    """Whether a detour differs from the one planned before."""
    return any(
        abs(a - b) > SAME_M for a, b in zip((*planned.extent, planned.offset_m), (*extent, offset_m), strict=True)
    )
