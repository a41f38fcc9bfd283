"""Claims about the shuttle's stops and the roundabouts in Lanelet2."""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.lanelet2.bus_stops import LENGTH_M, KerbStop, shuttle_stops
from linden_maps.lanelet2.convert import Wanted, convert
from linden_maps.lanelet2.model import bounds_of, without_lanelets
from linden_maps.lanelet2.osm import osm_bytes
from linden_maps.lanelet2.overlap import overlap_share
from linden_maps.lanelet2.second_reader import routes_of
from vector_map_town import document, lane, road


def _areas(lanelet_map):
    return {
        way.tags["stop_id"]: number
        for number, way in lanelet_map.ways.items()
        if way.tags.get("type") == "bus_stop_area"
    }


def test_every_stop_of_the_shuttle_has_an_area_with_its_name(linden_everything) -> None:
    areas = _areas(linden_everything.lanelet_map)
    assert areas.keys() == {"S1", "S2N", "S2S", "S3E", "S3W", "S4"}
    assert linden_everything.lanelet_map.ways[areas["S4"]].tags["name"] == "St. Stephen's Community House"
    assert linden_everything.lost_stops == ()


def test_an_area_lies_on_the_lanelets_that_refer_to_it_near_the_stop(linden, linden_everything) -> None:
    lanelet_map = linden_everything.lanelet_map
    stops = {stop.id: stop for stop in shuttle_stops(linden.geo_origin)}
    for stop_id, area in _areas(lanelet_map).items():
        ring = lanelet_map.line(area)[:, :2]
        assert np.hypot(*(ring.mean(axis=0) - (stops[stop_id].x_m, stops[stop_id].y_m))).min() < 8.0
        element = next(number for number, one in lanelet_map.elements("bus_stop_area") if one.refs("refers") == [area])
        users = [one for _, one in lanelet_map.lanelets() if element in one.refs("regulatory_element")]
        assert {user.tags["subtype"] for user in users} <= {"road", "road_shoulder"}
        outlines = [
            np.array([lanelet_map.nodes[n][:2] for n in (*sides.left, *sides.right[::-1])])
            for sides in (bounds_of(lanelet_map, user) for user in users)
        ]
        assert sum(overlap_share(ring, outline) for outline in outlines) == pytest.approx(1.0, abs=0.02)
        sides = np.linalg.norm(np.diff(ring, axis=0), axis=1)
        assert sides.max() < LENGTH_M + 0.1


def test_a_stop_far_from_any_lane_is_reported() -> None:
    near, lost = KerbStop("A", "near", 20.0, -3.0), KerbStop("X", "nowhere", 50_000.0, 0.0)
    converted = convert(parse(document(road(1, 0, 40, [(-1, lane(-1))]))), Wanted(stops=(near, lost)))
    assert converted.lost_stops == (lost,)
    assert _areas(converted.lanelet_map).keys() == {"A"}


def test_a_roundabout_names_its_lanelets_by_role(linden, linden_everything) -> None:
    elements = [one for _, one in linden_everything.lanelet_map.elements("roundabout")]
    assert len(elements) == sum("roundabout" in dict(junction.user_data) for junction in linden.junctions) == 2
    for element in elements:
        entry, out, internal = (element.refs(role) for role in ("entry", "exit", "internal"))
        assert min(len(entry), len(out), len(internal)) > 2
        assert not set(internal) & {*entry, *out}
        tags = [linden_everything.lanelet_map.relations[number].tags for number in internal]
        assert len({tag["intersection_area"] for tag in tags}) == 1


def test_format_2_is_named_in_the_file_only_where_it_is_wanted(linden_everything, linden_lanelets) -> None:
    street, stop = parse(document(road(1, 0, 40, [(-1, lane(-1))]))), KerbStop("A", "near", 20.0, -3.0)
    versions = [
        ET.fromstring(osm_bytes(convert(street, wanted).lanelet_map)).find("MetaInfo").get("format_version")
        for wanted in (Wanted(stops=(stop,)), Wanted(roundabouts=True), Wanted())
    ]
    assert versions == ["1", "2", "1"]
    assert linden_everything.lanelet_map.format_version == "2"
    assert not list(linden_lanelets.lanelet_map.elements("roundabout"))


@pytest.mark.unmeasured
def test_second_reader_still_finds_the_same_lanes(linden_everything, linden_routes) -> None:
    routes = routes_of(linden_everything.lanelet_map)
    assert routes.errors == ()
    assert routes.following == linden_routes.following


def test_without_sidewalks_nothing_else_goes(linden_lanelets) -> None:
    whole = linden_lanelets.lanelet_map
    rest = without_lanelets(whole, "walkway")
    assert not list(rest.lanelets("walkway"))
    gone = set(whole.relations) - set(rest.relations)
    assert {whole.relations[number].tags["subtype"] for number in gone} == {"walkway"}
    used = {member.ref for one in rest.relations.values() for member in one.members if member.kind == "way"}
    assert used <= set(rest.ways)
    assert {node for way in rest.ways.values() for node in way.nodes} == set(rest.nodes)
    standing = {number for number, way in whole.ways.items() if way.tags.get("type") in {"road_border", "stop_line"}}
    assert standing <= set(rest.ways)
