"""Chooses the acceleration of the next step: the most that still lets every restriction ahead be met, in comfort.

The planner drives a reference of its own (speed and acceleration); the pedals make the vehicle follow it. Jerk is
bounded by construction: a step changes the acceleration by no more than the limits in force allow.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from basu.agents.builtin.driving.manner import BASIC, ComfortLimits, approach_accel_mps2, slowing_distance_m
from basu.agents.builtin.scene import Restriction, Urgency

if TYPE_CHECKING:
    from collections.abc import Iterable

COMFORT = BASIC.comfort
FIRM = ComfortLimits(2.0, 2.5)
HARD = ComfortLimits(3.5, 8.0)
FULL_MPS2 = 7.5  # emergency braking, about what tyres give on dry asphalt (0.8 g)
FULL_JERK_MPS3 = 60.0  # brakes build up within a tenth of a second or two
HARD_BUT_SMOOTH = ComfortLimits(HARD.accel_mps2, FIRM.jerk_mps3)  # ISO 15622:2018, 6.3: 3.5 m/s² and 2.5 m/s³
RESERVE = ComfortLimits(5.0, FULL_JERK_MPS3)  # counted on where another part looks after comfort
ESCALATE_M = 0.3  # missing a mark by less than this in comfort is better than firm braking
ARRIVED_M = 0.8  # standing this near before a mark, one stays rather than creep up to it
STANDING_MPS = 0.005  # the plan has come to rest at its line: far below what `basu.thresholds` calls a standstill
OVERSPEED_MPS = 0.15  # this much above the limit nothing is done about it
STRAY_MPS = 0.6  # the reference is never farther than this from the vehicle's own speed


class Planner:
    """The reference speed and acceleration, advanced once a step."""

    def __init__(self, dt_s: float, comfort: ComfortLimits = COMFORT) -> None:
        self.dt_s = dt_s
        self.comfort = comfort
        self._ladder = (comfort, FIRM, HARD)  # how far up is gone: a restriction's urgency
        self.speed_mps = 0.0
        self.accel_mps2 = 0.0
        self.holding = True  # standing, and staying so
        self.reason = ""  # what the acceleration is owed to

    def step(
        self,
        measured_mps: float,
        limit_mps: float,
        restrictions: Iterable[Restriction],
        follow_mps2: float = math.inf,
    ) -> float:
        """Advance the reference by one step and return its acceleration in m/s².

        Args:
            measured_mps: the vehicle's speed, from which the reference must not stray.
            limit_mps: the greatest speed here.
            restrictions: what has to be slowed down for ahead.
            follow_mps2: the most acceleration that keeps the distance to a leader; reached with firm jerk.
        """
        self.speed_mps = max(0.0, min(max(self.speed_mps, measured_mps - STRAY_MPS), measured_mps + STRAY_MPS))
        restrictions = tuple(restrictions)
        if self.speed_mps < STANDING_MPS and any(_is_arrival(r) for r in restrictions):
            self._stand(next(r.reason for r in restrictions if _is_arrival(r)))
            return 0.0
        self.holding = False
        wanted_mps2 = self._towards_limit(limit_mps)
        if follow_mps2 < wanted_mps2:
            wanted_mps2, self.reason = max(follow_mps2, self._range(HARD_BUT_SMOOTH)[0]), "leader"
        for restriction in restrictions:
            allowed_mps2 = self._allowed(restriction, wanted_mps2)
            if allowed_mps2 < wanted_mps2:
                wanted_mps2, self.reason = allowed_mps2, restriction.reason
        wanted_mps2 = self._softened(wanted_mps2, restrictions)
        self.accel_mps2 = wanted_mps2
        self.speed_mps += wanted_mps2 * self.dt_s
        if self.speed_mps <= 0.0:
            self.speed_mps = self.accel_mps2 = 0.0
        return self.accel_mps2

    def _stand(self, reason: str) -> None:
        """Plan to stay at rest, and remember the reason."""
        self.speed_mps = self.accel_mps2 = 0.0
        self.holding, self.reason = True, reason

    def _range(self, limits: ComfortLimits) -> tuple[float, float]:
        """The accelerations that one step may lead to."""
        change = limits.jerk_mps3 * self.dt_s
        low = min(self.accel_mps2, max(self.accel_mps2 - change, -limits.accel_mps2))
        release = HARD.jerk_mps3 * self.dt_s if self.accel_mps2 < -self.comfort.accel_mps2 else change
        return low, min(self.accel_mps2 + release, self.comfort.accel_mps2)

    def _towards_limit(self, limit_mps: float) -> float:
        """The acceleration with nothing ahead: up to the limit, or gently down to it."""
        low, high = self._range(self.comfort)
        excess_mps = limit_mps - (self.speed_mps + self.accel_mps2 * self.dt_s)
        if excess_mps < 0.0:
            excess_mps = min(0.0, excess_mps + OVERSPEED_MPS)
        self.reason = "speed limit"
        return min(max(approach_accel_mps2(excess_mps, self.comfort), low), high)

    def _allowed(self, restriction: Restriction, wanted_mps2: float) -> float:
        """The most acceleration up to ``wanted_mps2`` with which the restriction can still be met."""
        if restriction.urgency is Urgency.RESERVE:
            return self._with_reserve(restriction, wanted_mps2)
        if self._missed_by_m(restriction, wanted_mps2, self.comfort) <= 0.0:
            return wanted_mps2
        low = min(self._range(self.comfort)[0], wanted_mps2)
        missed_m = self._missed_by_m(restriction, low, self.comfort)
        if missed_m <= 0.0:
            return self._largest(restriction, low, wanted_mps2)
        if missed_m <= ESCALATE_M:
            return low
        for milder, rougher in pairwise(self._ladder[: restriction.urgency + 1]):
            low = min(self._range(rougher)[0], wanted_mps2)
            if self._missed_by_m(restriction, low, rougher) <= ESCALATE_M:
                return self._mildest(restriction, milder, rougher)
        return self._emergency(restriction, low) if restriction.urgency is Urgency.VITAL else low

    def _missed_by_m(self, restriction: Restriction, accel_mps2: float, limits: ComfortLimits) -> float:
        """By how far the restriction is missed when this step takes ``accel_mps2`` and all later ones brake."""
        speed_mps = self.speed_mps + accel_mps2 * self.dt_s
        if speed_mps <= restriction.speed_mps and accel_mps2 <= 0.0:
            return -math.inf
        needed_m = slowing_distance_m(speed_mps, accel_mps2, restriction.speed_mps, limits)
        return needed_m + speed_mps * self.dt_s - restriction.distance_m if needed_m > 0.0 else -math.inf

    def _with_reserve(self, restriction: Restriction, wanted_mps2: float) -> float:
        """The most acceleration after which ``RESERVE`` still meets the restriction; full braking after that."""
        if self._missed_by_m(restriction, wanted_mps2, RESERVE) <= 0.0:
            return wanted_mps2
        low = min(max(self.accel_mps2 - FULL_JERK_MPS3 * self.dt_s, -RESERVE.accel_mps2), wanted_mps2)
        if self._missed_by_m(restriction, low, RESERVE) <= 0.0:
            return self._largest(restriction, low, wanted_mps2, RESERVE)
        return min(self._emergency(restriction, low), low)

    def _largest(self, restriction: Restriction, low: float, high: float, limits: ComfortLimits | None = None) -> float:
        """Bisect between an acceleration that still allows for ``limits`` (comfort) and one that does not."""
        limits = limits or self.comfort
        for _ in range(7):
            middle = 0.5 * (low + high)
            if self._missed_by_m(restriction, middle, limits) <= 0.0:
                low = middle
            else:
                high = middle
        return low

    def _mildest(self, restriction: Restriction, milder: ComfortLimits, rougher: ComfortLimits) -> float:
        """Brake at once and evenly, no harder than it takes: bisect for the deceleration between two rungs."""
        low, high = milder.accel_mps2, rougher.accel_mps2
        for _ in range(7):
            middle = ComfortLimits(0.5 * (low + high), rougher.jerk_mps3)
            if self._missed_by_m(restriction, self._range(middle)[0], middle) <= 0.0:
                high = middle.accel_mps2
            else:
                low = middle.accel_mps2
        return self._range(ComfortLimits(high, rougher.jerk_mps3))[0]

    def _emergency(self, restriction: Restriction, hard_mps2: float) -> float:
        """Brake as hard as the way that is really left demands, beyond all comfort."""
        left_m = max(restriction.distance_m + restriction.last_resort_m - self.speed_mps * self.dt_s, 0.05)
        excess = max(0.0, self.speed_mps**2 - restriction.speed_mps**2)
        demand_mps2 = 1.15 * excess / (2.0 * left_m)
        if demand_mps2 <= self.comfort.accel_mps2:
            return min(self._range(self.comfort)[0], 0.0)
        if demand_mps2 <= HARD.accel_mps2:
            return max(hard_mps2, -demand_mps2)
        return max(self.accel_mps2 - FULL_JERK_MPS3 * self.dt_s, -min(demand_mps2, FULL_MPS2))

    def _softened(self, wanted_mps2: float, restrictions: tuple[Restriction, ...]) -> float:
        """The last moment before standing: let speed and deceleration vanish together, so that no passenger nods."""
        accel, speed_mps = self.accel_mps2, self.speed_mps
        if not -HARD.accel_mps2 < accel < 0.0 or speed_mps > 1.1 * accel * accel / (2.0 * self.comfort.jerk_mps3):
            return wanted_mps2
        marks = [r for r in restrictions if r.speed_mps == 0.0 and r.distance_m < ARRIVED_M]
        if not marks or any(r.distance_m + max(r.last_resort_m, ESCALATE_M) < speed_mps * 0.5 for r in marks):
            return wanted_mps2
        # v and a reach zero together under jerk a² / 2v; the step is taken with the mean acceleration over it
        jerk = min(accel * accel / (2.0 * max(speed_mps, 1e-3)), HARD.jerk_mps3)
        return min(max(wanted_mps2, accel + jerk * self.dt_s), -0.02)


def _is_arrival(restriction: Restriction) -> bool:
    """Whether the restriction is a mark to stop at that has been reached."""
    return restriction.speed_mps == 0.0 and restriction.distance_m < ARRIVED_M
