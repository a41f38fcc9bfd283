import numpy as np

from linden_maps.lanelet2.simplify import kept_points


def _away(points, line):
    start, chord = line[:-1], np.diff(line, axis=0)
    share = np.clip(((points[:, None] - start) * chord).sum(axis=2) / (chord**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(points[:, None] - start - share[..., None] * chord, axis=2).min(axis=1).max()


def test_every_point_stays_within_the_tolerance():
    rng = np.random.default_rng(7)
    lines = [np.cumsum(rng.normal(size=(count, 3)) * [1.0, 0.3, 0.02], axis=0) for count in (2, 3, 50, 400)]
    first = np.cumsum([0, 2, 3, 50])
    kept = kept_points(np.concatenate(lines), first, 0.25)
    for line, chosen in zip(lines, np.split(kept, first[1:]), strict=True):
        assert chosen[0]
        assert chosen[-1]
        assert _away(line, line[chosen]) <= 0.25


def test_straight_lines_keep_their_ends_alone():
    line = np.linspace([0.0, 0.0, 5.0], [9.0, 3.0, 6.0], 20)
    assert np.flatnonzero(kept_points(line, np.array([0]), 0.01)).tolist() == [0, 19]


def test_no_lines_are_no_points():
    assert len(kept_points(np.empty((0, 3)), np.empty(0, np.int64), 0.01)) == 0
