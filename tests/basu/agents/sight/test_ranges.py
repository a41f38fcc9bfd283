"""Claims about how far actors are seen by light and weather."""

import math

import carla
import pytest

from basu.agents.sight.ranges import LAMPS_M, LOW_BEAM_M, SUNSET_M, air_range_m, light_range_m, ranges_m


def test_by_day_light_sets_no_limit() -> None:
    assert light_range_m(0.0, lamps=False) == light_range_m(45.0, lamps=True) == math.inf


@pytest.mark.parametrize(
    ("sun_deg", "unlit_m", "lamps_m"),
    [
        pytest.param(-1e-9, SUNSET_M, SUNSET_M, id="sunset"),
        pytest.param(-3.0, 96.4, 215.5, id="dusk"),
        pytest.param(-6.0, LOW_BEAM_M, LAMPS_M, id="end of civil twilight"),
        pytest.param(-90.0, LOW_BEAM_M, LAMPS_M, id="night"),
    ],
)
def test_the_range_falls_from_sunset_to_the_dark(sun_deg: float, unlit_m: float, lamps_m: float) -> None:
    assert light_range_m(sun_deg, lamps=False) == pytest.approx(unlit_m, abs=0.1)
    assert light_range_m(sun_deg, lamps=True) == pytest.approx(lamps_m, abs=0.1)


def test_contrast_falls_to_five_percent_at_the_optical_range() -> None:
    weather = carla.WeatherParameters(fog_density=100.0, fog_distance=0.0, precipitation=0.0)
    assert math.exp(-(0.07 + 1e-4) * air_range_m(weather)) == pytest.approx(0.05)
    assert air_range_m(weather) == pytest.approx(42.7, abs=0.1)


def test_fog_that_begins_farther_off_hides_less() -> None:
    near, far = (carla.WeatherParameters(fog_density=60.0, fog_distance=away_m) for away_m in (0.0, 30.0))
    assert air_range_m(far) - air_range_m(near) == pytest.approx(30.0)


def test_in_a_foggy_night_the_shorter_range_counts() -> None:
    weather = carla.WeatherParameters(cloudiness=10.0, fog_density=100.0, fog_distance=0.0, sun_altitude_angle=-90.0)
    assert ranges_m(weather) == (LOW_BEAM_M, pytest.approx(air_range_m(weather)))


def test_the_weather_that_is_left_to_the_map_is_a_clear_day() -> None:
    assert ranges_m(carla.WeatherParameters.Default) == (math.inf, math.inf)
