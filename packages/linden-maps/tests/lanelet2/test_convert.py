from collections import Counter

import numpy as np
import pytest

from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.lanelet2.areas import inside
from linden_maps.lanelet2.bounds import TOLERANCE_M
from linden_maps.lanelet2.checking import compare, reach, worst_error_m
from linden_maps.lanelet2.convert import convert
from linden_maps.lanelet2.model import bounds_of
from linden_maps.lanelet2.osm import osm_bytes
from linden_maps.lanelet2.second_reader import routes_of
from linden_maps.lanelet2.shared import NEAR_M
from linden_maps.lanelet2.stretches import intersections
from opendrive_texts import SIGNS_AND_LIGHTS
from vector_map_town import document, lane, road, two_roads


@pytest.fixture(scope="module")
def small():
    return convert(parse(two_roads()))


def _road_lanelets(converted):
    return {
        (converted.network.stretches[nth].road, converted.network.stretches[nth].pieces[0].lane_id): number
        for nth, number in enumerate(converted.lanelet_of)
        if converted.network.stretches[nth].subtype == "road"
    }


def test_neighbours_share_one_way_also_across_opposite_directions(small):
    lanelets = _road_lanelets(small)
    relation = {place: small.lanelet_map.relations[number] for place, number in lanelets.items()}
    west, inner, outer = relation[0, 1], relation[0, -1], relation[0, -2]
    assert west.refs("left") == inner.refs("left")
    assert inner.refs("right") == outer.refs("left")
    assert west.refs("right") != outer.refs("right")


def test_lanelets_that_follow_share_their_end_nodes(small):
    lanelets = _road_lanelets(small)
    first, second = (bounds_of(small.lanelet_map, small.lanelet_map.relations[lanelets[n, -1]]) for n in (0, 1))
    assert (first.left[-1], first.right[-1]) == (second.left[0], second.right[0])
    back = bounds_of(small.lanelet_map, small.lanelet_map.relations[lanelets[1, 1]])
    on = bounds_of(small.lanelet_map, small.lanelet_map.relations[lanelets[0, 1]])
    assert (back.left[-1], back.right[-1]) == (on.left[0], on.right[0])


def test_tags_are_those_autoware_asks_for(small):
    tags = small.lanelet_map.relations[_road_lanelets(small)[0, -1]].tags
    assert tags["type"] == "lanelet"
    assert (tags["subtype"], tags["location"], tags["one_way"]) == ("road", "urban", "yes")
    assert tags["participant:vehicle"] == "yes"
    assert tags["speed_limit"] == "40.23"  # 25 mph in km/h


def test_bounds_have_the_types_of_their_markings(small):
    lanelets = _road_lanelets(small)
    ways, relations = small.lanelet_map.ways, small.lanelet_map.relations

    def tags(lane_id, role):
        return ways[relations[lanelets[0, lane_id]].refs(role)[0]].tags

    assert (tags(-1, "left")["type"], tags(-1, "left")["subtype"]) == ("line_thin", "solid_solid")
    assert (tags(-1, "right")["subtype"], tags(-1, "right")["lane_change"]) == ("dashed", "yes")
    assert (tags(-2, "right")["type"], tags(-2, "right")["subtype"]) == ("road_border", "curbstone")
    assert tags(-1, "left")["lane_change"] == "no"


def test_shoulders_and_pavements_lead_no_traffic(small):
    routes = routes_of(small.lanelet_map)
    assert routes.passable == set(_road_lanelets(small).values())
    assert {number for number, _ in small.lanelet_map.lanelets("walkway")}.isdisjoint(routes.passable)


def test_heights_follow_the_road(small):
    nodes = small.lanelet_map.nodes
    line = [
        nodes[n] for n in bounds_of(small.lanelet_map, small.lanelet_map.relations[_road_lanelets(small)[0, -1]]).left
    ]
    assert [round(node.z_m, 3) for node in (line[0], line[-1])] == [100.0, 100.8]


def test_a_straight_bound_has_two_points(small):
    bounds = bounds_of(small.lanelet_map, small.lanelet_map.relations[_road_lanelets(small)[0, -2]])
    assert [len(side) for side in bounds] == [2, 2]


def test_a_marking_that_changes_cuts_the_lanelet():
    mark = '<roadMark sOffset="25" type="solid" weight="standard" color="white" width="0.12"/>'
    text = document(road(1, 0, 40, [(-1, lane(-1, extra=mark)), (-2, lane(-2, mark="none"))]))
    converted = convert(parse(text))
    assert [s.pieces[0].end_m for s in converted.network.stretches if s.pieces[0].lane_id == -1] == [25.0, 40.0]
    routes = routes_of(converted.lanelet_map)
    assert len(routes.following) == 2
    assert len(routes.lane_changes) == 2  # both ways, in the broken part only


def test_what_makes_no_lanelet_is_counted():
    lanes = [(-1, lane(-1)), (-2, lane(-2, 0.1, "shoulder"))]
    converted = convert(parse(document(road(1, 0, 40, lanes))))
    assert converted.network.left_out == {"road_shoulder lanes narrower than 0.3 m": 1}


def test_a_map_of_zero_width_lanes_is_refused():
    with pytest.raises(UserError, match="no driving lane at least"):
        convert(parse(document(road(1, 0, 40, [(-1, lane(-1, 0.0))]))))


def test_a_junction_without_connections_makes_no_area():
    text = document(road(1, 0, 40, [(-1, lane(-1))]), junctions='<junction id="5" name="empty"/>')
    converted = convert(parse(text))
    assert not [way for way in converted.lanelet_map.ways.values() if way.tags.get("type") == "intersection_area"]


def test_lanes_too_far_apart_are_not_joined_and_counted():
    link = '<successor elementType="road" elementId="2" contactPoint="start"/>'
    text = document(
        road(1, 0, 40, [(-1, lane(-1, links='<successor id="-1"/>'))], link=link),
        road(2, 42, 40, [(-1, lane(-1))]),
    )
    converted = convert(parse(text))
    assert converted.lost_links == 1
    assert routes_of(converted.lanelet_map).following == set()
    assert reach(parse(text), routes_of(converted.lanelet_map), converted).missing == (
        "road 1 lane -1 to road 2 lane -1",
    )


@pytest.mark.parametrize("text", [two_roads(), SIGNS_AND_LIGHTS], ids=["two roads", "signs and lights"])
def test_the_same_map_gives_the_same_bytes(text):
    first, again = (osm_bytes(convert(parse(text + end)).lanelet_map) for end in ("", "\n"))
    assert first == again


def test_ids_survive_a_change_elsewhere(small):
    changed = convert(parse(two_roads().replace('length="30.0"', 'length="25.0"')))
    assert _road_lanelets(changed)[0, -1] == _road_lanelets(small)[0, -1]


def _halfway(line):
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return [np.interp(length[-1] / 2.0, length, line[:, axis]) for axis in range(2)]


def test_what_begins_at_a_lanes_end_moves_neither_the_lane_nor_its_measure():
    jump = '<lanes><laneOffset s="0" a="0" b="0" c="0" d="0"/><laneOffset s="40" a="9" b="0" c="0" d="0"/>'
    opendrive = parse(document(road(1, 0, 40, [(-1, lane(-1))])).replace("<lanes>", jump))
    converted = convert(opendrive)
    driving = compare(converted.lanelet_map, opendrive)[0]
    assert driving.after == driving.before == pytest.approx(0.04)
    assert max(node.y_m for node in converted.lanelet_map.nodes.values()) < 0.1


class TestLinden:
    """The shipped town, as a whole."""

    def test_second_reader_finds_the_same_lanes_and_no_other(self, linden, linden_lanelets, linden_routes):
        found = reach(linden, linden_routes, linden_lanelets)
        assert linden_routes.errors == ()
        assert (found.missing, found.added) == ((), ())
        assert found.both == 2150  # as many pairs as the topology of linden map info

    def test_nothing_is_lost(self, linden, linden_lanelets):
        rows = compare(linden_lanelets.lanelet_map, linden)
        assert [row.name for row in rows if row.is_lost] == []
        assert {row.name: row.after for row in rows if not row.unit} == {
            "traffic lights": 22,
            "stop signs": 157,
            "yield signs": 8,
            "crosswalks": 40,
            "intersections": 120,
        }

    def test_bounds_keep_the_stated_error(self, linden, linden_lanelets):
        worst = worst_error_m(linden, linden_lanelets)
        assert worst.plan_m < 0.02
        assert worst.height_m < 0.02
        assert worst.shared_m < NEAR_M / 2 + TOLERANCE_M  # the mean of a left turn and the right turn back
        assert linden_lanelets.largest_gap_m < 0.001

    def test_every_road_lanelet_in_an_intersection_has_a_turn_and_an_area(self, linden_lanelets):
        found = linden_lanelets
        met = intersections(found.network)
        assert len(met) == 120  # of 131 junctions; in the others a street ends and turns back
        for number, stretch in zip(found.lanelet_of, found.network.stretches, strict=True):
            if stretch.subtype == "road" and stretch.junction_id in met:
                tags = found.lanelet_map.relations[number].tags
                assert tags["turn_direction"] in {"left", "right", "straight"}
                assert found.lanelet_map.ways[int(tags["intersection_area"])].tags["area"] == "yes"

    def test_areas_hold_the_middles_of_their_ways(self, linden_lanelets):
        lanelet_map = linden_lanelets.lanelet_map
        outside = 0
        for _, relation in lanelet_map.lanelets("road"):
            if "intersection_area" in relation.tags:
                ring = lanelet_map.line(int(relation.tags["intersection_area"]))[:, :2]
                sides = [
                    np.array([lanelet_map.nodes[n][:2] for n in side]) for side in bounds_of(lanelet_map, relation)
                ]
                middle = np.mean([_halfway(side) for side in sides], axis=0)
                outside += not inside(ring, middle[None])[0]
        assert outside == 0

    def test_each_element_is_complete_and_referred_to(self, linden_lanelets):
        lanelet_map = linden_lanelets.lanelet_map
        referred = Counter(ref for _, lanelet in lanelet_map.lanelets() for ref in lanelet.refs("regulatory_element"))
        for number, element in lanelet_map.elements():
            assert referred[number] > 0
            for member in element.members:
                assert member.ref in (lanelet_map.ways if member.kind == "way" else lanelet_map.relations)
        for _, element in lanelet_map.elements("traffic_light"):
            assert len(element.refs("refers")) == len(element.refs("light_bulbs"))
            assert len(element.refs("ref_line")) == 1
        for _, element in lanelet_map.elements("right_of_way"):
            assert len(element.refs("right_of_way")) == 1
            assert element.refs("right_of_way")[0] not in element.refs("yield")

    def test_lights_are_seen_from_left_to_right_by_their_traffic(self, linden_lanelets):
        lanelet_map = linden_lanelets.lanelet_map
        checked = 0
        for _, lanelet in lanelet_map.lanelets("road"):
            for ref in lanelet.refs("regulatory_element"):
                element = lanelet_map.relations[ref]
                if element.tags["subtype"] != "traffic_light":
                    continue
                left, right = (lanelet_map.nodes[side[0]][:2] for side in bounds_of(lanelet_map, lanelet))
                light = lanelet_map.line(element.refs("refers")[0])
                across = np.subtract(right, left)
                assert (light[1, :2] - light[0, :2]) @ across > 0.9 * np.linalg.norm(across) * 0.36
                assert float(lanelet_map.ways[element.refs("refers")[0]].tags["height"]) > 0.0
                checked += 1
        assert checked > 22

    def test_two_way_stops_let_the_through_street_go_first(self, linden, linden_lanelets, linden_everything):
        stretch = dict(zip(linden_lanelets.lanelet_of, linden_lanelets.network.stretches, strict=True))
        found = {}
        assert linden_everything.lanelet_of == linden_lanelets.lanelet_of
        for _, element in linden_everything.lanelet_map.elements("right_of_way"):
            first = stretch[element.refs("right_of_way")[0]]
            found[linden.roads[first.road].id] = {linden.roads[stretch[n].road].id for n in element.refs("yield")}
        pairs = [pair for junction in linden.junctions for pair in junction.priorities]
        stated = [(high, low) for high, low in pairs if low in found.get(high, ())]
        against = [(high, low) for high, low in pairs if high in found.get(low, ())]
        assert len(stated) > 0.9 * len(pairs)
        assert against == []

    def test_two_conversions_have_the_same_nodes_ways_and_relations(self, linden_lanelets, linden_everything):
        """The second has more relations, by choice, and its ways and relations refer to them."""
        first, second = linden_lanelets.lanelet_map, linden_everything.lanelet_map
        for one, other in ((first.nodes, second.nodes), (first.ways, second.ways)):
            assert list(one.items()) == [item for item in other.items() if item[0] in one]
        for number, relation in first.relations.items():
            again = second.relations[number]
            assert relation.tags == again.tags
            if relation.tags["type"] == "lanelet":
                assert set(relation.members) <= set(again.members)
            elif relation.tags.get("subtype") != "right_of_way":
                assert relation == again
