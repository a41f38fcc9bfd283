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
    found: list[Pose] = []
    last = (start.x_m, start.y_m)
    for place in places[1:]:
        if place.road is None or place.road.junction is not None or place.road_number not in lanes:
            continue
        lane, from_s_m = lanes[place.road_number]
        lane = network.lane_through(place.road, lane, from_s_m, place.s_m) if lane else 0
        if not lane:
            continue
        there = place.copy()
        there.set_lane(place.road_number, lane, place.s_m, 0.0)
        if math.hypot(there.x_m - last[0], there.y_m - last[1]) >= POINT_M:
            last = (there.x_m, there.y_m)
            found.append(Pose(there.x_m, -there.y_m, there.z_m))
    return tuple(found)
