"""Actions along the path: speeds, profiles of speeds, distances to others."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.relations import distance_m
from basu_openscenario.playing.running_action import ALONG, RunningAction
from basu_openscenario.playing.transition import SMALL, Transition, sign

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import Limits, LongitudinalDistanceAction, SpeedAction, SpeedTarget

UNLIMITED = 1e10
REACHED_M = 0.1
"""A distance is reached when it is this close."""
SPRING = 0.4
"""Stiffness of the spring that keeps a distance, in 1/m for each m/s² of the limit: esmini's."""


def limited(value: float, most: float) -> float:
    """Return a value between -most and most."""
    return min(max(value, -most), most)


def target_speed(target: SpeedTarget, world: World) -> float:
    """Return the speed that a target means now, in m/s."""
    if target.entity is None:
        return target.value
    other = world.mover(target.entity).speed_mps
    return other + target.value if target.kind == "delta" else other * target.value


class SpeedChange(RunningAction):
    """Changes the speed by a transition within the limits of the entity."""

    domains = ALONG

    def __init__(self, name: str, world: World, mover: Mover, action: SpeedAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        dynamics = action.dynamics
        self.transition = Transition(dynamics.shape, dynamics.dimension, dynamics.value)
        self.reached = False

    def prepare(self) -> None:
        """Find the range of the transition, and take its first value."""
        limits, dynamics = self.mover.entity.performance, self.action.dynamics
        start, wanted = self.mover.speed_mps, target_speed(self.action.target, self.world)
        value, dimension = dynamics.value, dynamics.dimension
        if dimension == "distance":
            value = _time_for(dynamics.value, start, wanted)
        self.transition = Transition(dynamics.shape, dimension, value, start, limited(wanted, limits.max_speed_mps))
        rises = self.transition.target > start
        self.transition.limit_slope(limits.max_acceleration_mps2 if rises else limits.max_deceleration_mps2)
        self.reached = False
        self.mover.set_speed(self.transition.now())

    def work(self, step_s: float) -> bool:
        """Set the speed after a step."""
        mover, change = self.mover, self.transition
        limits = mover.entity.performance
        if self.action.target.entity is not None:
            change.target = limited(target_speed(self.action.target, self.world), limits.max_speed_mps)
        if change.range > 0.0 and change.is_over:
            wanted = target_speed(self.action.target, self.world)
            speed = self._after(wanted, step_s)
        else:
            change.advance(step_s)
            speed = change.now()
            needed = (speed - mover.speed_mps) / step_s if step_s > SMALL else 0.0
            if needed > limits.max_acceleration_mps2 + SMALL or needed < -(limits.max_deceleration_mps2 + SMALL):
                speed = self._after(speed, step_s)
                change.advance(-(step_s - (speed - mover.speed_mps) / needed))
        if change.is_over and abs(speed - change.target) < SMALL:
            self.reached = True
            speed = limited(target_speed(self.action.target, self.world), limits.max_speed_mps)
        mover.set_speed(speed)
        return self.reached and not self.action.target.continuous

    def _after(self, wanted: float, step_s: float) -> float:
        """Return the speed after a step towards a wanted one within the limits."""
        limits, speed = self.mover.entity.performance, self.mover.speed_mps
        rate = (wanted - speed) / step_s if step_s > SMALL else 0.0
        rate = min(max(rate, -limits.max_deceleration_mps2), limits.max_acceleration_mps2)
        return limited(speed + rate * step_s, limits.max_speed_mps)


def _time_for(distance_m_: float, start: float, target: float) -> float:
    """Return the time in s in which a steady change of speed covers a distance."""
    if abs(target - start) < SMALL:
        return 0.0
    if abs(start) > SMALL and abs(target) > SMALL and sign(start) != sign(target):
        first = start * start / (start * start + target * target) * distance_m_
        return 2.0 * first / abs(start) + 2.0 * (distance_m_ - first) / abs(target)
    return 2.0 * distance_m_ / abs(start + target)


class DistanceKeeping(RunningAction):
    """Keeps a distance or a time gap to an entity along the road: rigidly, or by a damped spring within limits."""

    domains = ALONG

    def __init__(self, name: str, world: World, mover: Mover, action: LongitudinalDistanceAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.rate = 0.0
        self.ahead = 1.0

    def prepare(self) -> None:
        """Find out on which side of the other entity to be."""
        self.rate = 0.0
        kind = self.action.displacement
        if kind == "any":
            other = self.world.mover(self.action.entity)
            along = self.mover.place.seen_from(other.place.x_m, other.place.y_m)[0]
            kind = "leadingReferencedEntity" if along < 0.0 else "trailingReferencedEntity"
        self.ahead = -1.0 if kind == "leadingReferencedEntity" else 1.0

    def work(self, step_s: float) -> bool:
        """Move, or change the speed, towards the distance."""
        action, mover = self.action, self.mover
        other = self.world.mover(action.entity)
        system = "entity" if action.freespace else action.system
        gap = distance_m(mover, other, system=system, kind="longitudinal", freespace=action.freespace)
        gap = UNLIMITED if gap is None else gap
        wanted = (
            action.distance_m if action.distance_m is not None else abs(other.speed_mps) * (action.time_gap_s or 0.0)
        )
        over = gap - self.ahead * abs(wanted)
        limits = with_performance(action.limits, mover)
        is_over = not action.continuous and abs(over) < REACHED_M
        if limits is None:
            mover.place.move(over)
            mover.set_speed(other.speed_mps)
            return is_over
        tension = SPRING * (limits[1] if over < 0.0 else limits[2])
        wish = over * tension - (mover.speed_mps - other.speed_mps) * 2.0 * math.sqrt(tension)
        wish = min(max(wish, -limits[2]), limits[1])
        if wish < 0.0 and wish < self.rate:
            wish = max(self.rate - limits[4] * step_s, wish)
        elif wish > 0.0 and wish > self.rate:
            wish = min(self.rate + limits[3] * step_s, wish)
        self.rate = wish
        mover.set_speed(limited(mover.speed_mps + self.rate * step_s, limits[0]))
        return is_over


def with_performance(limits: Limits | None, mover: Mover) -> tuple[float, float, float, float, float] | None:
    """Return limits of an action within those of the entity; None without any.

    Largest speed, acceleration, deceleration, and rates of both: m/s, m/s², m/s³.
    """
    if limits is None:
        return None
    own = mover.entity.performance

    def least(given: float | None, limit: float) -> float:
        return limit if given is None else min(given, limit)

    return (
        least(limits.max_speed_mps, own.max_speed_mps),
        least(limits.max_acceleration_mps2, own.max_acceleration_mps2),
        least(limits.max_deceleration_mps2, own.max_deceleration_mps2),
        UNLIMITED if limits.max_acceleration_rate_mps3 is None else limits.max_acceleration_rate_mps3,
        UNLIMITED if limits.max_deceleration_rate_mps3 is None else limits.max_deceleration_rate_mps3,
    )
