"""Routes: the roads of the shortest way through places, and places on that way."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu_openscenario.roads.place import Place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_openscenario.roads.network import Network, Step

LONGEST_M = 1e5


def steps_between(start: Place, end: Place) -> tuple[bool, tuple[Step, ...], float]:
    """Return the way from one place to another: whether it begins along s, the roads entered, and its length in m.

    Raises:
        ScenarioError: no road leads there.
    """
    assert start.road is not None, "a place of a route is on a road"
    if start.road is end.road:
        return end.s_m >= start.s_m, (), abs(end.s_m - start.s_m)
    found: tuple[bool, tuple[Step, ...], float] | None = None
    for forwards in (start.is_forward, not start.is_forward):
        for path in start.network.paths(start.road, start.lane, start.s_m, forwards=forwards, longest_m=LONGEST_M):
            last = path.steps[-1]
            if end.road is None or last.road != end.road.number:
                continue
            length_m = path.length_m + (end.s_m if last.at_start else end.road.length_m - end.s_m)
            if found is None or length_m < found[2]:
                found = forwards, path.steps, length_m
            break
        if found is not None:
            break
    if found is None:
        raise ScenarioError(
            f"no way leads from the road '{start.road_number}' to the road '{end.road_number}'; correct the route"
        )
    return found


def road_path(network: Network, places: Sequence[Place]) -> list[str]:
    """Return the roads of the shortest way through places, in their order.

    Raises:
        ScenarioError: no road leads from one to the next.
    """
    assert network.roads, "a route needs roads"
    roads = [places[0].road_number]
    for start, end in pairwise(places):
        roads += [step.road for step in steps_between(start, end)[1]]
    return roads


def route_place(network: Network, places: Sequence[Place], s_m: float) -> Place:
    """Return the place ``s_m`` along the way through places, looking along it.

    Raises:
        ScenarioError: no road leads from one place to the next.
    """
    left_m = s_m
    place = places[0].copy()
    for start, end in pairwise(places):
        forwards, steps, length_m = steps_between(start, end)
        if left_m > length_m and end is not places[-1]:
            left_m -= length_m
            continue
        assert start.road is not None, "a place of a route is on a road"
        spans = [(start.road, forwards, start.s_m)]
        spans += [
            (network.roads[one.road], one.at_start, 0.0 if one.at_start else network.roads[one.road].length_m)
            for one in steps
        ]
        for nth, (road, with_s, from_s) in enumerate(spans):
            room_m = road.length_m - from_s if with_s else from_s
            if left_m <= room_m or nth == len(spans) - 1:
                place.h_rel_rad = 0.0 if with_s else 3.141592653589793
                place.set_track(road.number, from_s + (left_m if with_s else -left_m), 0.0)
                return place
            left_m -= room_m
    return place
