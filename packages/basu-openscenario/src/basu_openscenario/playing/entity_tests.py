"""What conditions of entities measure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu_openscenario.playing.condition_tests import compared
from basu_openscenario.playing.relations import distance_m, position_distance_m, time_to_collision_s, touch
from basu_openscenario.playing.transition import SMALL
from basu_openscenario.roads.network import DRIVING
from basu_openscenario.roads.place import wrapped

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.playing.mover import Mover
    from basu_openscenario.playing.world import World
    from basu_openscenario.reading.conditions import ByEntity, Measure

FAR_M = 1e10
"""The distance where no road leads from one entity to the other."""
DOUBTFUL = None
"""An entity for which a figure is not defined does not decide about the condition."""


class EntityTest:
    """Measures a figure of entities and compares it, for any or all of them."""

    def __init__(self, test: ByEntity, world: World, members: tuple[str, ...]) -> None:
        """Take the condition, and the entities that it means."""
        self.test, self.world, self.members = test, world, members
        self.triggering: list[str] = []

    def holds(self, _: float) -> bool:
        """Return whether the condition is true of any, or of all entities."""
        self.triggering = []
        result = False
        for name in self.members:
            mover = self.world.mover(name)
            if not mover.is_there:
                continue
            found = MEASURES[self.test.measure.name](mover, self.test.measure, self.world)
            result = bool(found)
            if result:
                self.triggering.append(name)
            if found is DOUBTFUL:
                continue
            if result != self.test.of_all:  # one true is enough for any, one false for all
                break
        return result


def _since(since_s: float | None, world: World, duration_s: float, *, strictly: bool) -> bool:
    """Return whether a state has lasted for some seconds."""
    lasted_s = 0.0 if since_s is None else world.time_s - since_s
    if strictly:
        return lasted_s > duration_s
    return since_s is not None and lasted_s > duration_s - SMALL


def _end_of_road(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether it has been at the end of its road for long enough."""
    return _since(mover.end_since_s, world, measure.value, strictly=False)


def _stand_still(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether it has stood still for long enough."""
    return _since(mover.still_since_s, world, measure.value, strictly=True)


def _off_road(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether it has been beside the road for long enough."""
    return _since(mover.off_since_s, world, measure.value, strictly=True)


def _collision(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether it touches an entity, or any entity of a type."""
    if measure.entity is not None:
        other = world.mover(measure.entity)
        return other.is_there and touch(mover, other)
    others = [one for one in world.movers.values() if one is not mover and one.entity.kind == measure.kind]
    return any(one.is_there and touch(mover, one) for one in others)


def _headway(mover: Mover, measure: Measure, world: World) -> bool | None:
    """Compare the time headway; it is not defined behind the entity, or at a stand."""
    assert measure.entity is not None, "it has one"
    other = world.mover(measure.entity)
    if not other.is_there:
        return DOUBTFUL
    gap = distance_m(mover, other, system=measure.system, kind=measure.distance, freespace=measure.freespace)
    gap = FAR_M if gap is None else gap
    if gap < 0.0 or mover.speed_mps < SMALL:
        return DOUBTFUL
    return compared(abs(gap / mover.speed_mps), measure.rule, measure.value)


def _time_to_collision(mover: Mover, measure: Measure, world: World) -> bool | None:
    """Compare the time to collision; it is not defined where entities move apart."""
    if measure.entity is not None:
        other = world.mover(measure.entity)
        if not other.is_there:
            return DOUBTFUL
        gap = distance_m(mover, other, system=measure.system, kind=measure.distance, freespace=measure.freespace)
        time_s = time_to_collision_s(mover, other, gap)
    else:
        assert measure.position is not None, "it has a position"
        there = world.place_of(measure.position, mover)
        gap = position_distance_m(
            mover, there, system=measure.system, kind=measure.distance, freespace=measure.freespace
        )
        gap = FAR_M if gap is None else gap
        moves = abs(gap) >= SMALL and abs(mover.speed_mps) >= SMALL
        time_s = gap / mover.speed_mps if moves else -1.0
    return compared(time_s, measure.rule, measure.value) if time_s >= 0.0 else DOUBTFUL


def _component(mover: Mover, vector: tuple[float, float, float], direction: str | None) -> float:
    """Return a component of a vector in the entity's axes, or its length."""
    ahead, left = mover.along(vector)
    components = {"longitudinal": ahead, "lateral": left, "vertical": vector[2]}
    return math.hypot(*vector) if direction is None else components[direction]


def _acceleration(mover: Mover, measure: Measure, _: World) -> bool:
    """Compare the acceleration."""
    value = _component(mover, mover.acceleration_mps2, measure.direction)
    return compared(value, measure.rule, measure.value)


def _speed(mover: Mover, measure: Measure, _: World) -> bool:
    """Compare the speed."""
    value = mover.speed_mps if measure.direction is None else _component(mover, mover.velocity_mps, measure.direction)
    return compared(value, measure.rule, measure.value)


def _relative_speed(mover: Mover, measure: Measure, world: World) -> bool | None:
    """Compare the speed with that of another entity, in that entity's axes."""
    assert measure.entity is not None, "it has one"
    other = world.mover(measure.entity)
    if not other.is_there:
        return DOUBTFUL
    if measure.direction is None:
        value = mover.speed_mps - other.speed_mps
    else:
        own = _component(other, mover.velocity_mps, measure.direction)
        value = own - _component(other, other.velocity_mps, measure.direction)
    return compared(value, measure.rule, measure.value)


def _travelled(mover: Mover, measure: Measure, _: World) -> bool:
    """Return whether it has travelled far enough."""
    return mover.travelled_m >= measure.value


def _reach(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether it is close enough to a position, and turned as that says."""
    assert measure.position is not None, "it has a position"
    there = world.place_of(measure.position, mover)
    place = mover.place
    return math.hypot(there.x_m - place.x_m, there.y_m - place.y_m) < measure.tolerance


def _distance(mover: Mover, measure: Measure, world: World) -> bool | None:
    """Compare the distance to an entity or a position, without its sign."""
    if measure.entity is not None:
        other = world.mover(measure.entity)
        if not other.is_there:
            return DOUBTFUL
        gap = distance_m(mover, other, system=measure.system, kind=measure.distance, freespace=measure.freespace)
    else:
        assert measure.position is not None, "it has a position"
        there = world.place_of(measure.position, mover)
        gap = position_distance_m(
            mover, there, system=measure.system, kind=measure.distance, freespace=measure.freespace
        )
    return compared(FAR_M if gap is None else abs(gap), measure.rule, measure.value)


def _clearance(mover: Mover, measure: Measure, world: World) -> bool:
    """Return whether lanes beside the entity exist and are free over a stretch."""
    first, last = measure.lanes or (-1000, 1000)
    ahead_m, behind_m = measure.reach_m
    names = measure.entities or tuple(world.movers)
    for other in (world.mover(name) for name in names):
        if other is mover or not other.is_there:
            continue
        way = mover.place.to(other.place, max(ahead_m, behind_m))
        if way is None:
            continue
        gap = way.ds_m
        if measure.freespace:
            free = distance_m(mover, other, system="road", kind="longitudinal", freespace=True)
            gap = way.ds_m if free is None else free
        beside = first <= way.lanes <= last and (measure.opposite_lanes or not way.opposite_lane)
        if -behind_m <= gap <= ahead_m and beside:
            return False
    place = mover.place
    if place.road is None:
        return False
    lanes = place.road.section(place.s_m).lanes.values()
    return any(
        place.lane + first <= lane.number <= place.lane + last
        and lane.kind in DRIVING
        and (measure.opposite_lanes or (lane.number < 0) == (place.lane < 0))
        for lane in lanes
        if lane.number
    )


def _angle(mover: Mover, measure: Measure, _: World) -> bool:
    """Compare an angle of the entity: from the road, from the traffic of its lane, or in the world."""
    place = mover.place
    angle = {"heading": place.h_rad, "pitch": place.p_rad, "roll": place.r_rad}[measure.kind or "heading"]
    if measure.system in {"road", "lane"} and place.road is not None and measure.kind == "heading":
        angle -= place.road.line(place.s_m).h_rad
        if measure.system == "lane" and place.driving_sign() < 0.0:
            angle -= math.pi
    return abs(wrapped(angle - measure.value)) < measure.tolerance + SMALL


MEASURES: dict[str, Callable[[Mover, Measure, World], bool | None]] = {
    "end-of-road": _end_of_road,
    "collision": _collision,
    "off-road": _off_road,
    "headway": _headway,
    "time-to-collision": _time_to_collision,
    "acceleration": _acceleration,
    "stand-still": _stand_still,
    "speed": _speed,
    "relative-speed": _relative_speed,
    "travelled": _travelled,
    "reach": _reach,
    "distance": _distance,
    "clearance": _clearance,
    "angle": _angle,
}
"""How each figure is measured, by its name."""
