"""Claims about reading extracts: what is taken, and what is refused with its file and line."""

import pytest

from linden.errors import UserError
from linden_maps.openstreetmap.extract import read_extract


def osm(*lines: str) -> bytes:
    return "\n".join(['<osm version="0.6">', *lines, "</osm>"]).encode()


NODES = ('<node id="1" lon="-83" lat="40"/>', '<node id="2" lon="-83.001" lat="40"/>')


def test_references_out_of_the_extract_are_left_out_and_counted() -> None:
    found = read_extract(osm(*NODES, '<way id="7"><nd ref="1"/><nd ref="2"/><nd ref="9"/></way>'), "x.osm")
    assert found.ways[7].nodes == (1, 2)
    assert found.dangling == 1


def test_ids_of_64_bits_are_kept() -> None:
    found = read_extract(osm('<node id="9223372036854775807" lon="0" lat="0"/>'), "x.osm")
    assert set(found.nodes) == {2**63 - 1}


def test_what_an_editor_deleted_is_no_part() -> None:
    found = read_extract(osm(*NODES, '<node id="3" lon="0" lat="0" action="delete"/>'), "x.osm")
    assert set(found.nodes) == {1, 2}


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "x.osm, line 1: the file is empty; name an OpenStreetMap extract"),
        (b"<osm>", "x.osm, line 1: this is no well-formed XML"),
        (b"<gpx/>", "x.osm, line 1: the outermost element is <gpx>, not <osm>"),
        (osm('<node id="1" lon="-83" lat="95"/>'), "x.osm, line 2: `lat` of <node> is '95'; it should be degrees"),
        (osm('<node id="1" lon="-83"/>'), "x.osm, line 2: `lat` of <node> is missing"),
        (osm('<node id="1" lon="nan" lat="4"/>'), "x.osm, line 2: `lon` of <node> is 'nan'"),
        (osm('<node id="x" lon="0" lat="0"/>'), "x.osm, line 2: `id` of <node> is 'x'; it should be a whole number"),
        (osm('<node id="9223372036854775808" lon="0" lat="0"/>'), "a whole number of 64 bits"),
        (osm(NODES[0], NODES[0]), "x.osm, line 3: node 1 stands twice"),
        (
            osm('<relation id="1"><tag k="type" v="lanelet"/></relation>'),
            "x.osm is a Lanelet2 map, not an OpenStreetMap",
        ),
    ],
)
def test_what_is_no_extract_is_refused_with_file_and_line(data: bytes, sentence: str) -> None:
    with pytest.raises(UserError) as refusal:
        read_extract(data, "x.osm")
    assert sentence in str(refusal.value)


def test_entities_are_not_expanded() -> None:
    text = b'<!DOCTYPE osm [<!ENTITY e "x">]><osm><node id="1" lon="0" lat="0"><tag k="name" v="a"/></node>&e;</osm>'
    assert set(read_extract(text, "x.osm").nodes) == {1}
