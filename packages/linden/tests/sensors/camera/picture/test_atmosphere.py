"""Light and air by the weather."""

import numpy as np
import pytest

from linden.protocol.values.episode import CLEAR_NOON, WeatherParameters
from linden.sensors.camera.picture.atmosphere import air, brightness, sunlight


def test_the_sun_reddens_and_fades_as_it_sets_and_is_gone_by_night() -> None:
    high, low = sunlight(60.0), sunlight(3.0)
    assert (low < high).all()
    assert low[0] / low[2] > 2.0 * high[0] / high[2]
    assert not sunlight(-1.0).any()


def test_sunlight_through_one_air_mass_is_what_beer_and_lambert_say() -> None:
    assert sunlight(90.0) == pytest.approx(np.array([2.30, 2.28, 2.33]) * np.exp([-0.10, -0.175, -0.335]), rel=1e-3)


@pytest.mark.parametrize("height_deg", [-90.0, -45.0, -20.0, 5.0, 20.0, 45.0, 90.0])
def test_thick_clouds_take_light_from_the_ground_by_day_and_by_night(height_deg: float) -> None:
    clear = CLEAR_NOON._replace(sun_altitude_angle=float(height_deg), cloudiness=0.0)
    thick = clear._replace(cloudiness=100.0, precipitation=80.0)
    assert brightness(air(thick, 0.0)) <= brightness(air(clear, 0.0))


def test_the_lower_the_sun_the_darker_the_ground() -> None:
    levels = [brightness(air(CLEAR_NOON._replace(sun_altitude_angle=float(h)), 0.0)) for h in range(-20, 91, 5)]
    assert levels == sorted(levels)


def test_weather_left_to_the_map_is_a_clear_noon() -> None:
    left = air(WeatherParameters(*([-1.0] * 14)), 0.0)
    assert left.sun_z > 0.6
    assert brightness(left) == pytest.approx(brightness(air(CLEAR_NOON, 0.0)), rel=0.1)


def test_the_direction_to_the_sun_has_length_one_and_clouds_drift_with_wind_and_time() -> None:
    still, later = (air(CLEAR_NOON._replace(wind_intensity=50.0), now_s) for now_s in (0.0, 60.0))
    assert np.hypot(np.hypot(still.sun_x, still.sun_y), still.sun_z) == pytest.approx(1.0)
    assert still.cloud_shift_m == 0.0 < later.cloud_shift_m


def test_no_weather_gives_a_number_that_is_none() -> None:
    for value in (0.0, 100.0, 1e6):
        for height in (-90.0, 0.0, 90.0):
            made = air(WeatherParameters(*([value] * 14))._replace(sun_altitude_angle=height), 1.0)
            assert np.isfinite(np.concatenate([np.ravel(field) for field in made])).all()


def test_fog_spreads_the_suns_light_over_the_sky() -> None:
    clear, foggy = air(CLEAR_NOON, 0.0), air(CLEAR_NOON._replace(fog_density=60.0), 0.0)
    assert max(foggy.sun) < 0.1 * max(clear.sun)
    assert min(foggy.above) > 1.3 * min(clear.above)
    assert brightness(foggy) > 0.4 * brightness(clear)
