"""What a watcher of the traffic writes down: who stands and why, who touches whom, who runs a light or a stop sign.

Everything is judged from the snapshots alone, so that no opinion of the server or of the Traffic Manager is asked.
"""

from collections import Counter
from typing import NamedTuple

import carla
import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import TrafficLightState

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

STANDS_MPS = 0.1
MOVED_M = 20.0
LIMITS_S = (60.0, 120.0, 300.0)
QUEUE_GAP_M = 8.0
"""Who stands with somebody this near before its front stands in a queue; the Traffic Manager keeps 2 to 5 m."""
QUEUE_WIDTH_M = 2.5
TOUCH_M = 0.05
PILE_UP_S = 10.0
SIGN_BEFORE_M, SIGN_AFTER_M, SIGN_ACROSS_M = 4.0, 5.0, 1.5
"""Where a front bumper is at a stop sign, seen from the middle of its trigger volume, 3 m before the line."""
SIGN_TURN_DEG = 90.0
"""CARLA's models of signs are turned by this against the traffic they are for."""


class Fleet(NamedTuple):
    """The vehicles watched; N of them."""

    ids: NDArray[np.uint32]
    half_m: F64
    """(N, 2) half length and half width."""
    offset_m: F64
    """(N,) of the box's middle before the origin."""


class Signs(NamedTuple):
    """Stop signs; S of them."""

    centre_m: F64
    """(S, 2) of the trigger volumes, in the world."""
    yaw_rad: F64
    """(S,) of the traffic that they are for."""


def fleet_of(actors: list[carla.Actor]) -> Fleet:
    """Return what has to be known of vehicles that do not change."""
    boxes = [actor.bounding_box for actor in actors]
    return Fleet(
        np.array([actor.id for actor in actors], np.uint32),
        np.array([(box.extent.x, box.extent.y) for box in boxes]),
        np.array([box.location.x for box in boxes]),
    )


def stop_signs(world: carla.World) -> Signs:
    """Return where vehicles have to stop for a sign."""
    found = []
    for sign in world.get_actors().filter("traffic.stop"):
        pose = sign.get_transform()
        middle = pose.transform(carla.Location(sign.trigger_volume.location))
        found.append((middle.x, middle.y, np.radians(pose.rotation.yaw - SIGN_TURN_DEG)))
    table = np.array(found).reshape(-1, 3)
    return Signs(table[:, :2], table[:, 2])


class Watch:
    """One run's notes; :meth:`see` is called once a frame."""

    def __init__(self, fleet: Fleet, signs: Signs, step_s: float) -> None:
        count = len(fleet.ids)
        self._fleet, self._signs, self._step_s = fleet, signs, step_s
        self.ids, self.place = fleet.ids, np.full((count, 3), np.nan)
        self.driven_m, self.time_s = np.zeros(count), 0.0
        self.present: Flags = np.ones(count, bool)
        self._standing_s, self._idle_s = np.zeros(count), np.zeros(count)
        self.longest_standing_s, self.longest_idle_s = np.zeros(count), np.zeros(count)
        self.worst_place = np.zeros((count, 2))
        self._touching_s: dict[tuple[int, int], float] = {}
        self.collisions, self.pile_ups, self.fallen = 0, 0, np.zeros(count, bool)
        self._came_at_red: Flags = np.zeros(count, bool)
        self._under: Flags = np.zeros(count, bool)
        self._seen_green: Flags = np.zeros(count, bool)
        self.red_runs, self.red_waits = 0, 0
        self._at_sign = np.full(count, -1)
        self._slowest_mps = np.full(count, np.inf)
        self.sign_passes: Counter[str] = Counter()

    def see(self, rows: NDArray[np.void]) -> None:
        """Take note of a frame."""
        self.time_s += self._step_s
        rows = self._in_order(rows)
        place, yaw_rad = rows["location"].astype(np.float64), np.radians(rows["rotation"][:, 1].astype(np.float64))
        moved_m = np.nan_to_num(np.linalg.norm((place - self.place)[:, :2], axis=1))
        self.driven_m[self.present] += moved_m[self.present]
        speed_mps = moved_m / self._step_s  # of the motion seen: what is teleported has no velocity
        self.place = place
        self._note_fallen(rows)
        middle = place[:, :2] + self._fleet.offset_m[:, None] * np.column_stack([np.cos(yaw_rad), np.sin(yaw_rad)])
        near = self._near_pairs(middle)
        self._note_touching(middle, yaw_rad, near)
        self._note_standing(rows, speed_mps, middle, yaw_rad, near)
        self._note_lights(rows)
        self._note_signs(middle, yaw_rad, speed_mps)

    def _in_order(self, rows: NDArray[np.void]) -> NDArray[np.void]:
        """Return one row for each vehicle of the fleet; of those that are gone, whatever comes first."""
        order = np.argsort(rows["id"])
        found = np.searchsorted(rows["id"][order], self._fleet.ids).clip(max=len(rows) - 1)
        chosen = rows[order[found]]
        self.present &= chosen["id"] == self._fleet.ids
        return chosen

    def _note_fallen(self, rows: NDArray[np.void]) -> None:
        pitch, roll = rows["rotation"][:, 0], rows["rotation"][:, 2]
        self.fallen |= self.present & ((np.abs(pitch) > 45.0) | (np.abs(roll) > 45.0))

    def _near_pairs(self, middle: F64) -> NDArray[np.int64]:
        """Return the pairs (P, 2) of vehicles whose middles lie within 20 m, both ways round."""
        gap = middle[:, None, :] - middle[None, :, :]
        near = (gap**2).sum(axis=2) < 400.0
        near[~self.present] = False
        near[:, ~self.present] = False
        np.fill_diagonal(near, val=False)
        return np.argwhere(near)

    def _separation_m(self, middle: F64, yaw_rad: F64, pairs: NDArray[np.int64]) -> F64:
        """Return for each pair how far the boxes lie apart along the first one's axes: at most their distance (P,)."""
        one, other = pairs.T
        gap, turn = middle[other] - middle[one], yaw_rad[other] - yaw_rad[one]
        cos, sin = np.cos(yaw_rad[one]), np.sin(yaw_rad[one])
        along, across = np.abs(gap[:, 0] * cos + gap[:, 1] * sin), np.abs(gap[:, 1] * cos - gap[:, 0] * sin)
        c, s, half, far = np.abs(np.cos(turn)), np.abs(np.sin(turn)), self._fleet.half_m[one], self._fleet.half_m[other]
        return np.maximum(
            along - half[:, 0] - far[:, 0] * c - far[:, 1] * s, across - half[:, 1] - far[:, 0] * s - far[:, 1] * c
        )

    def _note_touching(self, middle: F64, yaw_rad: F64, near: NDArray[np.int64]) -> None:
        apart_m = np.maximum(
            self._separation_m(middle, yaw_rad, near), self._separation_m(middle, yaw_rad, near[:, ::-1])
        )
        touching = {(int(a), int(b)) for a, b in near[(apart_m < TOUCH_M) & (near[:, 0] < near[:, 1])]}
        self.collisions += len(touching - self._touching_s.keys())
        before = self._touching_s
        self._touching_s = {pair: before.get(pair, 0.0) + self._step_s for pair in sorted(touching)}
        lasting = [pair for pair, since_s in self._touching_s.items() if since_s > PILE_UP_S]
        self.pile_ups += sum(before.get(pair, 0.0) <= PILE_UP_S for pair in lasting)

    def _note_standing(
        self, rows: NDArray[np.void], speed_mps: F64, middle: F64, yaw_rad: F64, near: NDArray[np.int64]
    ) -> None:
        """Count how long each stands, and how long without a reason: a light, a sign, or somebody right before it."""
        stands = self.present & (speed_mps < STANDS_MPS)
        one, other = near.T
        gap = middle[other] - middle[one]
        along = gap[:, 0] * np.cos(yaw_rad[one]) + gap[:, 1] * np.sin(yaw_rad[one])
        across = np.abs(gap[:, 1] * np.cos(yaw_rad[one]) - gap[:, 0] * np.sin(yaw_rad[one]))
        free = along - self._fleet.half_m[one, 0] - self._fleet.half_m[other, 0]
        queued = np.zeros(len(stands), bool)
        queued[one[(along > 0.0) & (free < QUEUE_GAP_M) & (across < QUEUE_WIDTH_M)]] = True
        reason = queued | (rows["traffic_light_state"] != TrafficLightState.GREEN)
        self._standing_s = np.where(stands, self._standing_s + self._step_s, 0.0)
        self._idle_s = np.where(stands & ~reason, self._idle_s + self._step_s, 0.0)
        longer = self._standing_s > self.longest_standing_s
        self.worst_place[longer] = middle[longer]
        self.longest_standing_s = np.maximum(self.longest_standing_s, self._standing_s)
        self.longest_idle_s = np.maximum(self.longest_idle_s, self._idle_s)

    def _note_lights(self, rows: NDArray[np.void]) -> None:
        """Count who came to a red light and left it without having seen another colour."""
        under = self.present & (rows["has_traffic_light"] != 0)
        red = rows["traffic_light_state"] == TrafficLightState.RED
        came, left = under & ~self._under, self._under & ~under & self.present
        self._came_at_red = np.where(came, red, self._came_at_red)
        self._seen_green = np.where(came, ~red, self._seen_green | (under & ~red))
        self.red_runs += int((left & self._came_at_red & ~self._seen_green).sum())
        self.red_waits += int((left & self._came_at_red & self._seen_green).sum())
        self._under = under

    def _note_signs(self, middle: F64, yaw_rad: F64, speed_mps: F64) -> None:
        """Count who passes a stop sign having stood, crept (below 3 km/h) or neither."""
        forward = np.column_stack([np.cos(yaw_rad), np.sin(yaw_rad)])
        if not len(self._signs.yaw_rad):
            return
        gap = (middle + self._fleet.half_m[:, :1] * forward)[:, None, :] - self._signs.centre_m[None, :, :]
        along = gap[..., 0] * forward[:, :1] + gap[..., 1] * forward[:, 1:]
        across = gap[..., 1] * forward[:, :1] - gap[..., 0] * forward[:, 1:]
        same_way = np.cos(yaw_rad[:, None] - self._signs.yaw_rad) > np.cos(np.radians(40.0))
        near = (along > -SIGN_BEFORE_M) & (along < SIGN_AFTER_M) & (np.abs(across) < SIGN_ACROSS_M)
        inside = near & same_way & self.present[:, None]
        sign = np.where(inside.any(axis=1), inside.argmax(axis=1), -1)
        left = (self._at_sign >= 0) & (sign != self._at_sign)
        for slowest in self._slowest_mps[left & self.present]:
            self.sign_passes["stood" if slowest < STANDS_MPS else "crept" if slowest < 3.0 / 3.6 else "passed"] += 1
        stays = sign == self._at_sign
        self._slowest_mps = np.where(stays, np.minimum(self._slowest_mps, speed_mps), speed_mps)
        self._at_sign = sign
