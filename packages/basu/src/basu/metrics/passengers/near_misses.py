"""Near misses: actors that the vehicle nearly hit, by time to collision and post-encroachment time.

Time to collision (Hayward 1972): how long until both boxes touch if both go on as they do, the vehicle under test on
its present bend, the other straight ahead. Post-encroachment time (Allen, Shin and Cooper 1978): how long between one's
leaving a place and the other's coming to it. It applies only where their ways cross at 30 degrees or more, since a
follower in a lane takes the same places all the time. Crossings and the 1.5 s of time to collision are those of the
Surrogate Safety Assessment Model (FHWA-HRT-08-051, 2008), which screens with a post-encroachment time of 5 s; what is
called a near miss here is one of 1.5 s, a definition of ours.

To stop close before a thing is no near miss. With a thing that stands, the time to collision counts only while the
braking that is needed to stop before it, speed squared over twice the distance (Cooper and Ferguson 1976), is above the
2.5 m/s² that standing passengers can bear.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import other_boxes, own_boxes, time_to_touch_s, touching
from basu.metrics.passengers.felt import GRIP_MPS2
from basu.records.history.model import once
from basu.thresholds import AT_REST_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

NEAR_S = 1.5  # a time to collision or a post-encroachment time up to this is a near miss
SEEN_S = 3.0  # up to this it is listed
LEG_S = 0.25  # the vehicle's bend is followed in straight legs of this
CROSSING_RAD = math.radians(30.0)


class Party(NamedTuple):
    """An actor that came close; times are inf where they never fell to `SEEN_S`."""

    name: str  # blueprint id and actor id
    ttc_s: float  # least time to collision
    ttc_tick: int  # when, -1 for never
    pet_s: float  # least post-encroachment time
    pet_tick: int  # when the second of the two came to the place, -1 for never
    is_near_miss: bool
    detail: str


@once
def near_misses(history: History) -> tuple[Party, ...]:
    """All actors that came within `SEEN_S` of the vehicle in one of the two measures, by id."""
    if len(history.others) == 0:
        return ()
    own, others = own_boxes(history.facts, history.frames), other_boxes(history.facts, history.others)
    ttc_s = times_to_collision_s(history, own, others)
    ttc_s[_is_calm_before_thing(history, ttc_s)] = np.inf
    pet_s, pet_tick = post_encroachment_s(history, own, others)
    hit = {event.other_id for event in history.collisions}
    found = []
    for key in sorted({int(key) for key in np.unique(history.others["id"])} - hit):
        rows = np.flatnonzero(history.others["id"] == key)
        soonest, closest = rows[np.argmin(ttc_s[rows])], rows[np.argmin(pet_s[rows])]
        if min(ttc_s[soonest], pet_s[closest]) <= SEEN_S:
            found.append(_party(history, key, ttc_s[soonest], soonest, pet_s[closest], int(pet_tick[closest])))
    return tuple(found)


def _is_calm_before_thing(history: History, ttc_s: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(M,) rows of things before which the vehicle could still stop without throwing its passengers."""
    things = [key for key, kind in history.facts.actor_types.items() if kind.startswith("static.")]
    with np.errstate(divide="ignore"):
        needed_mps2 = history.speed_mps()[history.others["tick"]] / (2.0 * ttc_s)
    calm: NDArray[np.bool_] = np.isin(history.others["id"], things) & (needed_mps2 <= GRIP_MPS2)
    return calm


def _party(history: History, key: int, ttc_s: float, soonest: int, pet_s: float, pet_tick: int) -> Party:
    """The evidence about one actor."""
    name = f"{history.facts.actor_types.get(key, 'an unknown type')} (actor {key})"
    row, ttc_tick = history.others[soonest], int(history.others["tick"][soonest])
    said = []
    if ttc_s <= SEEN_S:
        speeds = history.speed_mps()[ttc_tick], math.hypot(row["velocity_x_mps"], row["velocity_y_mps"])
        at_s = float(history.frames["t_s"][ttc_tick])
        said.append(f"{ttc_s:.2f} s from a collision at {at_s:.1f} s, at {speeds[0]:.1f} and {speeds[1]:.1f} m/s")
    if pet_s <= SEEN_S:
        said.append(f"in each other's place within {pet_s:.2f} s at {float(history.frames['t_s'][pet_tick]):.1f} s")
    return Party(
        name=name,
        ttc_s=float(ttc_s),
        ttc_tick=ttc_tick if ttc_s <= SEEN_S else -1,
        pet_s=float(pet_s),
        pet_tick=pet_tick if pet_s <= SEEN_S else -1,
        is_near_miss=bool(min(ttc_s, pet_s) <= NEAR_S),
        detail=f"{name}: {', '.join(said)}",
    )


def times_to_collision_s(
    history: History, own: NDArray[np.float64], others: NDArray[np.float64], horizon_s: float = SEEN_S
) -> NDArray[np.float64]:
    """(M,) for each row of others, inf beyond ``horizon_s``; ``own`` (T, 5) and ``others`` (M, 5) are their boxes."""
    frames, tick = history.frames, history.others["tick"]
    turning_radps = np.gradient(np.unwrap(frames["yaw_rad"]), history.facts.step_s) if len(frames) > 1 else np.zeros(1)
    velocity_mps = np.column_stack([frames["velocity_x_mps"], frames["velocity_y_mps"]])[tick]
    theirs_mps = np.column_stack([history.others["velocity_x_mps"], history.others["velocity_y_mps"]])
    speeds_mps = np.hypot(*velocity_mps.T) + np.hypot(*theirs_mps.T)
    away_m = np.hypot(*(others[:, :2] - own[tick, :2]).T) - np.hypot(*others[:, 3:].T) - np.hypot(*own[tick, 3:].T)
    # two actors at rest are in no danger from each other
    rows = np.flatnonzero((speeds_mps > AT_REST_MPS) & (away_m <= speeds_mps * horizon_s))
    found = np.full(len(others), np.inf)
    a, b, turn_radps = own[tick[rows]], others[rows].copy(), turning_radps[tick[rows]]
    mine, theirs = velocity_mps[rows], theirs_mps[rows]
    for leg in range(round(horizon_s / LEG_S)):
        close = np.flatnonzero(np.isinf(found[rows]) & _come_close(a, b, theirs - mine))
        touch_s = time_to_touch_s(a[close], b[close], (theirs - mine)[close])
        fresh = touch_s <= LEG_S
        found[rows[close[fresh]]] = leg * LEG_S + touch_s[fresh]
        a, b = a.copy(), b.copy()
        a[:, :2] += mine * LEG_S
        b[:, :2] += theirs * LEG_S
        a[:, 2] += turn_radps * LEG_S
        cos, sin = np.cos(turn_radps * LEG_S), np.sin(turn_radps * LEG_S)
        mine = np.column_stack([mine[:, 0] * cos - mine[:, 1] * sin, mine[:, 0] * sin + mine[:, 1] * cos])
    return found


def _come_close(a: NDArray[np.float64], b: NDArray[np.float64], approach_mps: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) whether the circles round each pair's boxes meet within a leg; the others need no closer look."""
    gap_m = b[:, :2] - a[:, :2]
    speed2 = np.maximum(np.einsum("nd,nd->n", approach_mps, approach_mps), 1e-12)
    nearest_s = np.clip(-np.einsum("nd,nd->n", gap_m, approach_mps) / speed2, 0.0, LEG_S)
    least_m = np.hypot(*(gap_m + approach_mps * nearest_s[:, None]).T)
    return np.asarray(least_m <= np.hypot(*a[:, 3:].T) + np.hypot(*b[:, 3:].T))


def post_encroachment_s(
    history: History, own: NDArray[np.float64], others: NDArray[np.float64], horizon_s: float = SEEN_S
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(M,) for each row of others the least time to the vehicle's being where they are, and the later tick.

    Times are inf, and ticks -1, beyond ``horizon_s``; boxes as for `times_to_collision_s`.
    """
    tick, step_s = history.others["tick"].astype(np.int64), history.facts.step_s
    moving = np.hypot(history.others["velocity_x_mps"], history.others["velocity_y_mps"]) > AT_REST_MPS
    radius_m = np.hypot(*others[:, 3:].T) + np.hypot(*own[0, 3:])
    reach_m = radius_m + horizon_s * float(history.speed_mps().max())
    left = np.flatnonzero(moving & (np.hypot(*(others[:, :2] - own[tick, :2]).T) <= reach_m))
    found, later = np.full(len(others), np.inf), np.full(len(others), -1, dtype=np.int64)
    for gap in range(1, round(horizon_s / step_s) + 1):
        for lag in (gap, -gap):
            rows = left[(tick[left] + lag >= 0) & (tick[left] + lag < len(own))]
            at = own[tick[rows] + lag]
            near = np.hypot(*(others[rows, :2] - at[:, :2]).T) <= radius_m[rows]
            crossing = np.abs(np.sin(others[rows, 2] - at[:, 2])) >= math.sin(CROSSING_RAD)
            rows, at = rows[near & crossing], at[near & crossing]
            if not len(rows):
                continue  # most of the time: an empty array costs each of numpy's calls as well
            rows = rows[touching(at, others[rows])]
            found[rows], later[rows] = gap * step_s, np.maximum(tick[rows], tick[rows] + lag)
            left = left[np.isinf(found[left])] if len(rows) else left
    return found, later
