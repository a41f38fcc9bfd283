"""Following a profile of speeds over time: by straight lines, or with limited jerk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from basu_openscenario.playing.longitudinal import with_performance
from basu_openscenario.playing.running_action import ALONG, RunningAction
from basu_openscenario.playing.transition import SMALL

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import SpeedProfileAction


class Corner(NamedTuple):
    """A time in s, a speed in m/s, and the acceleration in m/s² from there on."""

    time_s: float
    speed_mps: float
    rate: float


class Stretch(NamedTuple):
    """A piece of a profile from a time on: speed, acceleration and jerk at its begin."""

    time_s: float
    speed_mps: float
    rate: float
    jerk: float

    def speed_at(self, time_s: float) -> float:
        """Return the speed at a time in this piece."""
        since = time_s - self.time_s
        return self.speed_mps + self.rate * since + 0.5 * self.jerk * since * since


class Bounds(NamedTuple):
    """Limits of accelerations in m/s² and of jerks in m/s³."""

    up: float
    down: float
    jerk_up: float
    jerk_down: float


class SpeedProfile(RunningAction):
    """Sets the speed that the profile has at each time."""

    domains = ALONG

    def __init__(self, name: str, world: World, mover: Mover, action: SpeedProfileAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.stretches: list[Stretch] = []

    def prepare(self) -> None:
        """Lay the profile from the present speed and acceleration."""
        mover, action = self.mover, self.action
        limits = with_performance(action.limits, mover)
        assert limits is not None, "an action has limits, if only those of its entity"
        bounds = Bounds(limits[1], limits[2], limits[3], limits[4])
        base = 0.0 if action.entity is None else self.world.mover(action.entity).speed_mps
        entries = [(speed + base, time_s) for speed, time_s in action.entries]
        corners = _corners(self.world.time_s, mover.speed_mps, entries, bounds, follows=action.follows)
        rate = mover.along(mover.acceleration_mps2)[0]
        self.stretches = profile(corners, rate, bounds, follows=action.follows)

    def work(self, step_s: float) -> bool:
        """Set the speed after a step."""
        time_s, last = self.world.time_s + step_s, self.stretches[-1]
        now = [one for one in self.stretches if time_s > one.time_s - SMALL]
        speed = (now[-1] if now else self.stretches[0]).speed_at(time_s)
        is_over = time_s > last.time_s - SMALL and abs(speed - last.speed_mps) < SMALL
        self.mover.set_speed(last.speed_mps if is_over else 0.0 if abs(speed) < SMALL else speed)
        return is_over


def _corners(
    time_s: float, speed_mps: float, entries: list[tuple[float, float | None]], bounds: Bounds, *, follows: bool
) -> list[Corner]:
    """Return the corners of a profile; a time that is left open, or that is too short, follows from the limits."""
    first_speed, first_time = entries[0]
    at_once = first_time is not None and abs(first_time) < SMALL
    corners = [Corner(time_s, first_speed if at_once and not follows else speed_mps, 0.0)]
    for speed, lasts in entries[1:] if at_once else entries:
        change = speed - corners[-1].speed_mps
        rate = change / lasts if lasts is not None and lasts > SMALL else math.copysign(math.inf, change)
        if abs(change) < SMALL and lasts is None:
            continue
        rate = min(max(rate, -bounds.down), bounds.up) if change else 0.0
        needs = lasts if rate == 0.0 else change / rate
        corners[-1] = corners[-1]._replace(rate=rate)
        corners.append(Corner(corners[-1].time_s + (needs or 0.0), speed, 0.0))
    return corners


def profile(corners: list[Corner], rate: float, bounds: Bounds, *, follows: bool) -> list[Stretch]:
    """Return the pieces of a profile: straight lines, or with jerk where ``follows``."""
    smooth = follows and len(corners) > 1
    if smooth and len(corners) == 2:
        return _single(corners[0], corners[1], rate, bounds)
    if smooth and (found := _rounded(corners, rate, bounds)) is not None:
        return found
    return [Stretch(one.time_s, one.speed_mps, one.rate, 0.0) for one in corners]


def _single(first: Corner, last: Corner, rate: float, bounds: Bounds) -> list[Stretch]:
    """Return the way to one speed: jerk to an acceleration, hold it, and jerk to none.

    The change of speed is k1²(1/2j1 - 1/2j0) + k1(T + k0/j0) - k0²/2j0. T is the time to go. k0 is the acceleration at
    the begin, and k1 is the one that is held. The jerks are j0 and j1.
    """
    change, total_s = last.speed_mps - first.speed_mps, last.time_s - first.time_s
    rises = first.rate > rate or (first.rate == rate and change > 0)
    j0 = bounds.jerk_up if rises else -bounds.jerk_down
    j1 = bounds.jerk_up if first.rate < 0 else -bounds.jerk_down
    if j0 * j1 > 0.0:
        j1 = -j0
    a, b, c = 0.5 / j1 - 0.5 / j0, total_s + rate / j0, -rate * rate / (2.0 * j0) - change
    inside = b * b - 4.0 * a * c
    held_s = 0.0
    if inside >= 0.0:
        roots = [(-b + math.sqrt(inside)) / (2.0 * a), (-b - math.sqrt(inside)) / (2.0 * a)]
        held = min(roots, key=abs)
        held_s = total_s - (held - rate) / j0 + held / j1
    else:  # no time to hold: as long as the jerks take
        size = (change + rate * rate / (2.0 * j0)) / (0.5 / j0 - 0.5 / j1)
        held = math.copysign(math.sqrt(max(size, 0.0)), j0)
    limit = bounds.up if held > 0 else bounds.down
    if abs(held) > limit or held_s < 0.0:
        held = math.copysign(min(abs(held), limit), held)
        rest = change - (held * held - rate * rate) / (2.0 * j0) + held * held / (2.0 * j1)
        held_s = max(rest / held, 0.0) if held else 0.0
    t1 = first.time_s + (held - rate) / j0
    v1 = first.speed_mps + (held * held - rate * rate) / (2.0 * j0)
    t2, v2 = t1 + held_s, v1 + held * held_s
    t3 = t2 - held / j1
    return [
        Stretch(first.time_s, first.speed_mps, rate, j0),
        Stretch(t1, v1, held, 0.0),
        Stretch(t2, v2, held, j1),
        Stretch(t3, last.speed_mps, 0.0, 0.0),
    ]


def _rounded(corners: list[Corner], rate: float, bounds: Bounds) -> list[Stretch] | None:
    """Return lines with corners that limited jerk rounds; None where lines are too short for that.

    A piece of constant jerk that touches two lines lies evenly about the time at which they cross.
    """
    first = corners[0]
    jerk = -bounds.jerk_down if first.rate < rate else bounds.jerk_up
    found = [Stretch(first.time_s, first.speed_mps, rate, jerk)]
    at_s = first.time_s + (first.rate - rate) / jerk
    found.append(Stretch(at_s, found[0].speed_at(at_s), first.rate, 0.0))
    for corner in corners[1:]:
        line = found[-1]
        turn = corner.rate - line.rate
        if abs(turn) < SMALL:
            continue
        jerk = bounds.jerk_up if turn > 0 else -bounds.jerk_down
        crossing = line.speed_mps - line.rate * line.time_s - corner.speed_mps + corner.rate * corner.time_s
        middle_s, lasts_s = crossing / turn, turn / jerk
        start_s = middle_s - lasts_s / 2.0
        if start_s < line.time_s:
            return None
        bend = Stretch(start_s, line.speed_at(start_s), line.rate, jerk)
        found += [bend, Stretch(start_s + lasts_s, bend.speed_at(start_s + lasts_s), corner.rate, 0.0)]
    return found
