"""Claims about what is felt: closed forms of mechanics at places in the vehicle, on slopes and in bends."""

import math

import numpy as np
import pytest

from basu.metrics.passengers.felt import GRAVITY_MPS2, PassengerPlace, felt
from basu.metrics.passengers.filters import lowpass, moving_mean
from fakes.drives import STEP_S
from fakes.rides import braked, circling, eastward, ride

MIDDLE = PassengerPlace(0.0, 0.0, 0.0)


def test_an_even_braking_is_felt_as_it_is_everywhere_in_the_vehicle() -> None:
    history = ride(6.0, eastward(braked(6.0, 1.0, 1.5), 6.0))
    for place in (MIDDLE, PassengerPlace(1.0, -0.5, 0.3)):
        sensed = felt(history, place)
        assert sensed is not None
        assert sensed.along_mps2[25:95] == pytest.approx(-1.5, abs=1e-9)
        assert sensed.across_mps2 == pytest.approx(0.0, abs=1e-9)
        assert sensed.filtered_along_mps2[60] == pytest.approx(-1.5, abs=1e-3)


@pytest.mark.parametrize(("forward_m", "right_m"), [(0.0, 0.0), (1.5, 0.0), (0.0, 0.8), (-1.5, -0.8)])
def test_in_a_steady_bend_the_place_turns_about_the_bends_middle(forward_m: float, right_m: float) -> None:
    """a = w^2 r towards the middle, which lies ``radius`` to the right of the origin."""
    radius_m, speed_mps = 12.0, 4.0
    sensed = felt(ride(10.0, circling(radius_m, speed_mps)), PassengerPlace(forward_m, right_m, 0.0))
    assert sensed is not None
    turning_radps = speed_mps / radius_m
    assert sensed.across_mps2[5:-5] == pytest.approx(turning_radps**2 * (radius_m - right_m), rel=1e-3)
    assert sensed.along_mps2[5:-5] == pytest.approx(-(turning_radps**2) * forward_m, abs=2e-3)


def test_a_vehicle_that_begins_to_turn_swings_its_nose_sideways() -> None:
    """On the spot, yaw 0.5 a t^2: across = a x at a place x ahead, along = -a y at one y to the right."""
    sensed = felt(ride(2.0, lambda t_s: {"yaw_rad": 0.5 * 0.2 * t_s**2}), PassengerPlace(2.0, 1.0, 0.0))
    assert sensed is not None
    t_s = sensed.t_s[10] - STEP_S / 2.0
    assert sensed.across_mps2[10] == pytest.approx(0.2 * 2.0 - (0.2 * t_s) ** 2 * 1.0, abs=2e-3)
    assert sensed.along_mps2[10] == pytest.approx(-0.2 * 1.0 - (0.2 * t_s) ** 2 * 2.0, abs=2e-3)


def test_a_slope_pushes_though_nothing_moves() -> None:
    uphill = felt(ride(2.0, lambda _: {"pitch_rad": 0.1}))
    tilted = felt(ride(2.0, lambda _: {"roll_rad": 0.1}))
    assert uphill is not None
    assert tilted is not None
    assert uphill.along_mps2 == pytest.approx(GRAVITY_MPS2 * math.sin(0.1))  # as if speeding up
    assert tilted.across_mps2 == pytest.approx(
        -GRAVITY_MPS2 * math.sin(0.1)
    )  # the right side is low: pushed to the left
    assert uphill.up_mps2 == pytest.approx(GRAVITY_MPS2 * (math.cos(0.1) - 1.0))


def test_free_fall_is_felt_as_weightlessness() -> None:
    sensed = felt(ride(1.0, lambda t_s: {"velocity_z_mps": -GRAVITY_MPS2 * t_s}))
    assert sensed is not None
    assert sensed.up_mps2 == pytest.approx(-GRAVITY_MPS2)


def test_the_jerk_of_an_even_onset_is_its_slope() -> None:
    """Braking that grows by 1 m/s³ for two seconds: v = 10 - t^2 / 2."""
    sensed = felt(
        ride(5.0, eastward(lambda t: 10.0 - 0.5 * max(0.0, min(t - 1.0, 2.0)) ** 2 - 2.0 * max(0.0, t - 3.0), 5.0))
    )
    assert sensed is not None
    assert sensed.jerk_along_mps3[45] == pytest.approx(-1.0, abs=0.02)


def test_three_frames_are_too_few_to_feel_anything() -> None:
    assert felt(ride(0.15, eastward(lambda _: 1.0, 1.0))) is None


@pytest.mark.parametrize("frequency_hz", [0.5, 1.0, 2.0])
def test_the_filter_has_the_gain_of_its_formula(frequency_hz: float) -> None:
    t_s = np.arange(0.0, 60.0, STEP_S)
    out = lowpass(np.sin(2.0 * math.pi * frequency_hz * t_s), STEP_S)[600:]
    s = 1j * frequency_hz / 2.0
    expected = abs((1.0 + s) / (1.0 + s / 0.63 + s * s)) / math.sqrt(2.0)
    assert np.sqrt(np.mean(out**2)) == pytest.approx(expected, rel=0.01)


def test_the_filter_keeps_a_lasting_push_and_answers_a_sudden_one_by_at_most_six_per_cent_too_much() -> None:
    out = lowpass(np.repeat([0.0, 1.0], [20, 100]), STEP_S)
    assert out[-1] == pytest.approx(1.0)
    assert 1.05 < out.max() < 1.065


def test_a_moving_mean_is_over_fewer_at_the_ends() -> None:
    assert moving_mean(np.array([1.0, 2.0, 6.0]), 3).tolist() == [1.5, 3.0, 4.0]
