"""Joins a route's points along the lanes: the shortest drivable way that passes near each of them in turn.

A point near a junction or a narrow street lies on several lanes at once. All of them stay candidates, and the way
through them with the least length plus ``OFFSET_WEIGHT`` times the distances from the points wins (Viterbi's
algorithm), so that a file's points may be metres off without the route jumping into the oncoming lane.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.errors import UserError

if TYPE_CHECKING:
    from basu.routing.lane_graph import LaneGraph, LaneKey
    from basu.routing.route_file import RouteDescription, RoutePoint

OFF_ROAD_M = 5.0  # a point farther than this from every driving lane is a mistake in the file
AMBIGUOUS_M = 2.5  # lanes this much farther away than the nearest one are candidates too
MAX_CANDIDATES = 8  # the crossing of a four-lane road has no more at one place
OFFSET_WEIGHT = 5.0  # metres of way that a metre off the point is worth
HEADING_WEIGHT_M = 100.0  # metres of way that driving against the file's yaw is worth
DETOUR_FACTOR, DETOUR_M = 4.0, 250.0  # a leg longer than factor * straight line + this has no sensible way


class OnLane(NamedTuple):
    """A place on a lane; ``s_m`` runs along the road's reference line."""

    key: LaneKey
    s_m: float
    cost_m: float  # for lying off the point of the file


class Piece(NamedTuple):
    """A stretch of one lane in travel direction; ``from_s_m`` None: from its beginning, ``to_s_m`` None: to its end."""

    key: LaneKey
    from_s_m: float | None
    to_s_m: float | None


class _Step(NamedTuple):
    """The best way found to one candidate of a point."""

    total_m: float
    previous: int
    lanes: tuple[LaneKey, ...]  # entered after the previous candidate's lane, the last one is this candidate's


def join(lanes: LaneGraph, route: RouteDescription) -> list[Piece]:
    """Return the lane pieces of the way, in order.

    Raises:
        UserError: a point lies off the road, or no way leads from one point to the next.
    """
    candidates = [_candidates(lanes, route, number) for number in range(len(route.points))]
    steps: list[list[_Step]] = [[_Step(place.cost_m, -1, ()) for place in candidates[0]]]
    for number in range(1, len(candidates)):
        steps.append(_advance(lanes, candidates[number - 1], steps[-1], candidates[number], route, number))
    chosen = min(range(len(steps[-1])), key=lambda index: steps[-1][index].total_m)
    pieces: list[Piece] = []
    for number in range(len(candidates) - 1, 0, -1):
        step = steps[number][chosen]
        start, end = candidates[number - 1][step.previous], candidates[number][chosen]
        pieces[:0] = _pieces(start, step.lanes, end)
        chosen = step.previous
    return pieces


def _pieces(start: OnLane, entered: tuple[LaneKey, ...], end: OnLane) -> list[Piece]:
    """Return the stretches from one place to the next."""
    if not entered:
        return [Piece(start.key, start.s_m, end.s_m)]
    inner = [Piece(key, None, None) for key in entered[:-1]]
    return [Piece(start.key, start.s_m, None), *inner, Piece(end.key, None, end.s_m)]


def _candidates(lanes: LaneGraph, route: RouteDescription, number: int) -> list[OnLane]:
    """Return the lanes that a point of the file may lie on, the nearest first."""
    point = route.points[number]
    away_m = np.hypot(lanes.points_m[:, 0] - point.x_m, lanes.points_m[:, 1] - point.y_m)
    nearest_m = float(away_m.min()) if len(away_m) else math.inf
    if nearest_m > OFF_ROAD_M:
        raise UserError(
            f"route '{route.id}' in {route.source}: point {number + 1} ({point.x_m:.1f}, {point.y_m:.1f}) lies "
            f"{nearest_m:.1f} m from the nearest driving lane of {route.town}; move it to within {OFF_ROAD_M:.0f} m"
        )
    found: dict[int, OnLane] = {}
    for sample in np.argsort(away_m, kind="stable"):
        if away_m[sample] > min(OFF_ROAD_M, nearest_m + AMBIGUOUS_M) or len(found) >= MAX_CANDIDATES:
            break
        lane = int(lanes.key_of_sample[sample])
        if lane not in found:
            found[lane] = _place(lanes, int(sample), point, float(away_m[sample]))
    return list(found.values())


def _place(lanes: LaneGraph, sample: int, point: RoutePoint, away_m: float) -> OnLane:
    """Return the place on a sample's lane beside the point."""
    key = lanes.keys[int(lanes.key_of_sample[sample])]
    cost_m = OFFSET_WEIGHT * away_m
    if point.yaw_rad is not None:
        against = math.cos(point.yaw_rad - float(lanes.yaw_rad[sample])) < 0.0
        cost_m += HEADING_WEIGHT_M if against else 0.0
    return OnLane(key, float(lanes.s_m[sample]), cost_m)


def _advance(
    lanes: LaneGraph,
    starts: list[OnLane],
    reached: list[_Step],
    ends: list[OnLane],
    route: RouteDescription,
    number: int,
) -> list[_Step]:
    """Return the best way to each candidate of point ``number`` (from 0) over all candidates of the point before."""
    before, point = route.points[number - 1], route.points[number]
    straight_m = math.hypot(point.x_m - before.x_m, point.y_m - before.y_m)
    limit_m = DETOUR_FACTOR * straight_m + DETOUR_M
    no_lanes: tuple[LaneKey, ...] = ()
    best: list[_Step] = [_Step(math.inf, -1, ())] * len(ends)
    for index, start in enumerate(starts):
        if math.isinf(reached[index].total_m):
            continue
        lengths, paths = _reachable(lanes, start.key, limit_m)
        for place, end in enumerate(ends):
            ahead_m = _travelled_m(start.key, start.s_m, end.s_m) if start.key == end.key else -1.0
            if ahead_m >= 0.0:
                way_m, entered = ahead_m, no_lanes
            elif end.key in lengths:
                way_m, entered = lengths[end.key], tuple(paths[end.key])
            else:
                continue
            total_m = reached[index].total_m + way_m + end.cost_m
            if total_m < best[place].total_m:
                best[place] = _Step(total_m, index, entered)
    if all(math.isinf(step.total_m) for step in best):
        raise UserError(
            f"route '{route.id}' in {route.source}: no way along the lanes leads from point {number} "
            f"({before.x_m:.1f}, {before.y_m:.1f}) to point {number + 1} ({point.x_m:.1f}, {point.y_m:.1f}) within "
            f"{limit_m:.0f} m; lanes are not changed on a route, so check the side of the street and the order"
        )
    return best


def _reachable(
    lanes: LaneGraph, start: LaneKey, limit_m: float
) -> tuple[dict[LaneKey, float], dict[LaneKey, list[LaneKey]]]:
    """Lanes ahead of ``start`` within ``limit_m``: the length of the lanes between, and the lanes entered."""
    if start not in lanes.graph:
        return {}, {}
    following = set(lanes.graph.successors(start))
    if not following:
        return {}, {}
    import networkx as nx  # noqa: PLC0415 - a quarter of the imports of an agent's process, which joins no route

    found: Any = nx.multi_source_dijkstra(lanes.graph, following, cutoff=limit_m)  # its stubs join two overloads
    return found[0], found[1]


def _travelled_m(key: LaneKey, from_s_m: float, to_s_m: float) -> float:
    """Return how far ``to`` lies ahead of ``from`` in the lane's travel direction; negative where behind."""
    return to_s_m - from_s_m if key.lane < 0 else from_s_m - to_s_m
