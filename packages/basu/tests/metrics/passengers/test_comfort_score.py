"""Claims about vibration: the standard's figures for motions with a known weighting."""

import math

import numpy as np
import pytest

from basu.metrics.passengers.comfort_score import reactions, vibration
from basu.metrics.passengers.felt import Felt, felt
from fakes.drives import STEP_S
from fakes.rides import eastward, ride


def shaken(frequency_hz: float, size_mps2: float, axis: str = "x", seconds: float = 60.0) -> Felt:
    """A floor that shakes in a sine of this size along one axis, from a first step without a push."""
    w = 2.0 * math.pi * frequency_hz
    found = felt(ride(seconds, lambda t: {f"velocity_{axis}_mps": -size_mps2 / w * math.cos(w * (t - STEP_S / 2.0))}))
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("axis", "frequency_hz", "factor"),
    [("x", 1.0, 1.011), ("x", 0.5, 0.853), ("x", 4.0, 0.512), ("y", 1.0, 1.011), ("z", 4.0, 0.967), ("z", 1.0, 0.482)],
)
def test_a_sine_of_1_weighs_its_factor_over_the_root_of_2(axis: str, frequency_hz: float, factor: float) -> None:
    """Factors of ISO 2631-1, table 3. A step's mean acceleration is a sine's times sinc(f dt)."""
    found = vibration(shaken(frequency_hz, 1.0, axis))
    expected = factor / math.sqrt(2.0) * float(np.sinc(frequency_hz * 0.05))
    of_axis = {"x": found.along_mps2, "y": found.across_mps2, "z": found.up_mps2}
    assert of_axis.pop(axis) == pytest.approx(expected, rel=0.015)
    assert max(of_axis.values()) < 0.01 * expected
    assert found.total_mps2 == pytest.approx(expected, rel=0.015)


def test_the_worst_second_of_an_even_shaking_is_its_rms() -> None:
    found = vibration(shaken(1.0, 1.0))
    assert found.transient_mps2 == pytest.approx(found.total_mps2, rel=0.07)  # the filters answer its beginning
    assert found.crest_factor == pytest.approx(math.sqrt(2.0), rel=0.1)
    assert found.dose_mps175 == pytest.approx(found.total_mps2 * math.sqrt(2.0) * (3.0 / 8.0 * 60.0) ** 0.25, rel=0.03)


def test_a_shock_in_a_calm_ride_shows_in_the_worst_second_and_the_crest() -> None:
    calm = felt(ride(120.0, eastward(lambda t: 5.0 - 3.0 * float(np.clip(t - 60.0, 0.0, 1.0)), 121.0)))
    assert calm is not None
    found = vibration(calm)
    assert found.transient_mps2 > 5.0 * found.total_mps2
    assert found.crest_factor > 9.0


def test_heaving_slowly_makes_sick_and_shaking_fast_does_not() -> None:
    slow, fast = vibration(shaken(0.2, 0.5, "z")), vibration(shaken(4.0, 0.5, "z"))
    assert slow.sickness_dose_mps15 == pytest.approx(0.5 / math.sqrt(2.0) * 0.992 * math.sqrt(60.0), rel=0.1)
    assert fast.sickness_dose_mps15 < 0.02 * slow.sickness_dose_mps15


@pytest.mark.parametrize(
    ("total_mps2", "names"),
    [
        (0.1, ("not uncomfortable",)),
        (0.4, ("a little uncomfortable",)),
        (0.55, ("a little uncomfortable", "fairly uncomfortable")),
        (0.9, ("fairly uncomfortable", "uncomfortable")),
        (2.2, ("very uncomfortable", "extremely uncomfortable")),
        (9.0, ("extremely uncomfortable",)),
    ],
)
def test_reactions_are_those_of_annex_c(total_mps2: float, names: tuple[str, ...]) -> None:
    assert reactions(total_mps2) == names
