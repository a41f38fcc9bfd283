"""Actions across the road: changes of lane and of the offset in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.running_action import ASIDE, RunningAction
from basu_openscenario.playing.transition import SMALL, Transition, away_from_zero, range_by_peak_bend, sign
from basu_openscenario.playing.world import lane_beside

if TYPE_CHECKING:
    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.actions import LaneChangeAction, LaneOffsetAction
    from basu_openscenario.roads.place import Place

ACROSS = math.pi / 2.0 - SMALL
"""The steepest angle of a change of lane: a right angle would leave open which way is forwards."""


def side_of(lane: int) -> float:
    """Return -1 for lanes to the right of the reference line, otherwise 1."""
    return -1.0 if lane < 0 else 1.0


class LaneChange(RunningAction):
    """Moves the entity along its path and over to another lane, so that its speed over ground stays what it is."""

    domains = ASIDE

    def __init__(self, name: str, world: World, mover: Mover, action: LaneChangeAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.transition = Transition(action.dynamics.shape, action.dynamics.dimension, action.dynamics.value)
        self.lane, self.offset_m = 0, 0.0
        self.angle_rad = 0.0
        """Of the path from the lane, positive away from the reference line."""

    def prepare(self) -> None:
        """Find the lane, and measure the offset from it."""
        place, dynamics = self.mover.place, self.action.dynamics
        target = self.action.target
        lane = int(target.value)
        if target.entity is not None:
            there = self.world.mover(target.entity).place
            lane = lane_beside(there.lane, lane * (1 if there.is_forward else -1))
        place.on_surface = True
        place.face_lane(0.0)
        if place.road is not None and lane not in place.road.section(place.s_m).lanes:
            lane = place.lane  # there is no such lane here: stay in this one, as esmini does
        self.lane = lane
        self.offset_m = place.t_m - place.road.lane_t_m(lane, place.s_m) if place.road is not None else 0.0
        self.transition = Transition(
            dynamics.shape,
            dynamics.dimension,
            dynamics.value,
            side_of(lane) * self.offset_m,
            side_of(lane) * self.action.offset_m,
        )
        self.angle_rad = 0.0

    def work(self, step_s: float) -> bool:
        """Move a step along the slanting path."""
        mover, change = self.mover, self.transition
        place = mover.place
        mover.moved_along = True
        if abs(mover.speed_mps) < SMALL:
            return False
        outwards, along_m = self._advance(abs(mover.speed_mps) * step_s, step_s)
        place.set_lane(place.road_number, self.lane, place.s_m, outwards * side_of(self.lane))
        if change.is_step:
            along_m = abs(mover.speed_mps) * step_s
        ds_m = place.stretched(sign(mover.speed_mps) * along_m)
        place.move(ds_m, actual=False)
        self.lane, self.offset_m = place.lane, place.offset_m
        mover.speed_is_set = True
        is_over = change.has_passed(outwards) or place.at_end_of_road
        turn = 0.0 if is_over else (1.0 if place.is_forward else -1.0) * side_of(place.lane) * self.angle_rad
        place.face_lane(turn)
        if not place.route:
            place.attach()
        return is_over

    def _advance(self, step_m: float, step_s: float) -> tuple[float, float]:
        """Advance the transition; return the offset away from the reference line, and the way along the lane, in m."""
        change, forwards = self.transition, sign(self.mover.speed_mps)
        rate = change.slope() / away_from_zero(change.stretch)
        if change.dimension == "distance":
            along_m = step_m / math.sqrt(1.0 + rate * rate)
            change.advance(along_m)
            self.angle_rad = math.atan(rate)
            return change.now(), along_m
        aside_m = step_s * abs(rate)
        along_m = math.sqrt(max(step_m * step_m - min(aside_m, step_m) ** 2, 0.0))
        if aside_m < step_m + SMALL:
            change.advance(step_s)
            self.angle_rad = math.atan2(forwards * sign(rate) * aside_m, along_m)
            return change.now(), along_m
        change.advance(
            step_m * change.range / abs(change.target - change.start)
        )  # too fast: all of the step goes aside
        self.angle_rad = forwards * sign(rate) * ACROSS
        return change.now("linear"), along_m


class LaneOffset(RunningAction):
    """Changes the offset from the lane's middle over time, while the entity goes on along its lane."""

    domains = ASIDE

    def __init__(self, name: str, world: World, mover: Mover, action: LaneOffsetAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, mover)
        self.action = action
        self.transition = Transition(action.shape, "time", 0.0)

    def prepare(self) -> None:
        """Find the offset to reach, and the time for it."""
        place, target = self.mover.place, self.action.target
        goal = side_of(place.lane) * target.value
        if target.entity is not None:
            goal = side_of(place.lane) * self._offset_beside(self.world.mover(target.entity).place, target.value)
        start = side_of(place.lane) * place.offset_m
        most = self.action.max_lateral_acceleration_mps2
        value = 0.0 if most is None else range_by_peak_bend(self.action.shape, goal - start, max(most, SMALL))
        self.transition = Transition(self.action.shape, "time", value, start, goal)

    def _offset_beside(self, there: Place, by_m: float) -> float:
        """Return the offset in the present lane of a line beside another entity."""
        place = self.mover.place
        line_m = there.t_m + by_m * (1.0 if there.is_forward else -1.0)
        return line_m - (place.t_m - place.offset_m)

    def work(self, step_s: float) -> bool:
        """Take the offset of this step; the entity moves along its lane afterwards."""
        place, change = self.mover.place, self.transition
        outwards = change.now()
        is_over = change.has_passed(outwards)
        offset_m = side_of(place.lane) * (change.target if is_over else outwards)
        place.set_lane(place.road_number, place.lane, place.s_m, offset_m)
        angle = 0.0 if is_over else math.atan(change.slope() / away_from_zero(self.mover.speed_mps))
        place.face_lane((1.0 if place.is_forward else -1.0) * side_of(place.lane) * angle)
        change.advance(step_s)
        return is_over
