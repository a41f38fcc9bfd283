"""The ego of a record, driven on unimpeded from each of its frames, and what it would have met.

A continuation begins every `START_S` of the record. In it the ego accelerates along its route to the highest speed that
it had shown until then. It slows for bends, stops at stop signs and red lights, and ignores all others. A partner moves
as it really moved.

They meet where the ego's box overlaps the partner's box, widened by `BESIDE_M`, at the same time. Where their paths
cross at 30 degrees or more, `MEETING_PET_S` may lie between. Such a meeting at different times counts only where the
ego really was elsewhere, by `RESPONSE_M`, when it would have met. An ego that drove just so has not responded, and its
record shows what came of that.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from basu.metrics.boxes import boxes, other_boxes, touching
from basu.metrics.passengers.near_misses import CROSSING_RAD
from basu.metrics.stop_signs import ZONE_BEFORE_M, ZONE_BEYOND_M
from basu.routing import ControlKind
from basu.thresholds import AT_REST_MPS, IN_MOTION_MPS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History

MEETING_PET_S = 2.0  # within this time two actors have to settle which one goes first; FHWA-HRT-08-051 screens with 5 s
BESIDE_M = 0.5  # beside a partner's box
RESPONSE_M = 1.0  # between the ego's real place and that of a continuation: less is no response
START_S, STEP_S = 0.25, 0.25  # between continuations, and within one
AHEAD_S, CROSSING_S = 6.0, 4.0  # how far ahead a meeting counts: in line, and where the paths cross
ACCELERATE_MPS2, BRAKE_MPS2, LATERAL_MPS2 = 1.0, 1.5, 2.0
"""Of BASU's own drivers, for standing and seated passengers; sources and doubts: docs/decisions/0054-verdicts.md"""
DWELL_S = 2.0  # at a stop sign: the stop, and the look to both sides
RED = 0  # carla.TrafficLightState.Red


class Continuations:
    """Where the ego would be, ``STEP_S`` apart, had it driven on unimpeded from each start.

    Attributes:
        starts: (S,) frames in which continuations begin.
        boxes: (S, J, 5) the ego's box.
        reached_mps: (S, J) its speed.
        differs: (S, J) whether the ego really was elsewhere then.
    """

    def __init__(self, history: History, starts: NDArray[np.int64]) -> None:
        self.history, self.starts = history, starts
        self.speed_mps = history.speed_mps()
        self.shown_mps = np.maximum.accumulate(self.speed_mps)
        route = history.facts.route
        bend = np.abs(np.gradient(np.unwrap(route.yaw_rad), route.s_m)) if len(route.s_m) > 1 else np.zeros(1)
        self.cap_mps = np.sqrt(LATERAL_MPS2 / np.maximum(bend, 1e-3))
        self.rested_s = self._rested_s()
        route_s_m = history.frames["route_s_m"]
        driven = np.array([self._drive(int(start), float(route_s_m[start])) for start in starts])
        self.reached_mps: NDArray[np.float64] = driven[:, 1]
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


def continuations(history: History, first: int) -> Continuations | None:
    """The continuations from the frame ``first`` on; None where the ego never moved."""
    starts = np.arange(first, len(history.frames), max(1, round(START_S / history.facts.step_s)))
    # an actor that comes near an ego that stands has done so alone
    starts = starts[np.maximum.accumulate(history.speed_mps())[starts] > IN_MOTION_MPS]
    return Continuations(history, starts) if len(starts) else None


def meeting(history: History, driven: Continuations, key: int) -> tuple[int, float, float] | None:
    """The first start that, continued, meets this partner: its frame, the time until then, and the ego's speed."""
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
    moving[rows["tick"]] = np.hypot(rows["velocity_x_mps"], rows["velocity_y_mps"]) > AT_REST_MPS
    return found, moving
