"""`Drives`: what `basu` would find in the drives of many vehicles on one route, frame by frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from basu.conditions import STEP_S
from basu.metrics.collisions import is_separate
from basu.metrics.delays import SLOWEST_MPS, time_limit_s
from basu.metrics.ending import GOES_ON
from basu.metrics.speeding import holding_mps
from basu.metrics.validity import PlannedLanes, widths_m
from linden_gym.following import EPISODE, begun, judge, locate, pass_signs, watch_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.gym_spaces import RouteAhead
    from basu.gym_view import EgoRows
    from basu.records.history import Vehicle
    from basu.routing import Route
    from linden_gym.lane_field import LaneField

LONG_AGO = -(10**9)
"""Tick of the latest contact of a party that was never touched."""

SCENERY_KINDS = 256
"""Parties before the bodies in slots: the kinds of scenery, each of which counts as one."""


class Drives:
    """The drives of W vehicles along one route.

    Attributes:
        table: records of `linden_gym.following.DRIVE` (W,).
        infractions: (W,) how many each drive has had until its latest frame.
        stopped: (W, S) whether each vehicle has stopped at each stop sign of the route.
    """

    def __init__(self, count: int, route: Route, ahead: RouteAhead, lanes: LaneField, vehicle: Vehicle) -> None:
        self._route, self._field, self._lanes = route, lanes, PlannedLanes(route)
        self._points_m = np.ascontiguousarray(route.points_m)
        self._widths_m = widths_m(route)
        self._limit_s = time_limit_s(route)
        self._ahead = ahead
        self._middle_m = (vehicle.front_m - vehicle.rear_m) / 2.0
        self.table = begun(np.zeros(count), np.full(count, self._limit_s))
        self.infractions = np.zeros(count, np.int64)
        self._speeding = np.zeros(count, EPISODE)
        self._settled = np.zeros(count, np.int64)  # infractions that can change no more
        self.stopped, self._passed = (np.zeros((count, len(ahead.signs_m)), np.bool_) for _ in range(2))
        self._touched = np.full((count, SCENERY_KINDS + 1), LONG_AGO, np.int64)

    def begin(self, rows: NDArray[np.int64], from_m: NDArray[np.float64]) -> None:
        """Begin the drives of vehicles (K,) anew, at places (K,) along the route; their first frame is the next.

        A drive that begins on the way counts as one that has obeyed all before. It has stopped at the signs behind it.
        It has the time that the rest of the route may take.
        """
        self.table[rows] = begun(from_m, self._limit_s - from_m / SLOWEST_MPS)
        self.infractions[rows], self._settled[rows] = 0, 0
        self._speeding[rows] = np.zeros((), EPISODE)
        self.stopped[rows], self._passed[rows] = self._ahead.to_signs_m(from_m) < 0.0, False
        self._touched[rows] = LONG_AGO

    @property
    def driven_m(self) -> NDArray[np.float64]:
        """(W,) how much of the route each vehicle has validly driven."""
        driven_m: NDArray[np.float64] = self.table["reached_m"] - self.table["gap_m"]
        return driven_m

    def advance(self, rows: NDArray[np.int64], ego: EgoRows, limit_mps: NDArray[np.float64], contacts: Any) -> None:  # noqa: ANN401 - records
        """Take in the next frame of drives (K,) in ``rows``.

        Args:
            rows: numbers of the drives, ascending.
            ego: the motion of their vehicles, (K,) each.
            limit_mps: (K,) what is posted to them; 0 for none.
            contacts: records of `linden.physics.step.CONTACT` of the frame; slot 0 is the vehicle under test.
        """
        before_s_m, speed_mps = self.table["s_m"][rows], ego.speed_mps
        locate(
            self.table, rows, self._route.s_m, self._points_m, self._widths_m,
            ego.x_m, ego.y_m,
        )  # fmt: skip
        off_lane_m, same_side = self._beside(rows, ego)
        judge(
            self.table, rows, before_s_m, self._route.s_m, self._route.yaw_rad, self._widths_m,
            ego.x_m, ego.y_m, ego.yaw_rad, ego.velocity_x_mps, ego.velocity_y_mps, speed_mps,
            off_lane_m, same_side,
        )  # fmt: skip
        self._settled[rows] += self._new_contacts(rows, contacts) + self._signs_run(rows, speed_mps)
        self.infractions[rows] = self._speeding_until_now(rows, speed_mps, limit_mps) + self._settled[rows]

    @property
    def ended(self) -> NDArray[np.bool_]:
        """(W,) whether the latest frame is the last one."""
        ended: NDArray[np.bool_] = self.table["ending"] != GOES_ON
        return ended

    def _beside(self, rows: NDArray[np.int64], ego: EgoRows) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Return (K,) the distance from all lanes and whether one of the planned side is there, where that matters."""
        off_lane_m, same_side = np.full(len(rows), np.inf), np.zeros(len(rows), np.bool_)
        out = np.flatnonzero(self.table["off_edge_m"][rows] > 0.0)
        if len(out):
            found = self._field.under(ego.x_m[out], ego.y_m[out])
            off_lane_m[out] = found.off_lane_m
            columns = (self.table["at"][rows[out]], found.road_id, found.lane_id, found.in_junction, found.off_lane_m)
            same_side[out] = [
                self._lanes.in_lane_of_same_side(*each)
                for each in zip(*(column.tolist() for column in columns), strict=True)
            ]
        return off_lane_m, same_side

    def _new_contacts(self, rows: NDArray[np.int64], contacts: Any) -> NDArray[np.int64]:  # noqa: ANN401 - records
        """Return (K,) how many contacts of the vehicles begin in the frame."""
        new = np.zeros(len(rows), np.int64)
        if not len(contacts):
            return new
        place = np.full(len(self.table), -1)
        place[rows] = np.arange(len(rows))
        mine = contacts[(place[contacts["world"]] >= 0) & ((contacts["a"] == 0) | (contacts["b"] == 0))]
        if not len(mine):
            return new
        other = np.where(mine["a"] == 0, mine["b"], mine["a"])
        party = np.where(other < 0, mine["tag"], SCENERY_KINDS + other)
        if party.max() >= self._touched.shape[1]:
            room = np.full((len(self._touched), int(party.max()) + 1), LONG_AGO, np.int64)
            room[:, : self._touched.shape[1]] = self._touched
            self._touched = room
        parties = self._touched.shape[1]
        world, party = np.divmod(np.unique(mine["world"].astype(np.int64) * parties + party), parties)
        tick = self.table["tick"][world]
        begins = is_separate(tick - self._touched[world, party], STEP_S)
        self._touched[world, party] = tick
        np.add.at(new, place[world], begins)
        return new

    def _signs_run(self, rows: NDArray[np.int64], speed_mps: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return (K,) how many stop signs the vehicles pass in the frame without having stopped."""
        run = np.zeros(len(rows), np.int64)
        front_m, middle_m = self._ahead.columns.box_m[0], self._middle_m
        signs_m, stopped, passed = self._ahead.signs_m, self.stopped, self._passed
        pass_signs(self.table, rows, signs_m, front_m, middle_m, speed_mps, stopped, passed, run)
        return run

    def _speeding_until_now(
        self, rows: NDArray[np.int64], speed_mps: NDArray[np.float64], posted_mps: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """Return (K,) the infractions of episodes that go on; those of ended ones are settled."""
        at, in_lane = self.table["at"][rows], self.table["off_edge_m"][rows] == 0.0
        limit_mps = holding_mps(self._route.speed_limit_mps[at], posted_mps, in_lane)
        pending = np.zeros(len(rows), np.int64)
        watch_speed(self.table, rows, self._speeding, speed_mps, limit_mps, self._settled, pending)
        return pending
