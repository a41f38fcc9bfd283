"""Tests of ``basu.routing.plan``."""

import math

import carla
import numpy as np
import pytest

from basu.errors import UserError
from basu.routing import ControlKind, RouteControl, plan
from basu.routing.plan import SAME_LINE_M, _lines
from basu.routing.route_file import RouteDescription, RoutePoint, StopMark
from fakes.crossing_map import crossing


def light(landmark_id: str, s_m: float) -> RouteControl:
    return RouteControl(
        kind=ControlKind.TRAFFIC_LIGHT, landmark_id=landmark_id, s_m=s_m, x_m=0.0, y_m=0.0, z_m=0.0, yaw_rad=0.0
    )


def test_a_reference_behind_a_line_is_no_second_line() -> None:
    line, reference, next_light = light("4", 100.0), light("4", 105.2), light("7", 110.0)
    assert _lines([line, reference, next_light]) == (line, next_light)


def test_a_light_that_is_passed_twice_has_two_lines() -> None:
    first, again = light("4", 100.0), light("4", 100.0 + SAME_LINE_M)
    assert _lines([first, again]) == (first, again)


@pytest.fixture(scope="module")
def town() -> carla.Map:
    return carla.Map("Crossing", crossing())


def through(*points: tuple[float, ...], stops: tuple[tuple[float, float], ...] = ()) -> RouteDescription:
    """A route through (x, y) or (x, y, yaw in degrees)."""
    return RouteDescription(
        id="r",
        town="Crossing",
        points=tuple(RoutePoint(p[0], p[1], 0.0, math.radians(p[2]) if len(p) > 2 else None) for p in points),
        stops=tuple(
            StopMark(id=str(n), name=f"stop {n}", point=RoutePoint(x, y, 0.0)) for n, (x, y) in enumerate(stops)
        ),
        source="a test",
    )


def test_a_right_turn_is_joined_along_the_lanes(town: carla.Map) -> None:
    # from the east inbound (y -1.75: the right-hand lane towards the west) to the north outbound
    route = plan(town, through((50.0, -1.75), (1.75, -40.0)))
    assert route.length_m == pytest.approx(40.0 + 8.25 * math.pi / 2.0 + 30.0, abs=0.5)
    assert np.allclose(route.points_m[0, :2], (50.0, -1.75), atol=1.1)
    assert np.allclose(route.points_m[-1, :2], (1.75, -40.0), atol=1.1)
    assert route.is_junction.any()
    assert len(route.waypoints) == len(route.s_m) == len(route.points_m)


def test_points_are_about_a_metre_apart_and_never_double(town: carla.Map) -> None:
    spacing_m = np.diff(plan(town, through((50.0, -1.75), (-60.0, -1.75))).s_m)
    assert spacing_m.min() > 0.3
    assert spacing_m.max() < 1.3


def test_the_yaw_of_each_point_is_the_direction_of_travel(town: carla.Map) -> None:
    route = plan(town, through((50.0, -1.75), (1.75, -40.0)))
    along = np.diff(route.points_m[:, :2], axis=0)
    heading_rad = np.arctan2(along[:, 1], along[:, 0])
    off_rad = np.angle(np.exp(1j * (heading_rad - route.yaw_rad[:-1])))
    assert np.abs(off_rad).max() < math.radians(6.0)


@pytest.mark.parametrize("off_m", [-2.0, -1.0, 0.0, 1.0, 2.4])
def test_points_metres_off_do_not_put_the_route_into_the_oncoming_lane(town: carla.Map, off_m: float) -> None:
    # 2.4 m to the left of the lane's middle lies nearer to the middle of the oncoming lane
    route = plan(town, through((50.0, -1.75 + off_m), (20.0, -1.75 + off_m), (1.75 + off_m, -40.0)))
    assert np.allclose(route.points_m[0, :2], (50.0, -1.75), atol=1.1)
    assert route.length_m < 90.0


def test_a_point_in_the_crossing_belongs_to_the_turn_that_is_driven(town: carla.Map) -> None:
    for inside in ((4.2, -4.2), (3.0, -2.5), (6.8, -2.4)):
        route = plan(town, through((50.0, -1.75), inside, (1.75, -40.0)))
        assert route.length_m == pytest.approx(83.0, abs=1.0)


def test_the_yaw_of_the_file_decides_between_the_lanes(town: carla.Map) -> None:
    route = plan(town, through((20.0, 0.0, 0.0), (60.0, 0.0, 0.0)))
    assert np.allclose(route.points_m[:, 1], 1.75)  # eastbound: the southern lane
    route = plan(town, through((60.0, 0.0, 180.0), (20.0, 0.0, 180.0)))
    assert np.allclose(route.points_m[:, 1], -1.75)


def test_lane_sections_within_a_road_are_driven_through() -> None:
    town = carla.Map("Crossing", crossing(sections=3))
    route = plan(town, through((65.0, -1.75), (-65.0, -1.75)))
    assert route.length_m == pytest.approx(130.0, abs=2.0)
    assert np.diff(route.s_m).max() < 1.3


def test_the_limit_holds_on_through_the_junction(town: carla.Map) -> None:
    route = plan(town, through((50.0, -1.75), (1.75, -40.0)))
    assert np.allclose(route.speed_limit_mps, 25.0 * 0.44704)


def test_the_signs_of_the_route_are_found_where_their_lines_are(town: carla.Map) -> None:
    (sign,) = plan(town, through((1.75, 50.0), (1.75, -40.0))).controls  # northbound: the southern street's stop sign
    assert sign.kind is ControlKind.STOP_SIGN
    assert sign.landmark_id == "103"
    assert sign.s_m == pytest.approx(39.0, abs=1.0)
    assert (sign.x_m, sign.y_m) == pytest.approx((1.75, 11.0), abs=0.01)
    assert sign.yaw_rad == pytest.approx(-math.pi / 2.0)


def test_signs_of_the_oncoming_lane_are_not_the_routes(town: carla.Map) -> None:
    (sign,) = plan(town, through((50.0, -1.75), (1.75, -40.0))).controls  # leaves by the northern street, its sign too
    assert (sign.kind, sign.landmark_id) == (ControlKind.YIELD_SIGN, "100")


def test_service_stops_are_found_along_the_route(town: carla.Map) -> None:
    route = plan(town, through((50.0, -1.75), (-50.0, -1.75), stops=((30.0, -4.0), (-20.0, -4.0))))
    assert [round(stop.s_m) for stop in route.stops] == [20, 70]


def test_stops_out_of_order_are_refused_in_a_sentence(town: carla.Map) -> None:
    with pytest.raises(UserError, match=r"stop 'stop 1' .* m from the route where it is due"):
        plan(town, through((50.0, -1.75), (-50.0, -1.75), stops=((-20.0, -4.0), (30.0, -4.0))))


def test_a_point_off_the_road_is_refused_with_its_number_and_distance(town: carla.Map) -> None:
    with pytest.raises(UserError, match=r"route 'r' in a test: point 2 \(30.0, -12.0\) lies 10.2 m from the nearest"):
        plan(town, through((50.0, -1.75), (30.0, -12.0), (1.75, -40.0)))


def test_a_way_that_does_not_exist_is_refused_in_a_sentence(town: carla.Map) -> None:
    with pytest.raises(UserError, match=r"no way along the lanes leads from point 1 \(20.0, -1.8\) to point 2"):
        plan(town, through((20.0, -1.75, 180.0), (50.0, -1.75, 180.0)))  # back the way it came, without a turning place


def test_points_that_fall_together_are_refused_in_a_sentence(town: carla.Map) -> None:
    with pytest.raises(UserError, match="has no length"):
        plan(town, through((50.0, -1.75, 180.0), (50.0, -1.75, 180.0)))


def test_the_same_file_gives_the_same_route(town: carla.Map) -> None:
    first, second = (plan(town, through((50.0, -1.75), (1.75, -40.0))) for _ in range(2))
    assert first.points_m.tobytes() == second.points_m.tobytes()
    assert first.controls == second.controls
