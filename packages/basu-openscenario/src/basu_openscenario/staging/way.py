"""The way of an entity as points for a route of BASU, which goes along lanes and changes none."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from basu.scenarios.stage import Pose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_openscenario.roads.place import Place

POINT_M = 25.0
"""Distance of the points."""
AHEAD_M = (100.0, 75.0, 50.0, 25.0)
"""The route goes on beyond the last place, so that the ego does not arrive before the storyboard is over."""
FARTHEST_M = 5000.0


def way_along(places: Sequence[Place]) -> tuple[Pose, ...]:
    """Return the points of a route that takes the roads of an entity, in the lanes that continue its first lane.

    A point inside a junction is left out, because lanes overlap there. So is a road that those lanes do not reach.

    Args:
        places: of the entity, one after the other.
    """
    start = places[0]
    if start.road is None:
        return ()
    network = start.network
    lanes = {start.road_number: (start.lane, start.s_m)}
    for path in network.paths(start.road, start.lane, start.s_m, forwards=start.is_forward, longest_m=FARTHEST_M):
        step = path.steps[-1]
        lanes.setdefault(step.road, (step.lane, 0.0 if step.at_start else network.roads[step.road].length_m))
    found: list[Place] = []
    for place in places[1:]:
        there = _in_lane(place, lanes)
        if there is not None and _gap_m(there, found[-1] if found else start) >= POINT_M:
            found.append(there)
    end = found[-1] if found else start
    for ahead_m in AHEAD_M:
        beyond = (_in_lane(places[-1], lanes) or end).copy()
        beyond.move(ahead_m)
        if beyond.road is not None and beyond.road.junction is None and _gap_m(beyond, end) >= POINT_M:
            found.append(beyond)
            break
    return tuple(Pose(one.x_m, -one.y_m, one.z_m) for one in found)


def _in_lane(place: Place, lanes: dict[str, tuple[int, float]]) -> Place | None:
    """Return the middle of the lane of a route beside a place; None where the route has none, or inside a junction."""
    if place.road is None or place.road.junction is not None or place.road_number not in lanes:
        return None
    lane, from_s_m = lanes[place.road_number]
    lane = place.network.lane_through(place.road, lane, from_s_m, place.s_m) if lane else 0
    if not lane:
        return None
    there = place.copy()
    there.set_lane(place.road_number, lane, place.s_m, 0.0)
    return there


def _gap_m(one: Place, other: Place) -> float:
    """Return the distance of two places in m."""
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m)
