"""Noise: repeatable, independent of who listened, and different where it should be."""

import numpy as np
import pytest

from linden.sensors.devices.noise import BLOCK, _block, gaussian


def test_the_same_seed_and_number_give_the_same_bytes() -> None:
    first = gaussian(3, 17, [1.0, 2.0])
    _block.cache_clear()
    assert gaussian(3, 17, [1.0, 2.0]) == first


@pytest.mark.parametrize(("seed", "number"), [(3, 18), (3, 17 + BLOCK), (4, 17), (17, 3), (-3, 17)])
def test_another_seed_or_number_gives_other_noise(seed: int, number: int) -> None:
    assert gaussian(seed, number, [1.0])[0] != gaussian(3, 17, [1.0])[0]


def test_a_deviation_scales_its_own_draw_and_no_other() -> None:
    whole = gaussian(1, 1, [1.0, 1.0, 1.0])
    assert gaussian(1, 1, [2.0, 0.0, 1.0]) == (2.0 * whole[0], 0.0, whole[2])


def test_without_deviation_there_is_no_noise() -> None:
    assert gaussian(1, 1, [0.0, 0.0]) == (0.0, 0.0)


def test_neighbouring_numbers_are_not_related() -> None:
    draws = np.array([gaussian(5, number, [1.0])[0] for number in range(4000)])
    assert abs(np.corrcoef(draws[1:], draws[:-1])[0, 1]) < 4.0 / np.sqrt(4000)
    assert abs(draws.mean()) < 4.0 / np.sqrt(4000)
    assert (np.abs(draws) > 1.96).mean() == pytest.approx(0.05, abs=0.014)  # four deviations of that share
