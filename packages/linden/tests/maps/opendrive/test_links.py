"""Claims about which lane leads into which, LibCarla being the second reader."""

import carla

from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.links import lane_links
from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.parse import parse
from opendrive_texts import follows, lane, line, opendrive, road, section, street_through_junction, touches


def leads_to(opendrive_map: OpenDrive) -> dict[tuple[int, int, int], set[tuple[int, int]]]:
    tables, links = tables_of(opendrive_map), lane_links(opendrive_map)
    names = [(opendrive_map.roads[row["road"]].id, int(row["section"]), int(row["lane_id"])) for row in tables.lanes]
    return {
        names[row]: {(names[after][0], names[after][2]) for after in successors}
        for row, successors in enumerate(links.successors)
    }


def test_lanes_cross_a_junction_by_their_connecting_road() -> None:
    ways = leads_to(parse(street_through_junction()))
    assert ways[1, 0, -1] == {(10, -1)}
    assert ways[10, 0, -1] == {(2, -1)}
    assert ways[2, 0, 1] == {(11, -1)}
    assert ways[11, 0, -1] == {(1, 1)}
    assert ways[2, 0, -1] == set()


def test_lanes_run_through_sections_and_into_a_road_laid_the_other_way() -> None:
    link = follows(-1, -1)
    first = road(
        1,
        40.0,
        line(0, 0, 0, 0, 40),
        section(right=lane(-1, link=link)) + section(20.0, right=lane(-1, link=follows(-1, 1))),
        link=touches("successor", "road", 2, "end"),
    )
    second = road(
        2,
        30.0,
        line(0, 70, 0, 3.141592653589793, 30),
        section(left=lane(1, link=follows(None, -1))),
        link=touches("successor", "road", 1, "end"),
    )
    ways = leads_to(parse(opendrive(first, second)))
    assert ways[1, 0, -1] == {(1, -1)}
    assert ways[1, 1, -1] == {(2, 1)}


def test_libcarla_goes_the_same_ways() -> None:
    text = street_through_junction()
    theirs = carla.Map("test", text)
    ways = leads_to(parse(text))
    for (road_id, _, lane_id), after in ways.items():
        opendrive_road = parse(text).road_by_id[road_id]
        near_end = opendrive_road.length_m - 0.02 if lane_id < 0 else 0.02
        there = theirs.get_waypoint_xodr(road_id, lane_id, near_end)
        assert {(w.road_id, w.lane_id) for w in there.next(0.05)} == after
