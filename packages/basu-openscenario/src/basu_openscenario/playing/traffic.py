"""`Traffic`: the vehicles that actions on traffic bring into a scenario, where there is room for them."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

from basu.scenarios.actions.path_follower import HEADWAY_S, JAM_M, FollowerLimits
from basu_openscenario.playing.mover import Mover
from basu_openscenario.playing.traffic_driver import DECIDE_S, TrafficDriver, seen
from basu_openscenario.playing.transition import SMALL
from basu_openscenario.reading.traffic import MOST_VEHICLES
from basu_openscenario.roads.network import DRIVING, SAMPLE_M
from basu_openscenario.roads.place import Place

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu_openscenario.playing.traffic_actions import TrafficRunning
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.entities import Entity
    from basu_openscenario.reading.traffic import TrafficMix
    from basu_openscenario.roads.network import Network

T = TypeVar("T")
BESIDE_M = 0.5
"""Boxes that pass each other at least so far apart are no hindrance to a new vehicle."""
LEVEL_M = 3.0
"""Vehicles on levels farther apart than this do not meet."""
FARTHEST_M = 300.0
"""Vehicles farther away are not looked at when a new one appears: at 40 m/s it brakes in 200 m."""
NARROWEST_M = 2.0
"""Vehicles appear in lanes wider than this."""
TRIES = 40
"""So many places are looked at for a new vehicle, before it waits."""


@dataclass(slots=True)
class Traffic:
    """The vehicles of traffic by name, and the actions on traffic that have begun."""

    rng: random.Random = field(default_factory=lambda: random.Random(0))  # noqa: S311 - chance that can be had again
    drivers: dict[str, TrafficDriver] = field(default_factory=dict)
    running: list[TrafficRunning] = field(default_factory=list)
    brought: int = 0
    """Vehicles that have appeared since the begin."""
    _wait_s: float = 0.0

    def seed(self, value: int) -> None:
        """Begin the choices anew, before anything has appeared."""
        self.rng = random.Random(value)  # noqa: S311 - chance that can be had again

    @property
    def is_full(self) -> bool:
        """Whether there are as many vehicles as a scenario may have at a time."""
        return len(self.drivers) >= MOST_VEHICLES

    def choose_body(self, mix: TrafficMix) -> Entity:
        """Return a vehicle by the weights of a mix, with its controller; it has no name yet."""
        entity = _by_weight(mix.bodies, self.rng)
        if mix.roles:
            entity = replace(entity, role=_by_weight(mix.roles, self.rng))
        if mix.controllers:
            entity = replace(entity, controllers=(*entity.controllers, _by_weight(mix.controllers, self.rng)))
        return entity

    def bring(self, world: World, entity: Entity, place: Place, speed_mps: float, wish_mps: float | None) -> str:
        """Let a vehicle appear, and return its name.

        Args:
            world: to which it is added.
            entity: the vehicle.
            place: where it appears; it looks along its lane.
            speed_mps: its speed at the begin.
            wish_mps: the speed that it makes for; None: the posted one.
        """
        self.brought += 1
        name = f"traffic-{self.brought}"
        while name in world.movers:
            self.brought += 1
            name = f"traffic-{self.brought}"
        mover = Mover(replace(entity, name=name), place)
        mover.controllers = {one.name: one for one in entity.controllers}
        mover.set_speed(speed_mps)
        mover.velocity_mps = (speed_mps * math.cos(place.h_rad), speed_mps * math.sin(place.h_rad), 0.0)
        mover.remember()
        world.movers[name] = mover
        self.drivers[name] = TrafficDriver(mover, wish_mps, self.rng)
        return name

    def remove(self, world: World, name: str) -> None:
        """Take a vehicle of traffic out of the scenario."""
        del self.drivers[name]
        world.movers.pop(name).is_there = False

    def drive(self, world: World, step_s: float) -> None:
        """Let all vehicles of traffic choose their speed for a step; vehicles at the end of their road leave."""
        for name in [name for name, one in self.drivers.items() if one.mover.place.at_end_of_road]:
            self.remove(world, name)
        if not self.drivers:
            return
        self._wait_s -= step_s
        if self._wait_s < SMALL:
            self._wait_s += DECIDE_S
            others = seen([one for one in world.movers.values() if one.is_there])
            for driver in self.drivers.values():
                driver.decide(others)
        for driver in self.drivers.values():
            driver.drive(step_s)


def _by_weight(shares: Sequence[tuple[T, float]], rng: random.Random) -> T:
    """Return one of several by their weights."""
    return rng.choices([one for one, _ in shares], [weight for _, weight in shares])[0]


def lane_place(network: Network, road: str, s_m: float, lane: int) -> Place:
    """Return a place in the middle of a lane that looks along its traffic."""
    place = Place(network, kinds=DRIVING)
    place.set_lane(road, lane, s_m, 0.0)
    place.h_rel_rad = math.pi if place.driving_sign() < 0.0 else 0.0
    place.set_lane(road, lane, s_m, 0.0)
    return place


def driving_lanes(network: Network, road: str, s_m: float) -> list[int]:
    """Return the lanes for vehicles at a place of a road."""
    section = network.roads[road].section(s_m)
    return sorted(
        number
        for number, lane in section.lanes.items()
        if number and lane.kind in DRIVING and section.width_m(number, s_m) > NARROWEST_M
    )


def has_room(world: World, place: Place, entity: Entity, speed_mps: float) -> bool:
    """Return whether a vehicle can appear at a place without harsh braking, of itself or of a vehicle behind it."""
    box, brake_mps2 = entity.box, FollowerLimits().brake_mps2
    for other in world.movers.values():
        if not other.is_there or abs(other.place.z_m - place.z_m) > LEVEL_M:
            continue
        dx, dy = other.place.x_m - place.x_m, other.place.y_m - place.y_m
        if abs(dx) > FARTHEST_M or abs(dy) > FARTHEST_M:
            continue
        there = other.entity.box
        turn_rad = other.place.h_rad - place.h_rad
        cos, sin = math.cos(turn_rad), math.sin(turn_rad)
        ahead_m, left_m = place.seen_from(other.place.x_m, other.place.y_m)
        ahead_m += there.centre_m[0] * cos - there.centre_m[1] * sin - box.centre_m[0]
        left_m += there.centre_m[0] * sin + there.centre_m[1] * cos - box.centre_m[1]
        half_width_m = 0.5 * (there.width_m * abs(cos) + there.length_m * abs(sin) + box.width_m)
        if abs(left_m) > half_width_m + BESIDE_M:
            continue
        along_mps = other.speed_mps * cos
        first, second = (speed_mps, along_mps) if ahead_m > 0.0 else (along_mps, speed_mps)
        least_m = JAM_M + max(0.0, first) * HEADWAY_S + max(0.0, first**2 - second * abs(second)) / (2.0 * brake_mps2)
        half_length_m = 0.5 * (there.length_m * abs(cos) + there.width_m * abs(sin) + box.length_m)
        if abs(ahead_m) - half_length_m < least_m:
            return False
    return True


def sampled(world: World, near: Sequence[int], accept: Callable[[Place], bool], tries: int = TRIES) -> Place | None:
    """Return a place in a lane by chance that a function accepts; None where the tries find none.

    Args:
        world: with roads, and with the source of chance.
        near: samples of the network, from which the place is at most half their distance away.
        accept: tells whether a place will do.
        tries: how many places are looked at.
    """
    network, rng = world.network, world.traffic.rng
    for _ in range(tries if near else 0):
        road, s_m = network.sample(rng.choice(near))
        s_m = min(max(s_m + SAMPLE_M * (rng.random() - 0.5), 0.0), road.length_m)
        lanes = driving_lanes(network, road.number, s_m)
        if road.junction is not None or not lanes:
            continue
        place = lane_place(network, road.number, s_m, rng.choice(lanes))
        if accept(place):
            return place
    return None
