"""The part of a map along a route: complete for a planner, small enough for lane_rule."""

import numpy as np
import pytest
import shapely

from linden.errors import UserError
from linden.maps.opendrive.parse import parse
from linden_maps.aisan.along import part_along, read_positions, way_along
from linden_maps.aisan.convert import convert
from linden_maps.aisan.lanes import courses_of, graph_of
from linden_maps.aisan.reading import complaints, read_folder
from linden_maps.aisan.tables import COLUMNS
from linden_maps.lanelet2.convert import convert as lanelets_of
from linden_maps.output import write_folder
from tracing import untraced_here
from vector_map_town import two_roads

ALONG_THE_FIRST = ((5.0, -1.75), (30.0, -1.75))
"""Two positions on the first of two roads, x and y to the north in m."""


def _route(tmp_path, text):
    path = tmp_path / "route.xml"
    path.write_text(f"<routes>{text}</routes>")
    return path


@pytest.fixture
def lanelets():
    return lanelets_of(parse(two_roads())).lanelet_map


def test_positions_of_a_route_file_are_turned_to_the_north(tmp_path):
    text = '<route><waypoints><position x="1" y="2" z="0"/><position x="3" y="-4" z="0"/></waypoints></route>'
    assert read_positions(_route(tmp_path, text)).tolist() == [[1.0, -2.0], [3.0, 4.0]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no route of at least two positions"),
        ('<route><position x="1" y="2"/></route>', "has no route of at least two positions"),
        ('<route><position x="1" y="2"/><position x="nan" y="2"/></route>', "has no route of at least two"),
        ('<route><position x="1"/><position x="1" y="2"/></route>', "a position needs the numbers x and y"),
        ('<route><position x="east" y="2"/></route>', "a position needs the numbers x and y"),
        ("<route>", "cannot read the route of"),
    ],
)
def test_a_file_without_a_route_is_refused_in_a_sentence(tmp_path, text, words):
    with pytest.raises(UserError, match=words):
        read_positions(_route(tmp_path, text))


def test_a_route_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(UserError, match="cannot read the route of"):
        read_positions(tmp_path / "none.xml")


def test_a_position_far_from_every_lane_is_named(lanelets):
    with pytest.raises(UserError, match=r"position x 5\.0, y 400\.0 is \d+ m from the nearest lane"):
        way_along(lanelets, np.array([(5.0, -1.75), (5.0, -400.0)]))


def test_a_distance_that_reaches_no_side_of_a_lane_is_refused(lanelets):
    way = way_along(lanelets, np.array(ALONG_THE_FIRST))
    with pytest.raises(UserError, match=r"within 0\.5 m of the route; give --within a larger distance"):
        part_along(lanelets, way, 0.5)


def test_everything_is_kept_within_a_great_distance(lanelets):
    part = part_along(lanelets, way_along(lanelets, np.array(ALONG_THE_FIRST)), 1000.0)
    assert convert(part).tables.files() == convert(lanelets).tables.files()


def test_the_way_follows_the_lanes_where_positions_are_far_apart(linden_lanelets):
    """Between two positions on both sides of a corner of Linden the lanes make the way, not the straight line alone."""
    ends = np.array([(524.816, 17.225), (448.541, 60.042), (562.011, 248.784)])
    way = way_along(linden_lanelets.lanelet_map, ends)
    on_the_street = shapely.Point(498.376, 104.608)  # a position of linden_short.xml, y to the north
    assert shapely.LineString(ends).distance(on_the_street) > 10.0
    assert way.distance(on_the_street) < 1.0


def test_the_part_along_a_route_of_linden_is_the_lanes_near_it(linden_lanelets, tmp_path):
    """The work of lane_rule grows with the square of the rows, so it is the 81st part of the whole map's at most."""
    whole = linden_lanelets.lanelet_map
    way = way_along(whole, np.array([(524.816, 17.225), (562.011, 248.784)]))
    with untraced_here():
        part = part_along(whole, way, 20.0)
        write_folder(tmp_path / "part", convert(part).tables.files())
    rows = read_folder(tmp_path / "part")
    assert complaints(rows) == []
    assert 300 < len(rows["lane"]) < 93_000 / 9
    signs = rows["stopline"][:, COLUMNS["stopline"].index("SignID")]
    assert (signs > 0).sum() >= 1
    for _, lanelet in part.lanelets("road"):
        nodes = {node for role in ("left", "right") for node in part.ways[lanelet.refs(role)[0]].nodes}
        away_m = min(way.distance(shapely.Point(part.nodes[node][:2])) for node in nodes)
        assert away_m < 120.0  # a long side comes near between its nodes


def test_no_lane_of_a_part_ends_in_the_open_but_those_of_the_way(linden_lanelets):
    """op_global_planner of Autoware.AI joins such an end to any lane nearby, and died of one in Linden."""
    whole = linden_lanelets.lanelet_map
    way = way_along(whole, np.array([(524.816, 17.225), (562.011, 248.784)]))
    part = part_along(whole, way, 20.0)
    courses = courses_of(part)
    graph = graph_of(part, courses)
    links = zip(courses, graph.predecessors, graph.successors, strict=True)
    open_ended = [course for course, before, after in links if not before or not after]
    assert 1 <= len(open_ended) <= 2  # the first and the last of the way
    for course in open_ended:
        assert shapely.covers(shapely.buffer(way, 0.2), shapely.LineString(course.middle[:, :2]))


def test_lanes_that_end_in_the_whole_map_too_are_kept(lanelets):
    part = part_along(lanelets, way_along(lanelets, np.array(ALONG_THE_FIRST)), 1000.0)
    assert len(courses_of(part)) == len(courses_of(lanelets)) > 2
