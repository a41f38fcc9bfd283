"""The check that the conflict of a scenario came about, from the record alone.

A conflict partner is an actor or object of the scenario that the ego must avoid. The conflict came about where one of
these holds after the phase "conflict" began:

- The ego touched a partner.
- The moving ego came within `INTERACTION_TTC_S` of a collision with a partner.
- The ego would have met a partner, had it driven on unimpeded. A continuation begins every `START_S` of the record. In
  it the ego accelerates along its route to the highest speed that it had shown until then, slows for bends, stops at
  stop signs and red lights, and ignores all others. The partner moves as it really moved. They meet where the ego's
  box overlaps the partner's box, widened by `BESIDE_M`: at the same time, or within `MEETING_PET_S` of each other where
  their paths cross at 30 degrees or more. A meeting at different times counts only where the ego really was elsewhere,
  by `RESPONSE_M`, when it would have met: an ego that drove just so has not responded, and its record shows what came
  of that.

An ego that never moved has no continuation, and one that crawled meets only what crossed its path within its own slow
reach. So a driver that is absent from a conflict has not exercised it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.boxes import boxes, other_boxes, own_boxes, touching
from basu.metrics.passengers.near_misses import CROSSING_RAD, STILL_MPS, times_to_collision_s
from basu.metrics.stop_signs import AT_REST_MPS, ZONE_BEFORE_M, ZONE_BEYOND_M
from basu.routing import ControlKind
from basu.scenarios.criteria.margin import present_in

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray

    from basu.records.history import History
    from basu.scenarios.criteria.criterion import Played
    from basu.scenarios.criteria.margin import Present

INTERACTION_TTC_S = 2.0  # somewhat above the 1.5 s that FHWA-HRT-08-051 calls a conflict
MEETING_PET_S = 2.0  # within this time two actors have to settle which one goes first; FHWA-HRT-08-051 screens with 5 s
BESIDE_M = 0.5  # beside a partner's box
RESPONSE_M = 1.0  # between the ego's real place and that of a continuation: less is no response
START_S, STEP_S = 0.25, 0.25  # between continuations, and within one
AHEAD_S, CROSSING_S = 6.0, 4.0  # how far ahead a meeting counts: in line, and where the paths cross
ACCELERATE_MPS2, BRAKE_MPS2, LATERAL_MPS2 = 1.0, 1.5, 2.0
"""Of BASU's own drivers, for standing and seated passengers; sources and doubts: docs/decisions/0054-verdicts.md"""
DWELL_S = 2.0  # at a stop sign: the stop, and the look to both sides
MOVING_MPS = 0.5  # below this the ego stands; an actor that comes near a standing ego has done so alone
EFFECT_MPS = 2.5  # a disturbance of the ego's own driving is felt from this speed on
MOVED_M = 0.5  # an actor that got so far from its first place moves
RED = 0  # carla.TrafficLightState.Red


class Finding(NamedTuple):
    """One of the three answers of the policy. ``holds`` is None where it could not be judged."""

    holds: bool | None
    sentence: str


def came_about(played: Played, partners: Collection[str] | None = None) -> Finding:
    """Whether the ego met the conflict.

    ``partners`` are roles and names of things; None means the scenario's actors that moved, or all where none moved.
    """
    first = played.first_tick("conflict")
    if first is None:
        return Finding(False, "the conflict never began")
    present = present_in(played)
    keys = _partner_keys(present, partners)
    if not keys:
        return effect_felt(played)
    found = _touched(present, keys) or _nearly_collided(present, keys, first) or _would_have_met(present, keys, first)
    return found or Finding(False, _apart(present, keys, first))


def effect_felt(played: Played, at_least_mps: float = EFFECT_MPS) -> Finding:
    """Whether the ego drove when the conflict began: for scenarios that disturb the ego and have no partner."""
    first = played.first_tick("conflict")
    if first is None:
        return Finding(False, "the conflict never began")
    speed_mps = float(played.history.speed_mps()[first])
    at_s = float(played.history.frames["t_s"][first])
    sentence = f"the ego had {speed_mps:.2f} m/s at {at_s:.2f} s, when the conflict began"
    return Finding(speed_mps >= at_least_mps, f"{sentence}; {at_least_mps:g} m/s are needed")


def _partner_keys(present: Present, partners: Collection[str] | None) -> list[int]:
    """Ids of the partners in the record."""
    others = present.history.others
    if partners is not None:
        return [key for key, name in present.names.items() if name in partners]
    moved = []
    for key in present.names:
        rows = others[others["id"] == key]
        if len(rows) and np.hypot(rows["x_m"] - rows["x_m"][0], rows["y_m"] - rows["y_m"][0]).max() >= MOVED_M:
            moved.append(key)
    return moved or list(present.names)


def _touched(present: Present, keys: list[int]) -> Finding | None:
    """The first contact with a partner."""
    for event in present.history.collisions:
        if event.other_id in keys:
            at_s = float(present.history.frames["t_s"][event.tick])
            return Finding(True, f"the ego touched {present.described(event.other_id)} at {at_s:.2f} s")
    return None


def _nearly_collided(present: Present, keys: list[int], first: int) -> Finding | None:
    """The least time to collision with a partner while the ego moved, where it is short."""
    history = present.history
    others = history.others
    rows = np.flatnonzero(
        np.isin(others["id"], keys) & (others["tick"] >= first) & (history.speed_mps()[others["tick"]] > MOVING_MPS)
    )
    if len(rows) == 0:
        return None
    own, theirs = own_boxes(history.facts, history.frames), other_boxes(history.facts, others)
    ttc_s = times_to_collision_s(history, own, theirs, INTERACTION_TTC_S)[rows]
    least = int(np.argmin(ttc_s))
    if ttc_s[least] > INTERACTION_TTC_S:
        return None
    row = others[rows[least]]
    at_s = float(history.frames["t_s"][row["tick"]])
    return Finding(
        True,
        f"{present.described(int(row['id']))} was {ttc_s[least]:.2f} s from a collision with the ego at {at_s:.2f} s",
    )


def _would_have_met(present: Present, keys: list[int], first: int) -> Finding | None:
    """The first continuation of the ego that meets a partner."""
    history = present.history
    step = max(1, round(START_S / history.facts.step_s))
    starts = np.arange(first, len(history.frames), step)
    driven = _Continuations(history, starts)
    if driven.boxes is None:
        return None
    for key in keys:
        met = _meeting(history, driven, key)
        if met is not None:
            start, in_s, speed_mps = met
            at_s = float(history.frames["t_s"][start])
            return Finding(
                True,
                f"driving on unimpeded from {at_s:.2f} s, the ego would have met {present.described(key)} within "
                f"{in_s:.2f} s, at {speed_mps:.2f} m/s",
            )
    return None


class _Continuations:
    """Where the ego's box would be, (S, J, 5), ``STEP_S`` apart, had it driven on unimpeded from each start."""

    def __init__(self, history: History, starts: NDArray[np.int64]) -> None:
        self.history, frames = history, history.frames
        self.speed_mps = history.speed_mps()
        self.shown_mps = np.maximum.accumulate(self.speed_mps)
        self.starts = starts[self.shown_mps[starts] > MOVING_MPS]
        route = history.facts.route
        bend = np.abs(np.gradient(np.unwrap(route.yaw_rad), route.s_m)) if len(route.s_m) > 1 else np.zeros(1)
        self.cap_mps = np.sqrt(LATERAL_MPS2 / np.maximum(bend, 1e-3))
        self.rested_s = self._rested_s()
        self.boxes: NDArray[np.float64] | None = None
        self.reached_mps: NDArray[np.float64] | None = None
        self.differs: NDArray[np.bool_] | None = None  # (S, J) whether the ego really was elsewhere on its route then
        if len(self.starts) == 0:
            return
        driven = np.array([self._drive(int(start), float(frames["route_s_m"][start])) for start in self.starts])
        self.reached_mps = driven[:, 1]
        self.boxes = self._boxes(driven[:, 0])
        self.differs = self._differs(driven[:, 0])

    def _differs(self, s_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(S, J) whether the ego really was elsewhere along its route, or the record ends before."""
        frames, per_step = self.history.frames, STEP_S / self.history.facts.step_s
        ticks = self.starts[:, None] + np.round(np.arange(s_m.shape[1]) * per_step).astype(np.int64)[None, :]
        really_m = frames["route_s_m"][np.clip(ticks, 0, len(frames) - 1)]
        differs: NDArray[np.bool_] = (np.abs(really_m - s_m) >= RESPONSE_M) | (ticks >= len(frames))
        return differs

    def _rested_s(self) -> NDArray[np.float64]:
        """(T,) how long the ego has been at rest in each frame."""
        rested = np.zeros(len(self.speed_mps))
        for tick in range(1, len(rested)):
            if self.speed_mps[tick] < AT_REST_MPS:
                rested[tick] = rested[tick - 1] + self.history.facts.step_s
        return rested

    def _drive(self, start: int, s_m: float) -> tuple[list[float], list[float]]:
        """Places along the route and speeds, one each ``STEP_S``."""
        facts, mps, aim_mps = self.history.facts, float(self.speed_mps[start]), float(self.shown_mps[start])
        lines = self._lines(start, s_m)
        places, speeds = [s_m], [mps]
        for _ in range(round(AHEAD_S / STEP_S)):
            cap_mps = min(aim_mps, float(np.interp(s_m, facts.route.s_m, self.cap_mps)))
            if lines:
                left_m = lines[0][0] - (s_m + facts.vehicle.front_m)
                if left_m <= 0.5:
                    lines[0] = (lines[0][0], lines[0][1] - STEP_S)
                    mps = cap_mps = 0.0
                    if lines[0][1] <= 0.0:
                        lines.pop(0)
                else:
                    cap_mps = min(cap_mps, math.sqrt(2.0 * BRAKE_MPS2 * left_m), left_m / STEP_S)
            mps = min(cap_mps, mps + ACCELERATE_MPS2 * STEP_S)
            s_m += mps * STEP_S
            places.append(s_m)
            speeds.append(mps)
        return places, speeds

    def _lines(self, start: int, s_m: float) -> list[tuple[float, float]]:
        """Lines ahead at which the ego has to stop, and for how long yet."""
        facts, frames = self.history.facts, self.history.frames
        found = []
        for control in facts.route.controls:
            ahead_m = control.s_m - (s_m + facts.vehicle.front_m)
            if ahead_m < -ZONE_BEYOND_M:
                continue
            if control.kind is ControlKind.STOP_SIGN:
                zone = control.s_m - (frames["route_s_m"][: start + 1] + facts.vehicle.front_m)
                within = (zone <= ZONE_BEFORE_M) & (zone >= -ZONE_BEYOND_M)
                left_s = DWELL_S - float(np.where(within, self.rested_s[: start + 1], 0.0).max())
                if left_s > 0.0:
                    found.append((control.s_m, left_s))
            elif frames["route_light"][start] == RED and not any(math.isinf(wait_s) for _, wait_s in found):
                found.append((control.s_m, math.inf))
        return found

    def _boxes(self, s_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """(S, J, 5) of places along the route."""
        facts = self.history.facts
        route, vehicle, flat = facts.route, facts.vehicle, s_m.ravel()
        x_m, y_m = (np.interp(flat, route.s_m, route.points_m[:, axis]) for axis in (0, 1))
        yaw_rad = np.interp(flat, route.s_m, np.unwrap(route.yaw_rad))
        middle_m = (vehicle.front_m - vehicle.rear_m) / 2.0
        half_m = np.broadcast_to([(vehicle.front_m + vehicle.rear_m) / 2.0, vehicle.width_m / 2.0], (len(flat), 2))
        found = boxes(x_m + middle_m * np.cos(yaw_rad), y_m + middle_m * np.sin(yaw_rad), yaw_rad, half_m)
        return found.reshape(*s_m.shape, 5)


def _meeting(history: History, driven: _Continuations, key: int) -> tuple[int, float, float] | None:
    """The first start that, continued, meets this partner: its frame, the time until then, and the ego's speed."""
    assert driven.boxes is not None
    assert driven.reached_mps is not None
    assert driven.differs is not None
    by_tick, moving = _by_tick(history, key)
    count, steps = driven.boxes.shape[:2]
    per_step = STEP_S / history.facts.step_s
    ticks = driven.starts[:, None] + np.round(np.arange(steps) * per_step).astype(np.int64)[None, :]
    reach = round(MEETING_PET_S / STEP_S)
    best: tuple[int, int] | None = None
    for lag in sorted(range(-reach, reach + 1), key=abs):
        met = _met(driven.boxes, by_tick, moving, ticks + round(lag * per_step), crossing_only=lag != 0)
        if lag != 0:
            met &= driven.differs
        if met.any():
            start, after = divmod(int(np.argmax(met.reshape(count * steps))), steps)
            if best is None or start < best[0]:
                best = (start, after)
    if best is None:
        return None
    start, after = best
    return int(driven.starts[start]), after * STEP_S, float(driven.reached_mps[start, after])


def _met(
    own: NDArray[np.float64],
    by_tick: NDArray[np.float64],
    moving: NDArray[np.bool_],
    ticks: NDArray[np.int64],
    *,
    crossing_only: bool,
) -> NDArray[np.bool_]:
    """(S, J) whether the ego's box overlaps the partner's box of the frame ``ticks``."""
    found = np.zeros(ticks.shape, dtype=np.bool_)
    known = (ticks >= 0) & (ticks < len(by_tick))
    theirs = by_tick[np.clip(ticks, 0, len(by_tick) - 1)]
    known &= ~np.isnan(theirs[..., 0])
    crossing = moving[np.clip(ticks, 0, len(by_tick) - 1)]
    crossing &= np.abs(np.sin(theirs[..., 2] - own[..., 2])) >= math.sin(CROSSING_RAD)
    soon = np.arange(ticks.shape[1])[None, :] * STEP_S <= CROSSING_S
    known &= (crossing & soon) if crossing_only else (~crossing | soon)
    apart_m = np.hypot(theirs[..., 0] - own[..., 0], theirs[..., 1] - own[..., 1])
    known &= apart_m <= np.hypot(own[..., 3], own[..., 4]) + np.hypot(theirs[..., 3], theirs[..., 4])
    found[known] = touching(own[known], theirs[known])
    return found


def _by_tick(history: History, key: int) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """(T, 5) a partner's widened box in each frame, nan where it is not recorded; (T,) whether it moved."""
    rows = history.others[history.others["id"] == key]
    found = np.full((len(history.frames), 5), np.nan)
    moving = np.zeros(len(history.frames), dtype=np.bool_)
    box = other_boxes(history.facts, rows)
    box[:, 3:] += BESIDE_M
    found[rows["tick"]] = box
    moving[rows["tick"]] = np.hypot(rows["velocity_x_mps"], rows["velocity_y_mps"]) > STILL_MPS
    return found, moving


def _apart(present: Present, keys: list[int], first: int) -> str:
    """Why the conflict did not come about: how far away the nearest partner was."""
    history = present.history
    rows = history.others[np.isin(history.others["id"], keys) & (history.others["tick"] >= first)]
    top_mps = float(history.speed_mps().max())
    if len(rows) == 0:
        return "no conflict partner was near the ego after the conflict began"
    frames = history.frames[rows["tick"]]
    away_m = np.hypot(rows["x_m"] - frames["x_m"], rows["y_m"] - frames["y_m"])
    nearest = int(np.argmin(away_m))
    at_s = float(frames["t_s"][nearest])
    drove = "the ego never moved" if top_mps <= MOVING_MPS else f"the ego, at most {top_mps:.2f} m/s fast, met no actor"
    return (
        f"{drove} and would have met none, had it driven on: the nearest conflict partner, "
        f"{present.described(int(rows['id'][nearest]))}, was {away_m[nearest]:.1f} m away at {at_s:.2f} s"
    )
