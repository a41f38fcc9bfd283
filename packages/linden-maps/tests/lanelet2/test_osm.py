import numpy as np
import pytest

from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.lanelet2.convert import convert
from linden_maps.lanelet2.osm import osm_bytes, projector_info, read_osm
from linden_maps.lanelet2.projection import Projection, projection_of
from naive import transverse_mercator
from vector_map_town import GEO, two_roads


def test_degrees_are_those_of_the_series():
    text = "+proj=tmerc +lat_0=39.9937118 +lon_0=-82.9816685 +k=1 +x_0=0 +y_0=0 +datum=WGS84"
    x, y = np.array([0.0, 2000.0, -30000.0, 5.0]), np.array([0.0, -1500.0, 40000.0, 9.0])
    projection = projection_of(text)
    lat, lon = projection.degrees(x, y)
    expected = transverse_mercator.degrees((39.9937118, -82.9816685), 1.0, (0.0, 0.0), x, y)
    assert np.abs(lat - expected[0]).max() < 1e-10
    assert np.abs(lon - expected[1]).max() < 1e-10
    again = projection.metres(lat, lon)
    assert np.abs(np.stack(again) - np.stack([x, y])).max() < 1e-6


def test_utm_is_known():
    lat, lon = projection_of("+proj=utm +zone=17 +datum=WGS84").degrees(331000.0, 4428000.0)
    expected = transverse_mercator.degrees((0.0, -81.0), 0.9996, (500000.0, 0.0), np.array([331e3]), np.array([4428e3]))
    assert (lat, lon) == pytest.approx(tuple(np.concatenate(expected)), abs=1e-9)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("+proj=merc +lat_0=0", "is no transverse Mercator"),
        ("+proj=tmerc +lat_0=north", r"\+lat_0=north; it should be a number"),
        ("+proj=utm", "names no UTM zone"),
        ("+proj=tmerc +lat_0=95", "is none that PROJ knows.*lat_0"),
    ],
)
def test_other_projections_are_refused(text, sentence):
    with pytest.raises(UserError, match=sentence):
        projection_of(text)


def test_a_map_comes_back_as_it_was_written():
    before = convert(parse(two_roads())).lanelet_map
    after = read_osm(osm_bytes(before), "small.osm", before.geo_reference)
    assert after.ways == before.ways
    assert after.relations == before.relations
    assert after.nodes.keys() == before.nodes.keys()
    assert max(np.abs(np.subtract(after.nodes[n][:3], before.nodes[n][:3])).max() for n in before.nodes) < 6e-5


def test_without_local_coordinates_degrees_are_projected():
    before = convert(parse(two_roads())).lanelet_map
    text = osm_bytes(before).decode().replace("local_", "old_").encode()
    after = read_osm(text, "small.osm", before.geo_reference)
    assert max(np.abs(np.subtract(after.nodes[n][:2], before.nodes[n][:2])).max() for n in before.nodes) < 1e-4


def test_projector_info():
    lanelets = convert(parse(two_roads())).lanelet_map
    assert projector_info(lanelets) == b"projector_type: Local\n"
    own = projector_info(lanelets, transverse_mercator=True).decode()
    assert "projector_type: TransverseMercator" in own
    assert "latitude: 40.0" in own
    assert "scale_factor: 1" in own


def test_no_georeference_is_local_at_zero():
    lanelets = convert(parse(two_roads(geo=""))).lanelet_map
    assert b'lat="0.0000' in osm_bytes(lanelets)
    with pytest.raises(UserError, match="no <geoReference>"):
        projector_info(lanelets, transverse_mercator=True)
    assert GEO  # the maps of the other tests have one


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (b"", r"m.osm, line 1: the file is empty"),
        (b"<osm>\n<node", "m.osm, line 2: this is no well-formed XML"),
        (b"<OpenDRIVE/>", "the outermost element is <OpenDRIVE>, not <osm>"),
        (
            b'<osm>\n<node id="9223372036854775808" lat="0" lon="0"/></osm>',
            "line 2: id='9223372036854775808'.* 64 bits",
        ),
        (b'<osm><node id="x" lat="0" lon="0"/></osm>', "id='x' of <node> is no whole number"),
        (b'<osm><node id="1" lat="0" lon="0"/>\n<node id="1" lat="0" lon="0"/></osm>', "line 2: node 1 stands twice"),
        (b'<osm><node id="1" lat="nan" lon="0"/></osm>', "lat is 'nan'; it should be a number"),
        (b'<osm><node id="1" lat="95" lon="0"/></osm>', "line 1: latitude 95 .* are no place on Earth"),
        (b'<osm><way id="1"><nd ref="7"/></way></osm>', "way 1 names node 7, which is not there"),
        (
            b'<osm><relation id="3"><tag k="type" v="lanelet"/></relation></osm>',
            "lanelet 3 has 0 ways as its left bound",
        ),
    ],
)
def test_broken_files_get_a_sentence_with_file_and_line(text, sentence):
    with pytest.raises(UserError, match=sentence):
        read_osm(text, "m.osm")


def test_ids_of_64_bits_and_negative_ones_are_read():
    text = b'<osm><node id="9223372036854775807" lat="1" lon="2"/><node id="-4" lat="1" lon="2"/></osm>'
    assert list(read_osm(text, "m.osm").nodes) == [9223372036854775807, -4]
    assert isinstance(projection_of("+proj=tmerc"), Projection)
