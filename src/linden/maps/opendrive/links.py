"""Successors and predecessors of lanes in the direction of travel, as in LibCarla (MapBuilder.cpp, GetLaneNext)."""

from collections import defaultdict
from typing import NamedTuple

from linden.maps.opendrive.evaluate.tables import Tables, tables_of
from linden.maps.opendrive.model import Lane, OpenDrive, Road, kept

_Rows = tuple[int, ...]


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
        after = _after(tables, ways, index_of_road, row, place)
        successors.append(after)
        for next_row in after:
            predecessors[next_row].append(row)
    return LaneLinks(tuple(successors), tuple(map(tuple, predecessors)))


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
    following = range(section_index + 1, len(road.sections)) if forward else range(section_index - 1, -1, -1)
    if following:
        return _first_row(tables, road_index, following, linked)
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
    road = tables.roads[road_index]
    sections = range(len(road.sections))
    return _first_row(tables, road_index, sections if is_forward(road, lane_id or 0) else sections[::-1], lane_id)


def _first_row(tables: Tables, road_index: int, sections: range, lane_id: int | None) -> _Rows:
    if not lane_id:
        return ()
    rows = (tables.lane_row.get((road_index, section, lane_id)) for section in sections)
    found = next((row for row in rows if row is not None), None)
    return () if found is None else (found,)
