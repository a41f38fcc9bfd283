"""Claims about degrees: the leaderboard's own formula, and CARLA's measurements brought into agreement with it."""

import math
from types import SimpleNamespace
from typing import Any

import carla
import numpy as np
import pytest

from basu.agents.leaderboard.gps import Gps, reference
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
