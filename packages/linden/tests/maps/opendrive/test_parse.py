"""Claims about reading OpenDRIVE: what is read, and what a bad text is told."""

import re
from contextlib import suppress

import carla
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from linden.maps.opendrive.georeference import read_origin
from linden.maps.opendrive.limits import MapError
from linden.maps.opendrive.mesh import road_mesh
from linden.maps.opendrive.model import Arc, ParamPoly3
from linden.maps.opendrive.parse import parse
from linden.maps.opendrive.signals import place
from linden.maps.opendrive.spawn_points import spawn_points
from linden.protocol.values.enums import LaneType
from linden_maps.checks.check import check
from linden_maps.drawing.svg import svg
from opendrive_texts import lane, line, opendrive, road, section, signal, street_through_junction

GOOD = street_through_junction(signals=signal("7", 45.0, -4.5))
ROAD = road(1, 10.0, line(0, 0, 0, 0, 10), section(right=lane(-1)))


def test_roads_lanes_and_junctions_are_read() -> None:
    found = parse(GOOD)
    assert [street.id for street in found.roads] == [1, 2, 10, 11]
    assert [part.id for part in found.roads[0].sections[0].lanes] == [2, 1, 0, -1, -2]
    assert found.roads[0].sections[0].lanes[0].type is LaneType.SIDEWALK
    assert found.roads[0].types[0].limit_mps == pytest.approx(11.176)
    assert found.junctions[0].connections[1].lane_links == ((1, -1),)
    assert found.road_by_id[10].is_in_junction
    assert [sign.id for _, sign in found.signals()] == ["7"]


def test_text_and_bytes_read_alike_whatever_encoding_they_declare() -> None:
    told = GOOD.replace('version="1.0"', 'version="1.0" encoding="ISO-8859-1"')
    assert parse(told).roads == parse(told.encode("latin-1")).roads == parse(GOOD).roads


@pytest.mark.parametrize("kind", ["Driving", "DRIVING", "driving"])
def test_lane_types_are_read_in_any_case(kind: str) -> None:
    assert (
        parse(GOOD.replace('type="driving"', f'type="{kind}"')).roads[1].sections[0].lanes[1].type is LaneType.DRIVING
    )


def test_an_unknown_lane_type_is_none_as_in_libcarla() -> None:
    assert parse(GOOD.replace('"sidewalk"', '"moat"')).roads[0].sections[0].lanes[0].type is LaneType.NONE


def test_shapes_are_read() -> None:
    arc = line(0, 0, 0, 0, 5, '<arc curvature="0.1"/>')
    cubic = line(5, 5, 0, 0, 5, '<paramPoly3 bU="1" dV="0.5" pRange="arcLength"/>')
    shapes = [
        g.shape for g in parse(opendrive(road(1, 10.0, arc + cubic, section(right=lane(-1))))).roads[0].geometries
    ]
    assert shapes == [Arc(0.1), ParamPoly3((0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.5), 5.0)]


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ('length="50.0"', 'length="long"', "line 4: attribute 'length' of <road> is 'long'; it should be a number"),
        ('length="50.0"', 'length="nan"', "it should be a finite number"),
        ('length="50.0"', 'length="1e999"', "it should be a finite number"),
        ('length="50.0"', 'length="5_0"', "it should be a finite number"),
        ('length="50.0"', 'length="-1"', "between 0 and 200000"),
        ('length="50.0"', "", "attribute 'length' of <road> is missing"),
        ('id="1" junction', 'id="Main St" junction', "a whole number"),
        ('id="2" junction="-1"', 'id="1" junction="-1"', "road 1 stands twice, first in line 4"),
        ("<line/>", "<circle/>", "a <geometry> holds circle"),
        ('unit="mph"', 'unit="knots"', "one of m/s, km/h, mph"),
        ('<laneSection s="0.0">', '<laneSection s="90">', "outside its road"),
        ('<lane id="1"', '<lane id="-1"', "lane -1 stands twice"),
        ('<lane id="1"', '<lane id="2000000000"', "between -1000 and 1000"),
        (' a="3.5"', ' a="1e10"', "between -1e+09 and 1e+09"),
        ('length="50.0"', 'length="1e6"', "between 0 and 200000"),
        (' a="3.5"', ' a="inf"', "'a' of <width> is 'inf'"),
        ("</OpenDRIVE>", "", "no well-formed XML"),
        ("OpenDRIVE>", "svg>", "the outermost element is <svg>"),
    ],
)
def test_a_bad_text_is_refused_with_the_value_and_its_place(before: str, after: str, told: str) -> None:
    assert before in GOOD
    with pytest.raises(MapError) as caught:
        parse(GOOD.replace(before, after))
    assert told in str(caught.value)
    assert caught.value.line


@pytest.mark.parametrize(
    "doctype",
    [
        '<!DOCTYPE OpenDRIVE [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
        '<!DOCTYPE OpenDRIVE SYSTEM "file:///etc/passwd">',
        '<!DOCTYPE OpenDRIVE [<!ENTITY % far SYSTEM "http://localhost:1/x"> %far;]>',
    ],
)
def test_a_doctype_is_refused_before_anything_of_it_is_used(doctype: str) -> None:
    with pytest.raises(MapError, match=r"DOCTYPE|well-formed"):
        parse(GOOD.replace("<OpenDRIVE>", doctype + "<OpenDRIVE>", 1))


@given(st.integers(0, len(GOOD)), st.integers(0, 40), st.binary(max_size=6))
def test_no_damage_to_a_text_raises_anything_but_a_map_error(at: int, cut: int, put: bytes) -> None:
    data = GOOD.encode()
    with suppress(MapError):
        parse(data[:at] + put + data[at + cut :])


ATTRIBUTES = [match.span(1) for match in re.finditer(r'="([^"]*)"', GOOD)]
ODD = ["0", "-1", "1", "0.5", "1e6", "1e300", "-1e300", "2147483647", "-2147483648", "1e-300", "", "nan", "yes"]


@settings(max_examples=400)
@given(st.lists(st.tuples(st.sampled_from(ATTRIBUTES), st.sampled_from(ODD)), min_size=1, max_size=3))
def test_whatever_is_read_can_be_used_or_is_refused_with_a_sentence(changes: list[tuple[tuple[int, int], str]]) -> None:
    text = GOOD
    for (start, end), value in sorted(changes, reverse=True):
        text = text[:start] + value + text[end:]
    with suppress(MapError), np.errstate(all="ignore"):
        found = parse(text)
        assert np.isfinite(road_mesh(found).vertices).all()
        spawn_points(found)
        place(found)
        check(found)
        svg(found)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "+proj=tmerc +lat_0=40.5 +lon_0=-82.9",
        "+lat_0=1  +lon_0=4",
        "+lat_0=1 +lon_0=3\n",
        "\n+lat_0=1 +lon_0=3",
        "+lat_0=1,+lon_0=3",
        "+lat_0=1\t+lon_0=4",
        "+lat_0=1.5abc +lon_0=2",
        "+lat_0=1e1 +lon_0=.5",
        "+lat_0=1=2 +lon_0=3",
        "+lat_0=1 +lat_0=2 +lon_0=3",
        "+lat_0=5",
        "+proj=utm +zone=17",
        "EPSG:4326",
        "<![CDATA[+lat_0=7 +lon_0=8]]>",
        "\n  <![CDATA[+lat_0=7 +lon_0=8]]>\n",
    ],
)
def test_the_origin_is_the_one_libcarla_reads(text: str) -> None:
    whole = opendrive(ROAD, geo_reference=text)
    theirs = carla.Map("test", whole).transform_to_geolocation(carla.Location())
    assert parse(whole).geo_origin == pytest.approx((theirs.latitude, theirs.longitude))


def test_an_origin_that_stops_libcarla_counts_as_unreadable() -> None:
    assert read_origin("+lat_0=north +lon_0=2") == (42.0, 2.0, False)


CORNERS = '<cornerLocal u="1" v="1" z="0" height="0"/>'


def crossed(corners: str) -> str:
    outline = f'<object id="1" name="Crosswalk" type="crosswalk" s="30" t="0"><outline>{corners}</outline></object>'
    return street_through_junction(objects=outline)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (crossed(CORNERS.replace('u="1"', 'u="1e308"')), "attribute 'u' of <cornerLocal> is '1e308'"),
        (crossed(CORNERS.replace('u="1"', 'u="1e6"')), "it should be between -10000 and 10000"),
        (crossed(CORNERS * 1001), "1,001 corners in one outline; 1,000 are allowed"),
        (street_through_junction("".join(signal(str(n), 1, 1) for n in range(10_001))), "10,001 signals; 10,000 are"),
        (opendrive("<a/>" * 3_000_001), "elements; 3,000,000 are allowed"),
        (opendrive(*(road(n, 2e5, line(0, 0, 0, 0, 2e5), section()) for n in range(26))), "5,200 km of roads; 5,000"),
    ],
    ids=["beyond numbers", "far", "corners", "signals", "elements", "long"],
)
def test_a_text_that_asks_for_too_much_is_refused_with_the_limit(text: str, told: str) -> None:
    with pytest.raises(MapError) as caught:
        parse(text)
    assert told in str(caught.value)
