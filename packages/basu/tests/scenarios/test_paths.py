"""Claims about paths: their geometry, and those found on a map's lanes and junctions."""

import math
from pathlib import Path as File

import carla
import numpy as np
import pytest

import linden
from basu.errors import ScenarioError
from basu.routing import lane_graph, plan
from basu.routing.route_file import RouteDescription, RoutePoint
from basu.scenarios.paths import (
    Path,
    along_lane,
    crossing,
    crossings,
    junctions,
    lanes_apart_m,
    next_junction,
    oncoming,
    parked_m,
    pavement_m,
)
from basu.scenarios.place import Place
from basu.scenarios.stage import Pose
from basu.testing import offline_place
from fakes.crossing_map import crossing as crossing_map

QUARTER = [(20.0 * math.sin(a), 20.0 - 20.0 * math.cos(a)) for a in np.linspace(0.0, math.pi / 2.0, 60)]  # to the right


def on_the_crossing(*points: tuple[float, float], trigger_s_m: float = 0.0) -> Place:
    """A route on the little crossing of the tests: four arms, lanes 3.5 m wide, right-hand traffic."""
    town = carla.Map("Crossing", crossing_map())
    description = RouteDescription(
        id="r",
        town="Crossing",
        points=tuple(RoutePoint(x, y, 0.0, None) for x, y in points),
        stops=(),
        source="a test",
    )
    return Place(route=plan(town, description, lane_graph.build(town)), trigger_s_m=trigger_s_m, carla_map=town)


@pytest.fixture(scope="module")
def westward() -> Place:
    """From the east straight on to the west."""
    return on_the_crossing((60.0, -1.75), (-60.0, -1.75))


def test_a_quarter_turn_has_its_length_and_its_heading() -> None:
    path = Path.through(QUARTER)
    assert path.length_m == pytest.approx(10.0 * math.pi, abs=0.01)
    assert path.heading_rad(0.0) == pytest.approx(0.0, abs=0.02)
    assert path.heading_rad(path.length_m) == pytest.approx(math.pi / 2.0, abs=0.02)


def test_beyond_its_ends_a_path_goes_straight_on() -> None:
    path = Path.through([(0.0, 0.0), (10.0, 0.0)])
    assert path.at(13.0)[:2] == pytest.approx((13.0, 0.0))
    assert path.at(-2.0, 1.0)[:2] == pytest.approx((-2.0, 1.0))
    assert path.nearest(13.0, 1.0) == pytest.approx((13.0, 1.0, 1.0))
    assert path.nearest(-2.0, -1.0) == pytest.approx((-2.0, -1.0, 1.0))


@pytest.mark.parametrize(("s_m", "right_m"), [(3.0, 1.5), (15.0, -2.0), (31.0, 0.0)])
def test_the_nearest_place_undoes_the_place(s_m: float, right_m: float) -> None:
    path = Path.through(QUARTER)
    pose = path.at(s_m, right_m)
    near = path.nearest(pose.x_m, pose.y_m)
    assert near.s_m == pytest.approx(s_m, abs=0.05)
    assert near.right_m == pytest.approx(right_m, abs=0.01)


def test_a_path_that_crosses_itself_is_followed_on_the_branch_one_is_on() -> None:
    loop = Path.through([(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (20.0, 20.0), (20.0, -20.0)])
    assert loop.nearest(19.0, 0.1).s_m == pytest.approx(19.0, abs=0.01)
    assert loop.nearest(19.0, 0.1, around_m=98.0).s_m == pytest.approx(99.9, abs=0.01)


def test_beside_a_bend_to_the_right_is_shorter_on_the_right() -> None:
    path = Path.through(QUARTER)
    assert path.beside(2.0).length_m == pytest.approx(18.0 * math.pi / 2.0, abs=0.1)
    assert path.beside(-2.0).length_m == pytest.approx(22.0 * math.pi / 2.0, abs=0.1)


def test_a_swerve_begins_and_ends_where_it_is_reported_without_a_kink() -> None:
    swerve = Path.through([(0.0, 0.0), (100.0, 0.0)]).swerved(20.0, 30.0, 3.5, 0.0)
    assert swerve.at(10.0).y_m == pytest.approx(3.5)
    y_m = swerve.points_m[:, 1]
    assert swerve.points_m[y_m < 3.49, 0].min() > 20.0
    assert y_m[-1] == pytest.approx(0.0)
    assert np.abs(np.diff(swerve.yaw_rad)).max() < math.radians(1.5)
    assert np.abs(swerve.yaw_rad).max() == pytest.approx(math.atan(1.875 * 3.5 / 30.0), rel=0.01)  # the quintic's slope


def test_a_part_and_what_follows_make_the_whole() -> None:
    path = Path.through(QUARTER)
    again = path.part(0.0, 12.0).then(path.part(12.0, path.length_m))
    assert again.length_m == pytest.approx(path.length_m, abs=1e-3)
    assert path.reversed().at(0.0)[:2] == pytest.approx(path.at(path.length_m)[:2])


def test_a_path_of_one_point_is_refused() -> None:
    with pytest.raises(ScenarioError, match="at least two points"):
        Path.through([(1.0, 1.0), (1.0, 1.0)])


def test_a_stretch_that_is_not_there_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"no stretch from 10\.0 to 8\.0 m"):
        Path.through([(0.0, 0.0), (8.0, 0.0)]).part(10.0, 20.0)


def test_a_stretch_of_the_route_keeps_to_its_right() -> None:
    place = offline_place([(0.0, 0.0), (50.0, 0.0)])
    kerb = Path.of_route(place.route, 10.0, 30.0, right_m=2.0)
    assert kerb.length_m == pytest.approx(20.0)
    assert kerb.points_m[:, 1] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("turn", "end"), [("straight", (-40.0, -1.75)), ("right", (1.75, -40.0)), ("left", (-1.75, 40.0))]
)
def test_a_path_along_the_lane_turns_as_commanded(westward: Place, turn: str, end: tuple[float, float]) -> None:
    path = along_lane(westward.carla_map, Pose(58.0, -1.75, 0.0, math.pi), 115.0, (turn,))
    assert path.nearest(*end).distance_m < 0.3


def test_no_lane_is_found_far_from_the_road(westward: Place) -> None:
    with pytest.raises(ScenarioError, match="no driving lane"):
        along_lane(westward.carla_map, Pose(40.0, 40.0), 20.0)


def test_an_ego_that_comes_the_other_way_drives_in_the_other_lane(westward: Place) -> None:
    path = oncoming(westward, 50.0, 10.0)
    assert path.points_m[:, 1] == pytest.approx(1.75, abs=0.05)
    assert path.points_m[0, 0] == pytest.approx(10.0, abs=1.0)
    assert path.points_m[-1, 0] == pytest.approx(50.0, abs=1.0)
    assert oncoming(westward, 50.0, 10.0, right_m=1.0).points_m[:, 1] == pytest.approx(2.75, abs=0.05)


def test_an_oncoming_path_the_wrong_way_round_is_refused(westward: Place) -> None:
    with pytest.raises(ScenarioError, match="not beyond its end"):
        oncoming(westward, 10.0, 50.0)


def test_the_junction_ahead_says_what_the_route_does_there(westward: Place) -> None:
    (junction,) = junctions(westward)
    assert junction.turn == "straight"
    assert junction == next_junction(westward)
    assert 40.0 < junction.from_m < junction.to_m < 80.0
    with pytest.raises(ScenarioError, match="enters no junction beyond 90 m"):
        next_junction(westward, 90.0)


@pytest.mark.parametrize(("side", "from_y_m", "x_m"), [("left", 1.0, 1.75), ("right", -1.0, -1.75)])
def test_an_ego_that_comes_from_a_side_crosses_where_the_lanes_cross(
    westward: Place, side: str, from_y_m: float, x_m: float
) -> None:
    # driving west, the left is the south (y > 0), with its northbound lane at x 1.75
    found = crossing(westward, side, "straight")
    assert math.copysign(1.0, found.path.points_m[0, 1]) == from_y_m
    met = found.path.at(found.meet_s_m)
    assert (met.x_m, met.y_m) == pytest.approx((x_m, -1.75), abs=0.6)
    assert westward.at(found.ego_s_m)[:2] == pytest.approx((x_m, -1.75), abs=0.6)


def test_of_all_ways_through_a_junction_only_those_are_given_that_meet_the_egos(westward: Place) -> None:
    found = crossings(westward, next_junction(westward))
    ways = {(way.side, way.turn) for way in found}
    assert ("opposite", "left") in ways
    assert ("right", "right") in ways  # merges into the ego's lane
    assert ("opposite", "straight") not in ways
    assert ("opposite", "right") not in ways


def test_a_way_that_is_not_there_is_refused_with_the_ways_that_are(westward: Place) -> None:
    with pytest.raises(ScenarioError, match=r"no path comes from the opposite going straight.*there are: left"):
        crossing(westward, "opposite", "straight")


@pytest.fixture(scope="module")
def in_linden() -> Place:
    """Three hundred metres along a street of Linden."""
    text = (File(linden.__file__).parent / "data/Linden.xodr").read_text()
    town = carla.Map("Linden", text)
    pose = Pose(263.2, 116.9, 247.3, math.radians(3.2))  # on Bonham Avenue, to the east
    ahead = along_lane(town, pose, 300.0)
    description = RouteDescription(
        id="r",
        town="Linden",
        points=tuple(RoutePoint(*ahead.at(s)[:3], None) for s in (0.0, 60.0, 120.0, ahead.length_m - 5.0)),
        stops=(),
        source="a test",
    )
    return Place(route=plan(town, description), trigger_s_m=0.0, carla_map=town)


def test_every_junction_of_a_street_of_linden_has_ways_that_meet_the_egos(in_linden: Place) -> None:
    place = in_linden
    assert junctions(place)
    for junction in junctions(place):
        for way in crossings(place, junction):
            met, ego = way.path.at(way.meet_s_m), place.at(way.ego_s_m)
            assert math.dist(met[:2], ego[:2]) < 1.5
            assert np.abs(np.diff(way.path.yaw_rad)).max() < math.radians(40.0)  # no jumps back


def test_the_pavement_is_beyond_an_actor_that_parks(in_linden: Place) -> None:
    for ahead_m in (10.0, 100.0, 200.0):
        parked, right, left = (
            parked_m(in_linden, ahead_m),
            pavement_m(in_linden, ahead_m, "right"),
            pavement_m(in_linden, ahead_m, "left"),
        )
        assert in_linden.width_m(ahead_m) / 2.0 < parked < right < 9.0
        assert -14.0 < left < -lanes_apart_m(in_linden, ahead_m) - 1.4  # beyond the oncoming lane


def test_without_a_map_pavement_and_parking_are_where_they_mostly_are() -> None:
    place = offline_place([(0.0, 0.0), (50.0, 0.0)])
    assert pavement_m(place, 10.0, "right") == -pavement_m(place, 10.0, "left") == 5.6
    assert parked_m(place, 10.0) == pytest.approx(1.75 + 1.05)


def test_without_a_map_an_ego_that_comes_the_other_way_drives_a_lanes_width_to_the_left() -> None:
    path = oncoming(offline_place([(0.0, 0.0), (50.0, 0.0)], lane_width_m=3.0), 40.0, 5.0)
    assert path.points_m[:, 1] == pytest.approx(-3.0)
    assert path.at(0.0).yaw_rad == pytest.approx(math.pi)
