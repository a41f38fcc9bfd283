import math

import numpy as np
import pytest

from linden.maps.opendrive.parse import parse
from linden_maps.aisan.convert import convert
from linden_maps.aisan.points import packed
from linden_maps.aisan.reading import complaints, heading_errors, read_folder
from linden_maps.aisan.tables import COLUMNS, STRAIGHT_R
from linden_maps.lanelet2.convert import convert as lanelets_of
from linden_maps.lanelet2.osm import osm_bytes, read_osm
from linden_maps.output import write_folder
from opendrive_texts import SIGNS_AND_LIGHTS
from tracing import untraced_here
from vector_map_town import two_roads


def _column(folder, name, column):
    return folder[name][:, COLUMNS[name].index(column)]


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    path = tmp_path_factory.mktemp("aisan") / "small"
    write_folder(path, convert(lanelets_of(parse(two_roads())).lanelet_map).tables.files())
    return read_folder(path)


@pytest.fixture(scope="module")
def town_files(linden_lanelets):
    with untraced_here():  # the streets with signs and lights take the same lines
        return convert(linden_lanelets.lanelet_map).tables.files()


@pytest.fixture(scope="module")
def town(tmp_path_factory, town_files):
    path = tmp_path_factory.mktemp("aisan") / "linden"
    write_folder(path, town_files)
    return read_folder(path)


def test_degrees_are_packed():
    assert packed(np.array([35.5, -82.9816685, 0.0])) == pytest.approx([35.30, -82.58540066, 0.0], abs=1e-12)
    assert packed(np.array([36.0 - 1e-11]))[0] == 36.0  # never 35.5960


def test_rows_are_about_a_metre_and_follow_each_other(small):
    assert np.abs(_column(small, "lane", "Span") - 1.0).max() < 0.05
    assert _column(small, "lane", "Span").sum() == pytest.approx(210.0 + 30.0 * 0.02 * (-1.75 + 1.75 + 5.25), abs=0.5)
    assert complaints(small) == []


def test_north_and_east_are_bx_and_ly(small):
    east = np.flatnonzero(_column(small, "lane", "LCnt") == 2)[0]
    first = small["point"][int(_column(small, "dtlane", "PID")[east]) - 1]
    assert first[3:6] == pytest.approx([100.0, -1.75, 0.0], abs=1e-3)  # H, Bx, Ly
    lanes = _column(small, "dtlane", "Dir")[
        (_column(small, "lane", "Lno") == 1) & (_column(small, "lane", "LCnt") == 2)
    ]
    assert lanes[0] == pytest.approx(math.pi / 2.0, abs=1e-3)  # to the east


def test_lanes_count_from_the_left_and_share_a_section(small):
    count, number, section = (_column(small, "lane", name) for name in ("LCnt", "Lno", "RoadSecID"))
    assert set(zip(count, number, strict=True)) == {(1, 1), (2, 1), (2, 2)}
    assert len(np.unique(section)) == 4
    assert set(_column(small, "lane", "LaneChgFG")[count == 2]) == {0}
    assert set(_column(small, "lane", "LaneChgFG")[count == 1]) == {1}


def test_limits_are_whole_kilometres_an_hour(small):
    assert set(_column(small, "lane", "LimitVel")) == {40}


def test_bends_have_their_radius_and_straights_the_sentinel(small):
    radius, along = _column(small, "dtlane", "r"), _column(small, "dtlane", "Dist")
    east = _column(small, "lane", "LCnt") == 2
    bent = radius[east & (radius != STRAIGHT_R)]
    assert len(bent) > 50
    assert np.abs(np.abs(bent) - 53.5).max() < 12.0  # 1 / 0.02 m, and up to 5 m further out
    assert (bent < 0.0).all()  # a left bend
    assert (radius[east & (along < 30.0)][:30] == STRAIGHT_R).all()


def test_half_widths_and_slope(small):
    assert _column(small, "dtlane", "LW") == pytest.approx(1.75, abs=0.02)
    slope = np.abs(_column(small, "dtlane", "slope"))
    assert slope.min() > 1.8  # 2 per cent along the road; the outer lane of the bend is longer
    assert np.median(slope) == pytest.approx(2.0, abs=0.01)


def test_paint_has_its_colours_and_dashes(small):
    kinds = set(zip(_column(small, "whiteline", "Color"), _column(small, "whiteline", "type"), strict=True))
    assert kinds == {(1.0, 0.0), (0.0, 1.0), (0.0, 2.0)}  # solid yellow; white paint and gaps


def test_from_lanelet2_signs_lights_and_crosswalks_are_the_same(tmp_path):
    opendrive = parse(SIGNS_AND_LIGHTS)
    lanelet_map = lanelets_of(opendrive).lanelet_map
    files = convert(lanelet_map).tables.files()
    assert {"signaldata.csv", "roadsign.csv", "stopline.csv", "crosswalk.csv", "intersection.csv"} <= files.keys()
    assert convert(read_osm(osm_bytes(lanelet_map), "map.osm", opendrive.geo_reference)).tables.files() == files
    write_folder(tmp_path / "map", files)
    assert complaints(read_folder(tmp_path / "map")) == []


class TestLinden:
    """The shipped town, as a whole."""

    @pytest.mark.unmeasured
    def test_autowares_nodes_have_nothing_to_stumble_over(self, town):
        assert complaints(town) == []
        assert heading_errors(town).max() < 0.02

    def test_all_files_are_there(self, town):
        assert set(town) == set(COLUMNS)
        assert len(town["stopline"]) >= 179
        assert len(town["roadsign"]) == 157
        assert len(town["signaldata"]) == 3 * 22
        assert len(town["intersection"]) == 120  # of 131 junctions: traffic enters them from two roads or more
        assert (_column(town, "crosswalk", "Type") == 0).sum() == 40

    def test_every_lane_of_the_opendrive_map_is_there(self, town):
        assert _column(town, "lane", "Span").sum() / 1000.0 == pytest.approx(93.14, rel=0.001)

    def test_links_and_signs_name_rows_on_their_lane(self, town):
        assert (_column(town, "stopline", "LinkID") > 0).all()
        named = (_column(town, "stopline", "TLID") > 0) ^ (_column(town, "stopline", "SignID") > 0)
        assert named.all()
        assert (_column(town, "roadsign", "Type") == 1).all()

    def test_branches_are_flagged(self, town):
        branches = np.count_nonzero(_column(town, "lane", "FLID2"))
        assert branches > 300
        assert np.isin(_column(town, "lane", "JCT")[_column(town, "lane", "FLID2") > 0], (1, 2, 5)).all()

    def test_each_junction_has_its_own_area(self, town):
        """The public converter makes one hull over the whole town."""
        points, lines = town["point"], town["line"].astype(int)
        for _, area, _ in town["intersection"].astype(int):
            _, first, last = town["area"][area - 1].astype(int)
            ring = points[lines[first - 1 : last, 1] - 1][:, 4:6]
            assert np.ptp(ring, axis=0).max() < 100.0

    @pytest.mark.unmeasured
    def test_from_lanelet2_is_the_same_town_byte_for_byte(self, linden, linden_lanelets, town_files):
        text = osm_bytes(linden_lanelets.lanelet_map)
        read = read_osm(text, "linden.osm", linden.geo_reference)
        assert convert(read).tables.files() == town_files
