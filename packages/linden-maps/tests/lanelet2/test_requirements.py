"""Claims that hold the rules of Autoware's map validator without the program: ids, shared bounds, areas, shoulders."""

from collections import defaultdict
from itertools import combinations

import numpy as np
import pytest
from shapely import LineString, Polygon

from linden.maps.opendrive.parse import parse
from linden_maps.lanelet2.convert import ConvertedMap, convert
from linden_maps.lanelet2.model import LaneletMap, bounds_of
from linden_maps.lanelet2.shared import NEAR_M
from vector_map_town import document, lane, road

C_INT = 2**31
"""Autoware reads an intersection area's id with atoi, and that of a light's bulbs into an int."""


@pytest.fixture(scope="module")
def linden_map(linden_lanelets: ConvertedMap) -> LaneletMap:
    return linden_lanelets.lanelet_map


def in_junctions(converted: ConvertedMap) -> dict[int, list[int]]:
    """The road lanelets of each junction."""
    found = defaultdict(list)
    for lanelet, stretch in zip(converted.lanelet_of, converted.network.stretches, strict=True):
        if stretch.junction_id >= 0 and stretch.subtype == "road":
            found[stretch.junction_id].append(lanelet)
    return found


def outline(lanelet_map: LaneletMap, lanelet: int) -> Polygon:
    sides = bounds_of(lanelet_map, lanelet_map.relations[lanelet])
    return Polygon([lanelet_map.nodes[node][:2] for node in (*sides.left, *sides.right[::-1])])


def test_ids_that_tags_name_fit_an_int_and_are_there(linden_map: LaneletMap) -> None:
    areas = {int(one.tags["intersection_area"]) for _, one in linden_map.lanelets() if "intersection_area" in one.tags}
    lights = {int(way.tags["traffic_light_id"]) for way in linden_map.ways.values() if "traffic_light_id" in way.tags}
    assert len(areas) == 120
    assert len(lights) == 22
    assert max(areas | lights) < C_INT
    assert {linden_map.ways[number].tags["type"] for number in areas} == {"intersection_area"}
    assert {linden_map.ways[number].tags["type"] for number in lights} == {"traffic_light"}


def test_ways_side_by_side_through_a_junction_share_their_bound(linden_lanelets: ConvertedMap) -> None:
    lanelet_map, apart, shared = linden_lanelets.lanelet_map, [], 0
    for lanelets in in_junctions(linden_lanelets).values():
        ways: dict[frozenset[int], dict[int, set[bool]]] = defaultdict(lambda: defaultdict(set))
        for lanelet in lanelets:
            sides = bounds_of(lanelet_map, lanelet_map.relations[lanelet])
            refs = [lanelet_map.relations[lanelet].refs(role)[0] for role in ("left", "right")]
            for nodes, ref, is_left in zip(sides, refs, (True, False), strict=True):
                ways[frozenset((nodes[0], nodes[-1]))][ref].add(is_left == (nodes[0] < nodes[-1]))
        for between in ways.values():
            shared += sum(len(hands) == 2 for hands in between.values())
            for one, other in combinations(between, 2):
                lines = [LineString(lanelet_map.line(way)[:, :2]) for way in (one, other)]
                if not between[one] & between[other] and lines[0].hausdorff_distance(lines[1]) < 0.9 * NEAR_M:
                    apart.append((one, other))
    assert apart == []
    assert shared > 300


def test_areas_are_simple_and_hold_their_ways_whole(linden_lanelets: ConvertedMap) -> None:
    lanelet_map = linden_lanelets.lanelet_map
    inside = defaultdict(list)
    for number, lanelet in lanelet_map.lanelets("road"):
        if "intersection_area" in lanelet.tags:
            inside[int(lanelet.tags["intersection_area"])].append(number)
    for area, lanelets in inside.items():
        ring = Polygon(lanelet_map.line(area)[:, :2])
        assert ring.is_valid
        assert ring.exterior.is_ccw
        for lanelet in lanelets:
            way = outline(lanelet_map, lanelet)
            assert way.is_valid
            assert way.intersection(ring).area >= 0.99 * way.area


def test_areas_have_the_corners_of_lanelets_and_kerbs_alone(linden_map: LaneletMap) -> None:
    known = {node for way in linden_map.ways.values() if way.tags.get("type") == "road_border" for node in way.nodes}
    for _, lanelet in linden_map.lanelets("road"):
        for side in bounds_of(linden_map, lanelet):
            known |= {side[0], side[-1]}
    areas = [way for way in linden_map.ways.values() if way.tags.get("type") == "intersection_area"]
    assert areas
    assert all(known.issuperset(area.nodes) for area in areas)


CARRIAGEWAYS = [
    (3, lane(3)),
    (2, lane(2, 2.0, "shoulder", mark="solid")),
    (1, lane(1, 2.0, "shoulder", mark="solid")),
    (-1, lane(-1)),
]


def test_a_shoulder_across_the_axis_goes_with_the_traffic_beside_it() -> None:
    converted = convert(parse(document(road(1, 0, 40, CARRIAGEWAYS))))
    stretches = {stretch.pieces[0].lane_id: stretch for stretch in converted.network.stretches}
    assert [stretches[number].forward for number in (3, 2, 1, -1)] == [False, False, True, True]
    lanelets = {s.pieces[0].lane_id: n for s, n in zip(converted.network.stretches, converted.lanelet_of, strict=True)}
    relations = converted.lanelet_map.relations
    assert relations[lanelets[1]].refs("right") == relations[lanelets[-1]].refs("left")
    (between,) = relations[lanelets[1]].refs("left")
    assert relations[lanelets[2]].refs("left") == [between]
    assert converted.lanelet_map.ways[between].tags["type"] == "road_border"


def test_a_shoulder_beside_no_lane_is_left_out_and_counted() -> None:
    lanes = [(-1, lane(-1)), (-2, lane(-2, 2.0, "sidewalk")), (-3, lane(-3, 2.0, "parking"))]
    network = convert(parse(document(road(1, 0, 40, lanes)))).network
    assert network.left_out == {"shoulders beside no lane": 1}
    assert [stretch.subtype for stretch in network.stretches] == ["road", "walkway"]


def test_bounds_end_where_they_did(linden_lanelets: ConvertedMap) -> None:
    """A lanelet's outline keeps its corners when it shares a bound: those of the lanelets before and after it."""
    lanelet_map = linden_lanelets.lanelet_map
    sides = {n: bounds_of(lanelet_map, lanelet_map.relations[n]) for n, _ in lanelet_map.lanelets("road")}
    for number, after in enumerate(linden_lanelets.network.successors):
        for following in after:
            one, other = (sides[linden_lanelets.lanelet_of[nth]] for nth in (number, following))
            assert (one.left[-1], one.right[-1]) == (other.left[0], other.right[0])
    corners = np.array([lanelet_map.nodes[side[0]][:2] for pair in sides.values() for side in pair])
    assert np.isfinite(corners).all()
