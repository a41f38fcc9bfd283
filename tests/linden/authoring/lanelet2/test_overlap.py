"""Claims about the overlap of two polygons, with shapely as the judge."""

import numpy as np
import pytest
from shapely import Polygon

from linden.authoring.lanelet2.overlap import area_m2, overlap_share

SQUARE = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])


@pytest.mark.parametrize(("shift", "share"), [((0, 0), 1.0), ((1, 0), 0.5), ((1, 1), 0.25), ((2, 0), 0.0), ((9, 9), 0)])
def test_the_share_of_a_square_in_a_shifted_one(shift: tuple[float, float], share: float) -> None:
    assert overlap_share(SQUARE, SQUARE + shift) == pytest.approx(share, abs=1e-9)


def test_the_share_is_of_the_first_ring() -> None:
    small = 0.5 * SQUARE
    assert overlap_share(small, SQUARE) == pytest.approx(1.0)
    assert overlap_share(SQUARE, small) == pytest.approx(0.25)


def test_a_ring_without_area_has_no_share() -> None:
    assert overlap_share(np.zeros((3, 2)), SQUARE) == 0.0


def _bent_lane(draw: np.random.Generator) -> np.ndarray:
    """A lane of 3.2 m along an arc, far from the origin, as a ring."""
    radius, start, turn = draw.uniform(6.0, 40.0), draw.uniform(0.0, 6.3), draw.uniform(0.2, 1.8)
    angle = start + np.linspace(0.0, turn, 12)
    sides = [np.column_stack([r * np.cos(angle), r * np.sin(angle)]) for r in (radius, radius + 3.2)]
    middle = np.concatenate(sides).mean(axis=0)
    return np.concatenate([sides[0], sides[1][::-1]]) - middle + draw.uniform(-4.0, 4.0, 2) + (5000.0, -7000.0)


def test_lanes_that_cross_overlap_as_much_as_shapely_finds() -> None:
    draw = np.random.default_rng(15)
    met = 0
    for _ in range(200):
        one, other = _bent_lane(draw), _bent_lane(draw)
        exact = Polygon(one).intersection(Polygon(other)).area / Polygon(one).area
        assert overlap_share(one, other) == pytest.approx(exact, abs=5e-3)
        assert area_m2(one) == pytest.approx(Polygon(one).area)
        met += exact > 0.01
    assert met > 100
