"""Areas of traffic: polygons, and pieces of roads between cursors."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import ScenarioError
from basu_openscenario.playing.routes import steps_between
from basu_openscenario.playing.traffic import driving_lanes, lane_place

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu_openscenario.reading.traffic import RoadStretch
    from basu_openscenario.roads.network import Network
    from basu_openscenario.roads.place import Place


class RoadPiece(NamedTuple):
    """A part of a road in m along it, and the lanes that count; None: all."""

    road: str
    start_m: float
    end_m: float
    along: bool
    """Whether the stretch goes along s here."""
    lanes: frozenset[int] | None

    def has(self, place: Place) -> bool:
        """Return whether a place is on it."""
        in_lane = self.lanes is None or place.lane in self.lanes
        return place.road_number == self.road and self.start_m <= place.s_m <= self.end_m and in_lane


def inside_polygon(x_m: float, y_m: float, corners_m: Sequence[tuple[float, float]]) -> bool:
    """Return whether a point is inside a polygon, by the number of edges that a ray to the east crosses."""
    inside = False
    for (ax, ay), (bx, by) in pairwise([*corners_m, corners_m[0]]):
        if (ay > y_m) != (by > y_m) and x_m < ax + (bx - ax) * (y_m - ay) / (by - ay):
            inside = not inside
    return inside


def stretch_pieces(network: Network, stretch: RoadStretch) -> list[RoadPiece]:
    """Return the parts of roads from the first cursor of a stretch to the last one, up to its length.

    Raises:
        ScenarioError: a road does not exist, or no way leads from one cursor to the next.
    """
    for road in stretch.roads:
        if road not in network.roads:
            there = ", ".join(list(network.roads)[:8])
            raise ScenarioError(
                f"{stretch.line}: {network.path} has no road '{road}'; it has {there}, ...: correct the road's id"
            )
    found: list[RoadPiece] = []
    for nth in range(len(stretch.roads) - 1):
        found += [one for one in _between(network, stretch, nth) if one not in found]
    left_m = math.inf if stretch.length_m is None else stretch.length_m
    pieces = []
    for piece in found:
        length_m = min(piece.end_m - piece.start_m, left_m)
        left_m -= length_m
        start_m = piece.start_m if piece.along else piece.end_m - length_m
        if length_m > 0.0:
            pieces.append(piece._replace(start_m=start_m, end_m=start_m + length_m))
    return pieces


def _between(network: Network, stretch: RoadStretch, nth: int) -> list[RoadPiece]:
    """Return the parts of roads from a cursor to the next one."""
    first, last = (network.roads[one] for one in stretch.roads[nth : nth + 2])
    s_m, end_m = stretch.s_m[nth : nth + 2]
    lanes, end_lanes = stretch.lanes[nth : nth + 2]
    if first is last:
        low_m, high_m = (0.0 if s_m is None else s_m), (first.length_m if end_m is None else end_m)
        low_m, high_m = (min(max(one, 0.0), first.length_m) for one in (low_m, high_m))
        return [RoadPiece(first.number, min(low_m, high_m), max(low_m, high_m), low_m <= high_m, lanes)]
    there = lane_place(network, last.number, 0.0 if end_m is None else end_m, 0)
    for lane in driving_lanes(network, first.number, s_m or 0.0):
        try:
            along, steps, _ = steps_between(lane_place(network, first.number, s_m or 0.0, lane), there)
        except ScenarioError:
            continue
        begin_m = s_m if s_m is not None else 0.0 if along else first.length_m
        found = [RoadPiece(first.number, *((begin_m, first.length_m) if along else (0.0, begin_m)), along, lanes)]
        found += [RoadPiece(one.road, 0.0, network.roads[one.road].length_m, one.at_start, None) for one in steps[:-1]]
        stop_m = end_m if end_m is not None else last.length_m if steps[-1].at_start else 0.0
        ends = (0.0, stop_m) if steps[-1].at_start else (stop_m, last.length_m)
        return [*found, RoadPiece(last.number, *ends, steps[-1].at_start, end_lanes)]
    raise ScenarioError(
        f"{stretch.line}: no way leads from the road '{first.number}' to the road '{last.number}'; correct the cursors"
    )
