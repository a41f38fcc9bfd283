"""Detects a tailgater and makes room for it: over to a lane of the same direction on the right, and back.

It needs a free lane that continues past no junction, line or service stop. The vehicle returns only when no actor is
beside it or close behind in its former lane.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.agents.builtin.passing.detour import Extent, make_detour, swing_m, tightest_swing_m
from basu.agents.builtin.scene import ActorKind, Restriction, Urgency

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.agents.builtin.driving.manner import Manner
    from basu.agents.builtin.driving.path import PathPosition, SampledPath
    from basu.agents.builtin.passing.detour import Detour
    from basu.agents.builtin.passing.road import RoadBesidePath
    from basu.agents.builtin.scene import DrivenVehicle, Other, VehicleGeometry


LEAST_MPS = 2.0  # a vehicle that hardly moves has no tailgater
TAILGATER_WITHIN_M = 40.0
SAME_WAY_RAD = math.radians(45.0)
NOTICED_S = 1.0  # it has to go on for so long …
FORGOTTEN_S = 3.0  # … and is over after so long


class Tailgating:
    """Whether an actor follows at less than ``near_s`` seconds; 0 switches the check off."""

    def __init__(self, body: VehicleGeometry, near_s: float) -> None:
        self.is_on = False
        self._body = body
        self._near_s = near_s
        self._changed_s: float | None = None

    def step(self, ego: DrivenVehicle, path: SampledPath, place: PathPosition, others: Sequence[Other]) -> bool:
        """Look behind; the answer changes only after a while."""
        seen = (
            self._near_s > 0.0 and ego.speed_mps > LEAST_MPS and any(self._is_one(ego, path, place, o) for o in others)
        )
        if seen == self.is_on:
            self._changed_s = None
            return self.is_on
        self._changed_s = ego.time_s if self._changed_s is None else self._changed_s
        if ego.time_s - self._changed_s >= (NOTICED_S if seen else FORGOTTEN_S):
            self.is_on, self._changed_s = seen, None
        return self.is_on

    def _is_one(self, ego: DrivenVehicle, path: SampledPath, place: PathPosition, other: Other) -> bool:
        """Whether one other follows too closely in our lane."""
        if other.kind is not ActorKind.VEHICLE or other.speed_mps < LEAST_MPS:
            return False
        dx_m, dy_m = other.x_m - ego.x_m, other.y_m - ego.y_m
        if dx_m * dx_m + dy_m * dy_m > TAILGATER_WITHIN_M * TAILGATER_WITHIN_M:
            return False
        behind = dx_m * math.cos(ego.yaw_rad) + dy_m * math.sin(ego.yaw_rad) < 0.0
        if not behind or abs(math.remainder(other.yaw_rad - ego.yaw_rad, math.tau)) > SAME_WAY_RAD:
            return False
        there = path.follow(other.x_m, other.y_m, place.near)
        if abs(there.lateral_m) > self._body.half_width_m + other.half_width_m:
            return False
        gap_m = place.s_m - self._body.rear_m - there.s_m - other.half_length_m
        return gap_m < self._near_s * ego.speed_mps


ALONG_M = 40.0  # driven in the other lane at least
LONGER_M = 20.0  # added while an actor blocks the way back
BEHIND_M, AHEAD_M = 20.0, 10.0  # no actor this near before and behind in the target lane
DECIDES_M = 10.0  # before the way back begins it is seen whether it is clear
LIKE_M = 0.3  # a lane that lies so much elsewhere is another lane
SLOWEST_MPS = 3.0  # changes of lane are planned for this speed at least


class PullingOver:
    """The state of making room; ``detour`` is what to drive instead of the path, None while one keeps to it."""

    def __init__(self, path: SampledPath, road: RoadBesidePath, body: VehicleGeometry, manner: Manner) -> None:
        self.detour: Detour | None = None
        self._path, self._road, self._body, self._manner = path, road, body, manner

    def step(
        self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other], *, tailgated: bool
    ) -> list[Restriction]:
        """Begin, go on, or come back; ``place`` is beside the task's own path."""
        if self.detour is None:
            self.detour = self._plan(ego, place, others) if tailgated else None
            return []
        extent = self.detour.extent
        if place.s_m - self._body.rear_m > extent.to_s_m:
            self.detour = None
        elif extent.until_s_m - DECIDES_M < place.s_m < extent.until_s_m:
            if self._is_clear(place, others, 0.0, self.detour.offset_m / 2.0):
                return []
            drawn_out = extent._replace(
                from_s_m=place.s_m - DECIDES_M,
                aside_s_m=place.s_m - DECIDES_M / 2.0,
                until_s_m=extent.until_s_m + LONGER_M,
                to_s_m=extent.to_s_m + LONGER_M,
            )
            if not self._goes_on(drawn_out, self.detour.offset_m):
                return [Restriction(extent.until_s_m - place.s_m, 0.0, Urgency.FIRM, "no gap to return")]
            offset_m = self.detour.offset_m
            self.detour = make_detour(self._path, drawn_out, offset_m, self._manner, self.detour.speed_mps, offset_m)
        return []

    def _plan(self, ego: DrivenVehicle, place: PathPosition, others: Sequence[Other]) -> Detour | None:
        """The way over and back, None where there is none."""
        offset_m = self._road.right_lane_m[place.near]
        if offset_m <= 0.0:
            return None
        speed_mps = max(ego.speed_mps, SLOWEST_MPS)
        usual_m = max(swing_m(offset_m, speed_mps, self._manner.lateral_accel_mps2), tightest_swing_m(offset_m))
        aside_s_m = place.s_m + usual_m
        extent = Extent(place.s_m, aside_s_m, aside_s_m + ALONG_M, aside_s_m + ALONG_M + usual_m)
        if not self._goes_on(extent, offset_m) or not self._is_clear(place, others, offset_m, offset_m / 2.0):
            return None
        return make_detour(self._path, extent, offset_m, self._manner, self._road.limit_mps[place.near])

    def _goes_on(self, extent: Extent, offset_m: float) -> bool:
        """Whether the lane is there for so long, and nothing on the way needs our own."""
        road, path = self._road, self._path
        first, end = path.index_at(extent.aside_s_m), path.index_at(extent.until_s_m) + 1
        beside = all(abs(there_m - offset_m) < LIKE_M for there_m in road.right_lane_m[first:end])
        marks = any(extent.from_s_m < mark < extent.to_s_m for mark in (*road.lines_s_m, *road.stops_s_m))
        ends = extent.to_s_m > path.end_s_m
        return beside and not marks and not ends and not road.meets_junction(extent.from_s_m, extent.to_s_m)

    def _is_clear(self, place: PathPosition, others: Sequence[Other], lane_m: float, half_m: float) -> bool:
        """Whether no actor is near in the lane with its middle ``lane_m`` to the right of ours."""
        for other in others:
            there = self._path.follow(other.x_m, other.y_m, place.near)
            ahead_m = there.s_m - place.s_m
            near = -BEHIND_M < ahead_m < self._body.front_m + other.half_length_m + AHEAD_M
            if near and abs(there.lateral_m - lane_m) < half_m + other.half_width_m / 2.0:
                return False
        return True
