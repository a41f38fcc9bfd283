"""Arriving at a place at the same time as a master arrives at another."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.relations import point_distance_m
from basu_openscenario.playing.running_action import ALONG, RunningAction
from basu_openscenario.playing.transition import SMALL, sign
from basu_openscenario.reading.positions import TrajectoryPosition
from basu_openscenario.roads.place import wrapped

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import SynchronizeAction
    from basu_openscenario.reading.positions import Position
    from basu_openscenario.roads.place import Place

HARDEST_MPS2 = 8.0
"""Deceleration of a stop at once: esmini's."""
ON_LINE_MPS = 0.1
"""A speed is on the straight line to the final speed when it is this close: esmini's."""
NEVER_S = 1e10


class Synchronisation(RunningAction):
    """Sets the speed so that both arrive together.

    With a final speed, two phases of equal and opposite acceleration lead to it; the second one is a straight line
    in speed over time. An entity that is too early comes to a stop, and begins the straight line later.
    """

    domains = ALONG

    def __init__(self, name: str, world: World, mover: Mover, action: SynchronizeAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.phase = "begin"
        self.rises = False
        self.last = (math.inf, math.inf)
        self.steady_m: float | None = None
        self.targets: tuple[Place, Place] | None = None

    def prepare(self) -> None:
        """Take the places that positions mean now."""
        action, place_of = self.action, self.world.place_of
        master = self.world.mover(action.master)
        self.targets = place_of(action.master_target, master), place_of(action.target, self.mover)
        self.phase, self.last = "begin", (math.inf, math.inf)
        self.steady_m = None
        final = action.final
        if final is not None and final.steady == "time":
            self.steady_m = final.steady_value * self._final_speed()
        elif final is not None and final.steady == "distance":
            self.steady_m = final.steady_value
        elif final is not None and final.steady_position is not None:
            way = self.targets[1].to(place_of(final.steady_position, self.mover))
            self.steady_m = 0.0 if way is None else abs(way.ds_m)

    def _final_speed(self) -> float:
        """Return the final speed, in m/s."""
        final = self.action.final
        assert final is not None, "it has one"
        master = self.world.mover(self.action.master).speed_mps
        value = final.target.value
        return {"absolute": value, "delta": master + value, "factor": master * value}[final.target.kind]

    def _left(self, mover: Mover, there: Place, position: Position) -> tuple[float, float]:
        """Return the way to a place in m, and 1 or -1 for a place ahead or behind."""
        if mover.follower is not None:
            curve = mover.follower.curve
            if isinstance(position, TrajectoryPosition) and position.trajectory.name == curve.name:
                gap = position.s_m - mover.follower.s_m
            else:
                gap = point_distance_m(mover, there, system="trajectory", kind="longitudinal") or 0.0
            along = curve.at(mover.follower.s_m).true_rad
            looks = 1.0 if abs(wrapped(along - mover.place.h_rad)) <= math.pi / 2.0 else -1.0
            return abs(gap), sign(gap) * looks
        way = mover.place.to(there)
        if way is not None:
            return abs(way.ds_m), sign(way.ds_m)
        ahead, left = mover.place.seen_from(there.x_m, there.y_m)
        return math.hypot(ahead, left), 1.0 if ahead >= 0.0 else -1.0

    def work(self, step_s: float) -> bool:
        """Set the speed of this step."""
        assert self.targets is not None, "it has begun"
        action, mover = self.action, self.mover
        master = self.world.mover(action.master)
        master_m, ahead = self._left(master, self.targets[0], action.master_target)
        own_m, _ = self._left(mover, self.targets[1], action.target)
        is_over = own_m < action.tolerance_m + SMALL or master_m < action.master_tolerance_m + SMALL
        is_over = is_over or own_m > self.last[0] or master_m > self.last[1]
        self.last = own_m, master_m
        own_m = max(own_m - action.tolerance_m, SMALL)
        master_m = max(master_m - action.master_tolerance_m, SMALL)
        pace = sign(master.speed_mps) * ahead * abs(_along_road(master))
        left_s = NEVER_S
        if pace > SMALL:
            left_s = master_m / pace
            is_over = is_over or left_s < step_s
        elif self.phase != "waiting":
            self.phase = "waiting"
            mover.set_speed(0.0)
        if is_over:
            if action.final is not None:
                mover.set_speed(self._final_speed())
            return True
        if action.final is not None:
            self._towards_final(own_m, left_s, step_s)
        elif pace > SMALL:
            final = 2.0 * own_m / left_s - mover.speed_mps
            mover.set_speed(mover.speed_mps + (final - mover.speed_mps) / left_s * step_s)
        else:
            mover.set_speed(mover.speed_mps)
        return False

    def _towards_final(self, own_m: float, left_s: float, step_s: float) -> None:
        """Set the speed on the way to the final speed."""
        mover, final = self.mover, self._final_speed()
        if self.steady_m is not None and self.phase != "steady":
            steady_s = self.steady_m / max(final, SMALL)
            if own_m - self.steady_m < SMALL or left_s - steady_s < SMALL:
                self.phase = "steady"
            else:
                own_m, left_s = own_m - self.steady_m, left_s - steady_s
        if self.phase == "steady":
            mover.set_speed(final)
        elif self.phase == "waiting" and left_s >= NEVER_S:
            return
        elif self.phase == "braking":
            mover.set_speed(max(mover.speed_mps - HARDEST_MPS2 * step_s, 0.0))
            self.phase = "waiting" if mover.speed_mps <= 0.0 else "braking"
        elif self.phase == "stopped" and left_s >= 2.0 * own_m / max(final, SMALL):
            mover.set_speed(0.0)
        elif self.phase in {"stopped", "line"}:
            self.phase = "line"
            mover.set_speed(max(0.0, _line_speed(max(0.0, final), left_s, own_m)))
        else:
            self._bend(own_m, left_s, step_s, final)

    def _bend(self, own_m: float, left_s: float, step_s: float, final: float) -> None:
        """Accelerate or brake in the first of the two phases."""
        mover = self.mover
        if self.phase != "bend":
            self.phase = "bend"
            self.rises = (final + mover.speed_mps) / 2.0 < own_m / left_s
        elif abs(mover.speed_mps - _line_speed(final, left_s, own_m)) < ON_LINE_MPS:
            self.phase = "line"
            mover.speed_is_set = True
            return
        speed = sign(mover.speed_mps) * abs(_along_road(mover))
        peak, rate = apex(speed, final, own_m, left_s)
        if (rate < 0.0) if self.rises else (rate > 0.0):
            self.phase, rate = "line", 0.0
        elif peak < 0.0:  # it would have to go backwards: it stops, and starts again later
            first_s = 2.0 * speed * own_m / max(speed * speed + final * final, SMALL)
            rate = -speed / first_s if abs(first_s) > SMALL else 0.0
            if first_s * speed / 2.0 > own_m / 2.0:
                rate, self.phase = -HARDEST_MPS2, "braking"
            if speed + rate * step_s < 0.0:
                mover.set_speed(0.0)
                self.phase = "stopped"
                return
        mover.set_speed(mover.speed_mps + rate * step_s)


def _along_road(mover: Mover) -> float:
    """Return the component of the velocity along the road's reference line."""
    place = mover.place
    h_rad = place.h_rad if place.road is None else place.road.line(place.s_m).h_rad
    return mover.velocity_mps[0] * math.cos(h_rad) + mover.velocity_mps[1] * math.sin(h_rad)


def _line_speed(final: float, left_s: float, left_m: float) -> float:
    """Return the speed from which a steady change leads to the final speed, just in time."""
    return 0.0 if left_s < 1e-3 or left_m < 1e-3 else 2.0 * left_m / left_s - final


def apex(speed: float, final: float, left_m: float, left_s: float) -> tuple[float, float]:
    """Return the speed at the turn of two phases of equal and opposite acceleration, and the first acceleration.

    In T = left_s, from v0 to v1, over s: (vx - v0) / x = (vx - v1) / (T - x) and the areas below both lines sum to s.
    """
    if abs(final - speed) < SMALL:
        half_s = left_s / 2.0
        peak = left_m / half_s - speed
        return peak, (peak - speed) / half_s
    root = math.sqrt(
        max(4.0 * left_m**2 - 4.0 * (final + speed) * left_s * left_m + 2.0 * (final**2 + speed**2) * left_s**2, 0.0)
    )
    for side in (-1.0, 1.0):
        turn_s = -(2.0 * left_m - 2.0 * final * left_s - side * root) / (2.0 * (final - speed))
        if 0.0 < turn_s < left_s:
            peak = (2.0 * left_m + side * root) / (2.0 * left_s)
            return peak, (peak - speed) / turn_s
    return 0.0, 0.0
