"""Actions on traffic at work: sources, sinks, swarms, areas, and their end."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from basu_openscenario.playing.areas import inside_polygon, stretch_pieces
from basu_openscenario.playing.running_action import AtOnce, RunningAction
from basu_openscenario.playing.traffic import (
    TRIES,
    driving_lanes,
    has_room,
    lane_place,
    sampled,
)
from basu_openscenario.playing.traffic_driver import wished_mps
from basu_openscenario.playing.transition import SMALL
from basu_openscenario.reading import traffic as reading
from basu_openscenario.roads.place import is_forward

if TYPE_CHECKING:
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.entities import Entity
    from basu_openscenario.reading.traffic import TrafficMix
    from basu_openscenario.roads.place import Place

Finder = Callable[[Callable[["Place"], bool]], "Place | None"]
"""Returns a place that a function accepts; None where there is none."""
SOURCE_S, SWARM_S = 0.1, 0.5
"""A source, and a swarm or an area, looks so often for room for further vehicles."""
POINT_M = 5.0
"""The vehicles of a source with a smaller radius appear in the lane of its position."""
ROADSIDE_M = 30.0
"""Lanes up to so far from the reference line of their road are found around a position."""


class TrafficRunning(RunningAction):
    """The base of actions on traffic, which go on until a `TrafficStop` or the storyboard ends them."""

    every_s = SWARM_S

    def __init__(self, name: str, world: World, action: reading.TrafficAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, None)
        self.traffic_name = action.name
        self.line = action.line
        self.own: dict[str, None] = {}
        """The vehicles that it has brought and that are there, in their order."""
        self._wait_s = 0.0
        self._waiting: tuple[Entity, float | None] | None = None
        """The vehicle that appears next, and its speed in m/s; None: it is not drawn yet."""

    def prepare(self) -> None:
        """Be known to the actions that end it."""
        self._wait_s = 0.0
        if self not in self.world.traffic.running:
            self.world.traffic.running.append(self)
        self.settle()

    def settle(self) -> None:
        """Find the places that its positions mean now."""

    def work(self, step_s: float) -> bool:
        """Manage the vehicles every now and then; the action does not end by itself."""
        if step_s <= 0.0:
            return False
        self.own = {name: None for name in self.own if name in self.world.traffic.drivers}
        self.pass_time(step_s)
        self._wait_s -= step_s
        if self._wait_s < SMALL:
            self._wait_s += self.every_s
            self.manage()
        return False

    def pass_time(self, step_s: float) -> None:
        """Count what is due after a step."""

    @abstractmethod
    def manage(self) -> None:
        """Bring or remove vehicles."""

    def bring(self, mix: TrafficMix, speed: Callable[[], float | None], find: Finder) -> bool:
        """Bring a vehicle where there is room; return whether there was. A vehicle without room waits for its turn.

        Args:
            mix: which vehicles may appear.
            speed: draws the speed in m/s; None: the posted one.
            find: returns a place that a function accepts.
        """
        traffic = self.world.traffic
        if traffic.is_full:
            return False
        self._waiting = self._waiting or (traffic.choose_body(mix), speed())
        entity, given_mps = self._waiting
        place = find(partial(self._accepts, entity, given_mps))
        if place is None:
            return False
        self._waiting = None
        self.own[traffic.bring(self.world, entity, place, wished_mps(place, given_mps, entity), given_mps)] = None
        return True

    def remove_outside(self, is_inside: Callable[[Place], bool]) -> None:
        """Remove the vehicles that it has brought and that are at places which a function does not accept."""
        for name in [name for name in self.own if not is_inside(self.world.mover(name).place)]:
            self.world.traffic.remove(self.world, name)
            del self.own[name]

    def _accepts(self, entity: Entity, given_mps: float | None, place: Place) -> bool:
        """Return whether there is room for a vehicle at a place."""
        return has_room(self.world, place, entity, wished_mps(place, given_mps, entity))


class VehicleSource(TrafficRunning):
    """Brings vehicles around a position, the first one at once; one without room waits."""

    every_s = SOURCE_S

    def __init__(self, name: str, world: World, action: reading.TrafficSourceAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, action)
        self.action, self.due = action, 0.0

    def settle(self) -> None:
        """Find the position, and the roads around it."""
        place = self.world.place_of(self.action.position)
        self.middle_m = place.x_m, place.y_m
        self.due = 1.0 if self.action.rate_per_s > 0.0 else 0.0
        self.near = self.world.network.samples_within(*self.middle_m, self.action.radius_m + ROADSIDE_M)
        self.lane = None
        if self.action.radius_m < POINT_M and place.road is not None:
            lanes = driving_lanes(self.world.network, place.road_number, place.s_m)
            if lanes:
                lane = min(lanes, key=lambda one: abs(place.road.lane_t_m(one, place.s_m) - place.t_m))  # type: ignore[union-attr]
                self.lane = place.road_number, place.s_m, lane

    def pass_time(self, step_s: float) -> None:
        """Count the vehicles that are due."""
        self.due = min(self.due + self.action.rate_per_s * step_s, float(reading.MOST_VEHICLES))

    def manage(self) -> None:
        """Bring the vehicles that are due."""
        while self.due >= 1.0 - SMALL and self.bring(self.action.mix, lambda: self.action.speed_mps, self._find):
            self.due -= 1.0

    def _find(self, accept: Callable[[Place], bool]) -> Place | None:
        """Return a place within the radius of the source that a function accepts; None if there is none."""
        if self.lane is not None:
            place = lane_place(self.world.network, *self.lane)
            return place if accept(place) else None
        x_m, y_m = self.middle_m

        def within(place: Place) -> bool:
            return math.hypot(place.x_m - x_m, place.y_m - y_m) <= self.action.radius_m and accept(place)

        return sampled(self.world, self.near, within)


class VehicleSink(TrafficRunning):
    """Removes vehicles of traffic around a position, the nearest to it first."""

    def __init__(self, name: str, world: World, action: reading.TrafficSinkAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, action)
        self.action, self.due = action, 1.0
        self.every_s = 0.0

    def settle(self) -> None:
        """Find where the sink is now, x and y in m."""
        place = self.world.place_of(self.action.position)
        self.middle_m = place.x_m, place.y_m

    def pass_time(self, step_s: float) -> None:
        """Count the vehicles that may be removed: one at the most is left over from the time before."""
        rate = self.action.rate_per_s
        self.due = math.inf if rate is None else min(self.due + rate * step_s, max(1.0, rate * step_s))

    def manage(self) -> None:
        """Remove as many vehicles within the radius as are due, the nearest first."""
        world, (x_m, y_m) = self.world, self.middle_m
        found = []
        for name, driver in world.traffic.drivers.items():
            away_m = math.hypot(driver.mover.place.x_m - x_m, driver.mover.place.y_m - y_m)
            categories = self.action.categories
            if away_m <= self.action.radius_m and (categories is None or driver.mover.entity.category in categories):
                found.append((away_m, name))
        for _, name in sorted(found):
            if self.due < 1.0 - SMALL:
                return
            world.traffic.remove(world, name)
            self.due -= 1.0


class VehicleSwarm(TrafficRunning):
    """Keeps vehicles around an entity; a vehicle outside of the ellipse is removed, and another one appears."""

    def __init__(self, name: str, world: World, action: reading.TrafficSwarmAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, action)
        self.action = action

    def manage(self) -> None:
        """Remove the vehicles outside of the ellipse, and bring others."""
        world, action = self.world, self.action
        self.remove_outside(self._is_inside)
        if len(self.own) >= action.count:
            return
        x_m, y_m = self._middle()
        self.near = world.network.samples_within(x_m, y_m, max(action.semi_major_m, action.semi_minor_m) + ROADSIDE_M)
        while len(self.own) < action.count:
            weights = action.directions
            is_same = None if weights is None else world.traffic.rng.random() * sum(weights) < weights[0]
            if not self.bring(action.mix, self._speed, partial(self._find, is_same)):
                return

    def _speed(self) -> float | None:
        """Draw the speed of a vehicle in m/s; None: the posted one."""
        speeds = self.action.speeds_mps
        return None if speeds is None else self.world.traffic.rng.uniform(*speeds)

    def _middle(self) -> tuple[float, float]:
        """Return the middle of the swarm's ellipse, x and y in m."""
        there, offset_m = self.world.mover(self.action.entity).place, self.action.offset_m
        return there.x_m + offset_m * math.cos(there.h_rad), there.y_m + offset_m * math.sin(there.h_rad)

    def _is_inside(self, place: Place) -> bool:
        """Return whether a place is inside the ellipse."""
        there, action = self.world.mover(self.action.entity).place, self.action
        ahead_m, left_m = there.seen_from(place.x_m, place.y_m)
        if action.semi_major_m <= 0.0 or action.semi_minor_m <= 0.0:
            return False
        return math.hypot((ahead_m - action.offset_m) / action.semi_major_m, left_m / action.semi_minor_m) <= 1.0

    def _find(self, is_same: bool | None, accept: Callable[[Place], bool]) -> Place | None:  # noqa: FBT001 - drawn
        """Return a place inside the ellipse, outside of the inner circle, and in the direction that was drawn."""
        there = self.world.mover(self.action.entity).place

        def within(place: Place) -> bool:
            away_m = math.hypot(place.x_m - there.x_m, place.y_m - there.y_m)
            turns = is_same is not None and is_forward(place.h_rad - there.h_rad) != is_same
            return not turns and away_m >= self.action.inner_radius_m and self._is_inside(place) and accept(place)

        return sampled(self.world, self.near, within)


class AreaTraffic(TrafficRunning):
    """Brings vehicles into an area, once, or whenever some have left it."""

    def __init__(self, name: str, world: World, action: reading.TrafficAreaAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, action)
        self.action, self.is_done = action, False

    def settle(self) -> None:
        """Find the corners of the area, or its roads."""
        world, action = self.world, self.action
        self.is_done = False
        self.corners_m = [(one.x_m, one.y_m) for one in map(world.place_of, action.polygon)]
        self.pieces = [piece for one in action.stretches for piece in stretch_pieces(world.network, one)]
        if self.corners_m:
            low, high = ([pick(axis) for axis in zip(*self.corners_m, strict=True)] for pick in (min, max))
            middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
            radius_m = math.dist(low, high) / 2.0 + ROADSIDE_M
            self.near = world.network.samples_within(middle[0], middle[1], radius_m)

    def manage(self) -> None:
        """Bring the vehicles that the area lacks."""
        if self.is_done:
            return
        if self.action.is_continuous:
            self.remove_outside(self._is_inside)
        while len(self.own) < self.action.count and self.bring(self.action.mix, lambda: None, self._find):
            pass
        self.is_done = not self.action.is_continuous

    def _is_inside(self, place: Place) -> bool:
        """Return whether a place is in the area."""
        if self.corners_m:
            return inside_polygon(place.x_m, place.y_m, self.corners_m)
        return any(piece.has(place) for piece in self.pieces)

    def _find(self, accept: Callable[[Place], bool]) -> Place | None:
        """Return a place in the polygon or on the roads of the area that a function accepts; None if there is none."""
        if self.corners_m:
            return sampled(self.world, self.near, lambda place: self._is_inside(place) and accept(place))
        rng, network = self.world.traffic.rng, self.world.network
        lengths = [piece.end_m - piece.start_m for piece in self.pieces]
        for _ in range(TRIES if sum(lengths) > 0.0 else 0):
            piece = rng.choices(self.pieces, lengths)[0]
            s_m = rng.uniform(piece.start_m, piece.end_m)
            lanes = [
                one for one in driving_lanes(network, piece.road, s_m) if piece.lanes is None or one in piece.lanes
            ]
            if lanes:
                place = lane_place(network, piece.road, s_m, rng.choice(lanes))
                if accept(place):
                    return place
        return None


class TrafficStop(AtOnce):
    """Ends the actions on traffic of a name, or all of them; their vehicles drive on."""

    def __init__(self, name: str, world: World, action: reading.TrafficStopAction) -> None:
        """Take the action as its file has it."""
        super().__init__(name, world, None)
        self.traffic_name, self.line = action.name, action.line

    def prepare(self) -> None:
        """End the running actions on traffic that have the name."""
        for one in self.world.traffic.running:
            if one.is_running and self.traffic_name in {"", one.traffic_name}:
                one.end()


TRAFFIC_MAKERS: dict[type, Callable[..., RunningAction]] = {
    reading.TrafficSourceAction: VehicleSource,
    reading.TrafficSinkAction: VehicleSink,
    reading.TrafficSwarmAction: VehicleSwarm,
    reading.TrafficAreaAction: AreaTraffic,
    reading.TrafficStopAction: TrafficStop,
}
"""What does each action on traffic."""
