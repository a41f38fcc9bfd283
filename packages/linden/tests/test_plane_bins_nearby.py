"""What is near a place is found as if everything were compared with everything."""

import numpy as np
import pytest

from linden.plane_bins import nearby


@pytest.mark.parametrize("seed", range(3))
def test_it_agrees_with_comparing_all_with_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places, things = rng.uniform(-50.0, 50.0, (300, 2)), rng.uniform(-50.0, 50.0, (200, 2))
    reach = rng.uniform(0.0, 6.0, 200)
    away = np.hypot(*np.moveaxis(places[:, None] - things[None], 2, 0))
    expected = (away < reach).any(axis=1)
    assert 0 < expected.sum() < 300
    np.testing.assert_array_equal(nearby(places, things, reach), expected)
    np.testing.assert_array_equal(nearby(places, things, 2.0), (away < 2.0).any(axis=1))


def test_nothing_is_near_where_there_is_nothing() -> None:
    assert not nearby(np.zeros((3, 2)), np.empty((0, 2)), 5.0).any()
    assert len(nearby(np.empty((0, 2)), np.zeros((3, 2)), 5.0)) == 0
