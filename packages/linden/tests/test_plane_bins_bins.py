"""Bins of the plane: whatever lies around a point is found, and every circle is in every bin it may touch."""

import numpy as np
import pytest

from linden.plane_bins import BIN_M, bins_of, items_near

RANDOM = np.random.default_rng(20)


@pytest.mark.parametrize("count", [0, 1, 2, 300])
def test_what_a_square_touches_is_found_near_it(count: int) -> None:
    centres, radii = RANDOM.uniform(-200.0, 300.0, (count, 2)), RANDOM.uniform(0.01, 20.0, count)
    bins = bins_of(centres, radii)
    for x, y in RANDOM.uniform(-250.0, 350.0, (50, 2)):
        apart = np.abs(centres - (x, y)).max(axis=1) if count else np.empty(0)
        found = items_near(bins, x, y, 5.0)
        assert set(np.flatnonzero(apart <= 5.0 + radii)) <= set(found)
        assert (np.diff(found) > 0).all()
        assert not count or (apart[found] <= 5.0 + radii[found] + 2.0 * BIN_M).all()


def test_things_of_a_bin_stand_in_their_order() -> None:
    bins = bins_of(RANDOM.uniform(0.0, 60.0, (100, 2)), np.full(100, 12.0))
    for begin, end in zip(bins.start[:-1], bins.start[1:], strict=True):
        assert (np.diff(bins.items[begin:end]) > 0).all()


def test_a_few_things_far_apart_do_not_take_all_memory() -> None:
    bins = bins_of(np.array([[0.0, 0.0], [1e7, 1e7]]), np.ones(2))
    assert len(bins.start) < 1_100_000
    assert items_near(bins, 1e7, 1e7, 1.0).tolist() == [1]
