"""Claims about the overlap of two polygons, with a fine grid of points as the judge."""

import numpy as np
import pytest

from linden_maps.lanelet2.overlap import area_m2, overlap_m2, overlap_share

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


def _inside(ring: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return whether points (N, 2) lie in a ring: a ray to the east crosses it an odd number of times."""
    (x, y), inside = points.T, np.zeros(len(points), bool)
    for (x1, y1), (x2, y2) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if y1 != y2:
            inside ^= ((y1 > y) != (y2 > y)) & (x < x1 + (y - y1) * (x2 - x1) / (y2 - y1))
    return inside


def test_lanes_that_cross_overlap_as_much_as_points_of_a_grid_find() -> None:
    draw = np.random.default_rng(15)
    met = 0
    for _ in range(200):
        one, other = _bent_lane(draw), _bent_lane(draw)
        sides = [np.linspace(one[:, axis].min(), one[:, axis].max(), 450) for axis in (0, 1)]
        points = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
        in_one = _inside(one, points)
        counted = (in_one & _inside(other, points)).sum() / in_one.sum()
        assert overlap_share(one, other) == pytest.approx(counted, abs=5e-3)
        assert area_m2(one) == pytest.approx(in_one.mean() * np.prod(np.ptp(one, axis=0)), rel=2e-2)
        met += counted > 0.01
    assert met > 100


def test_a_ring_that_crosses_itself_covers_what_it_winds_round() -> None:
    bow = np.array([(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)])
    assert overlap_m2(bow, SQUARE) == pytest.approx(2.0)
