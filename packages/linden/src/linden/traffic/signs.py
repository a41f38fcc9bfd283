"""Stop and yield signs as CARLA's server reports them to drivers: as a red light.

A vehicle that reaches a stop sign's volume reads red for :data:`STOP_S`, and then for as long as an actor is where its
way crosses (``opendrive.give_way``); at a yield sign only as long as that. The Traffic Manager asks for no more: under
such a red it halts, and goes when the vehicles before it have gone. Source: CARLA 0.9.16, StopSignComponent.cpp and
YieldSignComponent.cpp. There a vehicle that drives off at red reads red until the next sign or light; here it does not.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.protocol.values.enums import TrafficLightState
from linden.structured import StructuredArray
from linden.traffic.trigger_volumes import REACH_M, TriggerGrid, boxes_touch, owners_over

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Flags = NDArray[np.bool_]

STOP_S = 2.0
"""How long one stands at a stop sign at least."""
CLEAR_S = 0.5
"""How long the way must have been free."""
NOWHERE = -1

_RED = int(TrafficLightState.RED)
_GREEN = int(TrafficLightState.GREEN)
_ROUNDING_S = 1e-6


class SignRules(NamedTuple):
    """The stop and yield signs of a map; S signs, B squares. Nothing in it changes."""

    grid: TriggerGrid
    """The volumes in which they take effect, each with the number of its sign."""
    is_stop: Flags
    """(S,)"""
    first: I32
    """(S + 1,) where each sign's squares begin."""
    centre_m: F64
    """(B, 3)"""
    half_m: F64
    """(B,)"""
    yaw_rad: F64
    """(B,)"""
    middle_m: F64
    """(S, 2) of a circle round all squares of a sign."""
    radius_m: F64
    """(S,) of that circle; 0 where there is no square."""


def sign_rules(grid: TriggerGrid, is_stop: Flags, squares: list[StructuredArray]) -> SignRules:
    """Return the rules of S signs, each with its squares, of ``opendrive.placed.GIVE_WAY``."""
    middle_m, radius_m = np.zeros((len(squares), 2)), np.zeros(len(squares))
    for sign, own in enumerate(squares):
        if len(own):
            centres = own["centre_m"][:, :2]
            middle_m[sign] = (centres.min(axis=0) + centres.max(axis=0)) / 2.0
            away_m = np.linalg.norm(centres - middle_m[sign], axis=1)
            radius_m[sign] = float((away_m + math.sqrt(2.0) * own["half_m"]).max())
    counts = [len(own) for own in squares]
    return SignRules(
        grid,
        is_stop,
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        np.concatenate([np.zeros((0, 3)), *(own["centre_m"] for own in squares)]),
        np.concatenate([np.zeros(0), *(own["half_m"] for own in squares)]),
        np.concatenate([np.zeros(0), *(own["yaw_rad"] for own in squares)]),
        middle_m,
        radius_m,
    )


class Waiting(NamedTuple):
    """The state of the vehicles under signs; a row for each body's slot."""

    actor_id: I32
    """The actor, for a slot may get another one."""
    sign: I32
    since_s: F64
    """When it came."""
    busy_until_s: F64
    """Until when the way counts as occupied."""

    @staticmethod
    def none(slots: int) -> "Waiting":
        """Return room for that many slots without waiting vehicles."""
        nowhere = np.full(slots, NOWHERE, np.int32)
        return Waiting(nowhere.copy(), nowhere, np.zeros(slots), np.full(slots, -math.inf))

    def with_room(self, slots: int) -> "Waiting":
        """Return the same with room for that many slots."""
        more = slots - len(self.actor_id)
        if more <= 0:
            return self
        grown = Waiting.none(more)
        return Waiting(
            np.concatenate([self.actor_id, grown.actor_id]),
            np.concatenate([self.sign, grown.sign]),
            np.concatenate([self.since_s, grown.since_s]),
            np.concatenate([self.busy_until_s, grown.busy_until_s]),
        )


class BodyColumns(NamedTuple):
    """The bodies' columns that are read here, (N, 3); see ``triggers.owners_over``."""

    position_m: F64
    rotation_rad: F64
    box_centre_m: F64
    half_extent_m: F64


class SignWatch:
    """The vehicles that wait at the signs of one episode."""

    def __init__(self, rules: SignRules) -> None:
        self._rules = rules
        self._waiting = Waiting.none(0)

    def told(self, bodies: BodyColumns, slots: I32, actor_ids: I32, now_s: float) -> U8:
        """Return the colour (V,) that each of ``slots`` reads off the sign it is under; green where there is none.

        Args:
            bodies: where everybody is.
            slots: (V,) of the vehicles.
            actor_ids: (V,) ids of their actors.
            now_s: simulated time; the same twice gives the same twice.
        """
        rules = self._rules
        if not len(rules.is_stop):
            return np.full(len(slots), _GREEN, np.uint8)
        self._waiting = self._waiting.with_room(len(bodies.position_m))
        over = owners_over(
            rules.grid, bodies.position_m, bodies.rotation_rad, bodies.box_centre_m, bodies.half_extent_m, slots
        )
        return _colours(rules, self._waiting, over, bodies, slots, actor_ids, now_s)


@kernel
def _colours(
    rules: SignRules, waiting: Waiting, over: I32, bodies: BodyColumns, slots: I32, actor_ids: I32, now_s: float
) -> U8:  # pragma: no cover - compiled
    colours = np.full(len(slots), _GREEN, np.uint8)
    for i in range(len(slots)):
        slot, sign = slots[i], over[i]
        if waiting.actor_id[slot] != actor_ids[i] or waiting.sign[slot] != sign:
            waiting.actor_id[slot], waiting.sign[slot] = actor_ids[i], sign
            waiting.since_s[slot], waiting.busy_until_s[slot] = now_s, -math.inf
        if sign < 0:
            continue
        if _way_is_occupied(rules, sign, over, bodies, slots):
            waiting.busy_until_s[slot] = now_s + CLEAR_S
        stopping = rules.is_stop[sign] and now_s < waiting.since_s[slot] + STOP_S - _ROUNDING_S
        if stopping or now_s < waiting.busy_until_s[slot] - _ROUNDING_S:
            colours[i] = _RED
    return colours


@kernel
def _way_is_occupied(
    rules: SignRules, sign: int, over: I32, bodies: BodyColumns, slots: I32
) -> bool:  # pragma: no cover - compiled
    """Whether a vehicle that is not itself under the sign touches one of its squares."""
    if rules.radius_m[sign] == 0.0:
        return False
    reach_m = rules.radius_m[sign] + REACH_M
    for j in range(len(slots)):
        if over[j] == sign:
            continue
        slot = slots[j]
        dx = bodies.position_m[slot, 0] - rules.middle_m[sign, 0]
        dy = bodies.position_m[slot, 1] - rules.middle_m[sign, 1]
        if dx * dx + dy * dy > reach_m * reach_m:
            continue
        yaw_rad = bodies.rotation_rad[slot, 1]
        cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
        x = bodies.position_m[slot, 0] + cosine * bodies.box_centre_m[slot, 0] - sine * bodies.box_centre_m[slot, 1]
        y = bodies.position_m[slot, 1] + sine * bodies.box_centre_m[slot, 0] + cosine * bodies.box_centre_m[slot, 1]
        z = bodies.position_m[slot, 2] + bodies.box_centre_m[slot, 2]
        half_x, half_y = bodies.half_extent_m[slot, 0], bodies.half_extent_m[slot, 1]
        for square in range(rules.first[sign], rules.first[sign + 1]):
            half_m = rules.half_m[square]
            if abs(rules.centre_m[square, 2] - z) > half_m + bodies.half_extent_m[slot, 2]:
                continue
            gap_x, gap_y = rules.centre_m[square, 0] - x, rules.centre_m[square, 1] - y
            if boxes_touch(gap_x, gap_y, yaw_rad, half_x, half_y, rules.yaw_rad[square], half_m, half_m):
                return True
    return False
