"""Tests of ``basu.routing.route_file``."""

import math
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.routing.route_file import RouteDescription, read_routes, subset

LEADERBOARD_1 = """<routes><route id="3" town="Town01"><waypoint x="1.5" y="-2" z="0.1" yaw="90.0" pitch="0" roll="0"/>
<waypoint x="10" y="-2" z="0"/></route></routes>"""
LEADERBOARD_2 = """<routes><route id="3" town="Town01"><weathers/><waypoints><position x="1.5" y="-2" z="0.1"/>
<position x="10" y="-2" z="0"/></waypoints><scenarios/></route></routes>"""
WITH_STOPS = """<routes><route id="a" town="Linden"><waypoints>
<position x="0" y="0"/><position x="9" y="0"/></waypoints>
<stops><stop id="S1" name="Transit Center" x="3" y="1" z="0" yaw="-90"/></stops></route></routes>"""


def written(folder: Path, text: str) -> Path:
    path = folder / "route.xml"
    path.write_text(text)
    return path


def test_the_spelling_of_scenario_runner_is_read(tmp_path: Path) -> None:
    (route,) = read_routes(written(tmp_path, LEADERBOARD_1))
    assert (route.id, route.town) == ("3", "Town01")
    assert [(p.x_m, p.y_m, p.z_m) for p in route.points] == [(1.5, -2.0, 0.1), (10.0, -2.0, 0.0)]
    assert route.points[0].yaw_rad == pytest.approx(math.pi / 2.0)
    assert route.points[1].yaw_rad is None


def test_the_spelling_of_the_second_leaderboard_is_read(tmp_path: Path) -> None:
    (route,) = read_routes(written(tmp_path, LEADERBOARD_2))
    assert [(p.x_m, p.y_m, p.z_m, p.yaw_rad) for p in route.points] == [(1.5, -2.0, 0.1, None), (10.0, -2.0, 0.0, None)]


def test_service_stops_are_read_beside_the_way(tmp_path: Path) -> None:
    (route,) = read_routes(written(tmp_path, WITH_STOPS))
    (stop,) = route.stops
    assert (stop.id, stop.name, stop.point.x_m) == ("S1", "Transit Center", 3.0)
    assert stop.point.yaw_rad == pytest.approx(-math.pi / 2.0)


def test_a_file_may_hand_on_to_another(tmp_path: Path) -> None:
    written(tmp_path, LEADERBOARD_2)
    other = tmp_path / "other.xml"
    other.write_text('<routes><include file="route.xml"/></routes>')
    assert [route.id for route in read_routes(other)] == ["3"]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param("", "is empty; it needs <routes>", id="empty"),
        pytest.param("  \n", "is empty", id="blank"),
        pytest.param("not xml", "is not XML", id="no XML"),
        pytest.param("<routes><route id='1'", "is not XML", id="cut short"),
        pytest.param("<scenarios/>", "holds no <route> .its outermost element is <scenarios>", id="another format"),
        pytest.param("<routes><route town='T'/></routes>", "lacks its attribute 'id'", id="no id"),
        pytest.param("<routes><route id='1'/></routes>", "lacks its attribute 'town'", id="no town"),
        pytest.param(
            "<routes><route id='1' town='T'/></routes>", "has 0 way points and needs at least 2", id="no points"
        ),
        pytest.param(LEADERBOARD_2.replace('x="10" ', ""), "line 2: <position> lacks its attribute 'x'", id="no x"),
        pytest.param(LEADERBOARD_2.replace('"10"', '"ten"'), "x='ten', which is no number", id="no number"),
        pytest.param(LEADERBOARD_2.replace('"10"', '"nan"'), "x='nan', which is no number", id="not a number"),
        pytest.param('<routes><include file="route.xml"/></routes>', "must name another file", id="includes itself"),
        pytest.param("<routes><include/></routes>", "must name another file", id="includes nothing"),
    ],
)
def test_a_mistake_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        read_routes(written(tmp_path, text))


def test_a_missing_file_gets_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"nowhere.xml cannot be read .* `basu list`"):
        read_routes(tmp_path / "nowhere.xml")


def test_two_routes_of_one_id_get_a_sentence(tmp_path: Path) -> None:
    double = LEADERBOARD_2.replace("</routes>", LEADERBOARD_2.removeprefix("<routes>"))
    with pytest.raises(UserError, match="the id '3' is given twice"):
        read_routes(written(tmp_path, double))


def test_files_that_include_each_other_get_a_sentence(tmp_path: Path) -> None:
    written(tmp_path, '<routes><include file="other.xml"/></routes>')
    (tmp_path / "other.xml").write_text('<routes><include file="route.xml"/></routes>')
    with pytest.raises(UserError, match="must name another file"):
        read_routes(tmp_path / "route.xml")


ROUTES = [
    RouteDescription(id=name, town="T", points=(), stops=(), source="r.xml")
    for name in ("0", "1", "2", "3", "7", "24", "A-B")
]


@pytest.mark.parametrize(
    ("wanted", "ids"),
    [
        ("0-3,7", ["0", "1", "2", "3", "7"]),
        ("7, 0", ["0", "7"]),
        ("3-24", ["3", "7", "24"]),
        ("A-B", ["A-B"]),
        ("24-A-B", ["24", "A-B"]),
    ],
)
def test_ids_and_ranges_choose_routes_in_the_files_order(wanted: str, ids: list[str]) -> None:
    assert [route.id for route in subset(ROUTES, wanted)] == ids


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        ("5", "the route file has no '5'; it has 0, 1, 2, 3, 7, 24, A-B"),
        ("0-5", "the route file has no '0-5'"),
        ("", "the route file has no ''"),
        ("3-1", "'1' comes before '3' in the file"),
        ("0-3,2", "route '2' is named twice"),
    ],
)
def test_a_mistake_in_a_subset_gets_a_sentence(wanted: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        subset(ROUTES, wanted)
