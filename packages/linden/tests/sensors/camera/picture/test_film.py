"""From light to bytes."""

import numpy as np
import pytest

from linden.protocol.values.episode import CLEAR_NOON
from linden.sensors.camera.picture.atmosphere import air
from linden.sensors.camera.picture.film import (
    bloom,
    bloom_weights,
    curve,
    developed,
    exposure,
    filmic,
    white_balance,
)
from linden.sensors.camera.spec import CameraSpec, Film

NOON = air(CLEAR_NOON, 0.0)
SPEC = CameraSpec(width_px=16, height_px=8)


def test_the_film_keeps_middle_grey_and_never_darkens_what_is_brighter() -> None:
    assert filmic(np.array([0.18])) == pytest.approx([0.18], abs=0.01)
    shown = filmic(np.geomspace(1e-4, 100.0, 400))
    assert (np.diff(shown) >= 0.0).all()
    assert shown[0] < 0.01
    assert shown[-1] == 1.0


def test_without_effects_light_goes_through_gamma_alone() -> None:
    table = curve(Film(postprocess=False, gamma=2.0))
    light = np.linspace(0.0, np.sqrt(8.0), 4096) ** 2
    assert table == pytest.approx(np.clip(255.0 * np.sqrt(np.clip(light, 0.0, 1.0)), 0, 255), abs=0.51)


def test_a_stop_of_compensation_doubles_the_light() -> None:
    assert exposure(Film(compensation_stops=1.0), NOON) == pytest.approx(2.0 * exposure(Film(), NOON))


@pytest.mark.parametrize("film", [Film(manual=True, shutter_hz=100.0), Film(manual=True, iso=200.0)])
def test_twice_the_time_or_the_sensitivity_is_twice_the_light(film: Film) -> None:
    assert exposure(film, NOON) == pytest.approx(2.0 * exposure(Film(manual=True), NOON))


def test_the_automatic_exposure_makes_up_for_a_part_of_the_night() -> None:
    night = air(CLEAR_NOON._replace(sun_altitude_angle=-90.0), 0.0)
    assert exposure(Film(), night) > 5.0 * exposure(Film(), NOON)
    assert exposure(Film(manual=True), night) == exposure(Film(manual=True), NOON)


def test_a_film_for_candlelight_makes_daylight_blue() -> None:
    red, _, blue = white_balance(Film(temperature_k=3000.0))
    assert red < 1.0 < blue
    assert white_balance(Film()).tolist() == [1.0, 1.0, 1.0]


def test_a_bright_spot_spreads_and_an_ordinary_picture_does_not() -> None:
    light = np.full((SPEC.width_px * SPEC.height_px, 3), 0.5, np.float32)
    one = np.ones(3, np.float32)
    assert not bloom(SPEC, Film(), light, one).any()
    light[0] = 50.0
    spread = bloom(SPEC, Film(), light, one)
    assert spread[0, 0, 0] > spread[0, 1, 0] > spread[0, 2, 0] > 0.0


def test_a_tenth_of_what_is_too_bright_spreads() -> None:
    assert np.prod([weights.sum() for weights in bloom_weights(Film())]) == pytest.approx(0.10)
    assert not bloom_weights(Film(postprocess=False))[1].any()


def test_bytes_are_in_the_order_of_the_wire() -> None:
    light = np.zeros((SPEC.width_px * SPEC.height_px, 3), np.float32)
    light[:, 0] = 1.0  # red
    image = developed(SPEC, Film(bloom=0.0), light, NOON)
    assert image.shape == (8, 16, 4)
    assert (image[:, :, 2] > 150).all()
    assert not image[:, :, :2].any()
    assert (image[:, :, 3] == 255).all()
