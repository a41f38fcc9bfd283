"""Tests of ``basu_leaderboard.global_plan``."""

import enum
import math
import sys
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

from basu_leaderboard.global_plan import Gps, Place, global_plan, reference, road_options
from basu_leaderboard.provided.planned_agent import RoadOption
from fakes.one_road import OPENDRIVE, one_road


@pytest.fixture(scope="module")
def town() -> carla.Map:
    return one_road()


def theirs(at: carla.Location, latitude: float, longitude: float) -> tuple[float, float]:
    """Spherical Mercator the plain way: degrees to metres, the metres added, back to degrees."""
    radius_m, scale = 6378137.0, math.cos(latitude * math.pi / 180.0)
    east_m = scale * radius_m * longitude * math.pi / 180.0 + at.x
    north_m = scale * radius_m * math.log(math.tan((90.0 + latitude) * math.pi / 360.0)) - at.y
    return (
        360.0 * math.atan(math.exp(north_m / (radius_m * scale))) / math.pi - 90.0,
        east_m * 180.0 / (math.pi * radius_m * scale),
    )


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (500.0, -300.0, 2.0), (-900.0, 1200.0, -3.0)])
def test_a_place_is_where_the_leaderboard_has_it(town: carla.Map, at: tuple[float, float, float]) -> None:
    place = Gps(town).place(carla.Location(*at))
    assert place[:2] == pytest.approx(theirs(carla.Location(*at), 39.99, -82.98), abs=1e-10)
    assert place.altitude_m == at[2]


def test_north_is_up(town: carla.Map) -> None:
    gps = Gps(town)
    assert gps.place(carla.Location(0.0, -10.0)).latitude > gps.place(carla.Location()).latitude


@pytest.mark.parametrize("at", [(0.0, 0.0), (700.0, -650.0), (-1500.0, 2400.0)])
def test_a_fix_without_noise_is_the_place_of_the_plan(town: carla.Map, at: tuple[float, float]) -> None:
    gps, where = Gps(town), carla.Location(*at, 4.0)
    fix = town.transform_to_geolocation(where)
    corrected = gps.measured(np.array([fix.latitude, fix.longitude, 4.0]))
    assert corrected == pytest.approx(np.array(gps.place(where)), abs=2e-7)  # 2 cm: CARLA's locations are float32


def test_noise_of_a_metre_stays_a_metre(town: carla.Map) -> None:
    gps = Gps(town)
    still, off = (gps.measured(np.array([39.99 + error, -82.98, 0.0])) for error in (0.0, 1e-5))
    assert abs(off[0] - still[0]) == pytest.approx(1e-5, rel=0.01)


def test_a_simulator_that_agrees_already_is_left_as_it_is(town: carla.Map) -> None:
    gps = Gps(town)
    agreeing: Any = SimpleNamespace(
        to_opendrive=lambda: OPENDRIVE,
        transform_to_geolocation=lambda at: SimpleNamespace(
            latitude=gps.place(at).latitude, longitude=gps.place(at).longitude
        ),
    )
    fix = np.array([39.9931, -82.9765, 1.0])
    assert Gps(agreeing).measured(fix) == pytest.approx(fix, abs=2e-7)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("<geoReference>+proj=tmerc +lat_0=1.5 +lon_0=-2e1 +k=1</geoReference>", (1.5, -20.0)),
        ("<geoReference>+lat_0=-33.25</geoReference>", (-33.25, 2.0)),
        ("<OpenDRIVE/>", (42.0, 2.0)),
    ],
)
def test_a_map_says_where_it_lies_or_lies_where_the_leaderboard_puts_it(text: str, found: tuple[float, float]) -> None:
    assert reference(text) == found


FOLLOW = RoadOption.LANEFOLLOW


def crossing(turn_deg: float, before: int = 3, inside: int = 4, after: int = 3) -> list[int]:
    """The options of a way through one junction that turns evenly inside of it."""
    inner = np.linspace(0.0, turn_deg, inside + 1)[1:]
    yaw_deg = np.concatenate([np.zeros(before), inner, np.full(after, turn_deg)])
    is_junction = np.array([False] * before + [True] * inside + [False] * after)
    options: list[int] = road_options(np.radians(yaw_deg), is_junction).tolist()
    return options


@pytest.mark.parametrize(
    ("turn_deg", "option"),
    [
        (0.0, RoadOption.STRAIGHT),
        (34.0, RoadOption.STRAIGHT),
        (-34.0, RoadOption.STRAIGHT),
        (36.0, RoadOption.RIGHT),
        (90.0, RoadOption.RIGHT),
        (-90.0, RoadOption.LEFT),
        (-140.0, RoadOption.LEFT),
    ],
)
def test_a_junction_is_crossed_by_the_turn_it_makes(turn_deg: float, option: RoadOption) -> None:
    assert crossing(turn_deg) == [FOLLOW] * 3 + [option] * 4 + [FOLLOW] * 3


def test_a_turn_over_the_seam_of_yaw_is_no_turn_back() -> None:
    yaw_rad = np.array([math.radians(170.0), math.radians(-175.0), math.radians(-100.0)])
    assert road_options(yaw_rad, np.array([False, True, True])).tolist() == [FOLLOW, RoadOption.RIGHT, RoadOption.RIGHT]


def test_an_actor_that_begins_in_a_junction_follows_the_lane() -> None:
    assert crossing(90.0, before=0) == [FOLLOW] * 7


def test_a_plan_may_end_in_a_junction() -> None:
    assert crossing(-90.0, after=0) == [FOLLOW] * 3 + [RoadOption.LEFT] * 4


class Degrees:
    """Of a flat earth."""

    def place(self, at: carla.Location) -> Place:
        return Place(40.0 - at.y / 1e5, -74.0 + at.x / 1e5, at.z)


def route(count: int = 3) -> Any:
    waypoints = [
        SimpleNamespace(transform=carla.Transform(carla.Location(float(x_m), 2.0, 0.5))) for x_m in range(count)
    ]
    return SimpleNamespace(yaw_rad=np.zeros(count), is_junction=np.zeros(count, bool), waypoints=waypoints)


def test_both_forms_say_the_same_place() -> None:
    plan = global_plan(route(), Degrees())
    assert [pose.location.x for pose, _ in plan.world] == [0.0, 1.0, 2.0]
    assert plan.gps[2][0] == {"lat": pytest.approx(39.99998), "lon": pytest.approx(-73.99998), "z": 0.5}
    assert {option for _, option in (*plan.gps, *plan.world)} == {RoadOption.LANEFOLLOW}


def test_options_are_carlas_own_where_an_agent_has_loaded_them(monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = enum.IntEnum("RoadOption", {option.name: option.value for option in RoadOption})
    monkeypatch.setitem(sys.modules, "agents.navigation.local_planner", SimpleNamespace(RoadOption=theirs))
    assert isinstance(global_plan(route(), Degrees()).world[0][1], theirs)
