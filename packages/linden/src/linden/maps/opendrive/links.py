"""Successors and predecessors of lanes in the direction of travel, as in LibCarla (MapBuilder.cpp, GetLaneNext)."""

from bisect import bisect_left, bisect_right
from collections import defaultdict
from typing import NamedTuple

import numpy as np

from linden.background import checkpoint
from linden.maps.opendrive.evaluate.pieces import I64
from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import Lane, OpenDrive, Road, kept

_Rows = tuple[int, ...]


_LANES_AT_ONCE = 10_000  # between two looks whether the work is still wanted


class LaneLinks(NamedTuple):
    """For each row of ``Tables.lanes`` the rows it leads into and the rows that lead into it."""

    successors: tuple[_Rows, ...]
    predecessors: tuple[_Rows, ...]


def is_forward(road: Road, lane_id: int) -> bool:
    """Return whether traffic on this lane drives towards greater s."""
    return (lane_id < 0) == road.is_right_hand


@kept
def lane_links(opendrive: OpenDrive) -> LaneLinks:
    """Join the lanes of a map. A link to something that does not exist leads nowhere."""
    tables = tables_of(opendrive)
    ways = _ways_into_junctions(opendrive)
    index_of_road = {road.id: index for index, road in enumerate(opendrive.roads)}
    successors: list[_Rows] = []
    predecessors: list[list[int]] = [[] for _ in range(len(tables.lanes))]
    places = zip(*(tables.lanes[name].tolist() for name in ("road", "section", "lane_id")), strict=True)
    for row, place in enumerate(places):
        if row % _LANES_AT_ONCE == 0:
            checkpoint()
        after = _after(tables, ways, index_of_road, row, place)
        successors.append(after)
        for next_row in after:
            predecessors[next_row].append(row)
    return LaneLinks(tuple(successors), tuple(map(tuple, predecessors)))


def ends_of_roads(tables: Tables, links: LaneLinks) -> I64:
    """Return for each row the last row of its road that its traffic comes to: itself where no section follows."""
    rows = np.arange(len(tables.lanes))
    ahead = np.array([after[0] if after else row for row, after in enumerate(links.successors)], np.int64)
    road, section = tables.lanes["road"], tables.lanes["section"]
    right_hand = np.array([road.is_right_hand for road in tables.roads], np.bool_)
    step = np.where((tables.lanes["lane_id"] < 0) == right_hand[road], 1, -1)
    goes_on = (road[ahead] == road) & ((section[ahead] - section) * step > 0)
    ends = np.where(goes_on, ahead, rows)
    while (ends != (further := ends[ends])).any():
        ends = further
    return ends


_Ways = dict[tuple[int, int, int], list[tuple[int, int]]]


def _ways_into_junctions(opendrive: OpenDrive) -> _Ways:
    """Map (junction, road, lane) to the (road, lane) pairs of connecting roads that name it as where they come from."""
    ways: _Ways = defaultdict(list)
    for junction in opendrive.junctions:
        connecting_ids = dict.fromkeys(connection.connecting_road for connection in junction.connections)
        for road in (opendrive.road_by_id[road_id] for road_id in connecting_ids if road_id in opendrive.road_by_id):
            for link, lanes, link_of in (
                (road.predecessor, road.sections[0].lanes, _predecessor_of),
                (road.successor, road.sections[-1].lanes, _successor_of),
            ):
                for lane in lanes if link is not None else ():
                    linked = link_of(lane)
                    if linked and lane.id and link is not None:
                        ways[junction.id, link.id, linked].append((road.id, lane.id))
    return ways


def _predecessor_of(lane: Lane) -> int | None:
    return lane.predecessor


def _successor_of(lane: Lane) -> int | None:
    return lane.successor


def _after(tables: Tables, ways: _Ways, index_of_road: dict[int, int], row: int, place: tuple[int, int, int]) -> _Rows:
    road_index, section_index, lane_id = place
    road = tables.roads[road_index]
    lane = tables.lane_values[row]
    forward = is_forward(road, lane_id)
    linked = lane.successor if forward else lane.predecessor
    if section_index + 1 < len(road.sections) if forward else section_index > 0:
        return _first_row(tables, road_index, linked, section_index, forward=forward)
    link = road.successor if forward else road.predecessor
    if link is None:
        return ()
    if link.id in index_of_road:  # LibCarla looks at the id alone, not at elementType
        return _entrance(tables, index_of_road[link.id], linked)
    rows = (
        _entrance(tables, index_of_road[road_id], way) for road_id, way in ways.get((link.id, road.id, lane_id), ())
    )
    return tuple(dict.fromkeys(row for found in rows for row in found))


def _entrance(tables: Tables, road_index: int, lane_id: int | None) -> _Rows:
    """Return where one enters a road by a lane: at its start on forward lanes, at its end on the others."""
    forward = is_forward(tables.roads[road_index], lane_id or 0)
    return _first_row(tables, road_index, lane_id, None, forward=forward)


def _first_row(tables: Tables, road_index: int, lane_id: int | None, behind: int | None, *, forward: bool) -> _Rows:
    """Return the first lane of an id behind a section of a road, None for all sections, in the direction of travel."""
    sections = tables.sections_of_lane.get((road_index, lane_id), ()) if lane_id else ()
    if forward:
        nth = 0 if behind is None else bisect_right(sections, behind)
    else:
        nth = (len(sections) if behind is None else bisect_left(sections, behind)) - 1
    if lane_id is None or not 0 <= nth < len(sections):
        return ()
    return (tables.lane_row[road_index, sections[nth], lane_id],)
