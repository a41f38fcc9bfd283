"""Claims about sides that become one: only across two lanelets, only between the same ends, only near each other."""

from itertools import pairwise

import numpy as np
import pytest

from linden_maps.lanelet2.shared import NEAR_M, one_line
from linden_maps.lanelet2.stretches import LaneletNetwork, LanePiece, Side, Stretch

BOW = np.linspace(0.0, np.pi, 40)


def bow(rise_m: float, *, back: bool = False) -> np.ndarray:
    """A line from (0, 0) to (10, 0) that rises in between, or the same from the other end."""
    line = np.column_stack([np.linspace(0.0, 10.0, len(BOW)), rise_m * np.sin(BOW), np.zeros(len(BOW))])
    return line[::-1] if back else line


def one_way(road: int, *, near_is_left: bool, forward: bool = True, junction: int = 5) -> Stretch:
    """A way with two sides: boundary 0 is the one that may be shared."""
    near, far = (Side(road, "road", ((0, boundary, 0.0, 10.0),)) for boundary in (0, -1))
    left, right = (near, far) if near_is_left else (far, near)
    return Stretch(road, "road", (LanePiece(0, -1, 0.0, 10.0, road),), forward, junction, left, right)


def joined(stretches: list[Stretch], near: list[np.ndarray]) -> tuple[dict, list[np.ndarray]]:
    """What ``one_line`` makes of ways whose near sides all have ends at (0, 0) and (10, 0)."""
    index, lines, joints = {}, [], []
    for number, (stretch, line) in enumerate(zip(stretches, near, strict=True)):
        for side in (stretch.left, stretch.right):
            index[side] = len(lines)
            is_near = side.pieces[0][1] == 0
            lines.append(line.copy() if is_near else line + np.array([0.0, 3.0 + number, 0.0]))
            starts_at_zero = line[0, 0] == 0.0
            ends = [0, 1] if starts_at_zero else [1, 0]
            joints += ends if is_near else [100 + 2 * len(lines), 101 + 2 * len(lines)]
    network = LaneletNetwork(tuple(stretches), ((),) * len(stretches), {})
    return one_line(network, index, lines, lambda end: joints[end]), lines


def test_opposite_ways_share_the_mean_of_their_left_sides() -> None:
    stretches = [one_way(1, near_is_left=True), one_way(2, near_is_left=True)]
    same, lines = joined(stretches, [bow(0.2), bow(0.0, back=True)])
    assert [tuple(each) for each in same.values()] == [(0, True)]
    (other,) = same
    assert lines[0][:, 1].max() == pytest.approx(0.1, abs=1e-3)
    np.testing.assert_allclose(lines[other], lines[0][::-1])
    np.testing.assert_allclose(lines[0][[0, -1]], bow(0.0)[[0, -1]], atol=1e-12)


def test_neighbours_in_one_direction_share_a_right_and_a_left_side() -> None:
    stretches = [one_way(1, near_is_left=False), one_way(2, near_is_left=True)]
    same, _ = joined(stretches, [bow(0.0), bow(0.01)])
    assert [each.turned for each in same.values()] == [False]


@pytest.mark.parametrize(
    ("stretches", "lines"),
    [
        pytest.param(
            [one_way(1, near_is_left=True), one_way(2, near_is_left=True)],
            [bow(0.0), bow(0.1)],
            id="one upon the other",
        ),
        pytest.param(
            [one_way(1, near_is_left=True), one_way(2, near_is_left=True)],
            [bow(0.0), bow(1.1 * NEAR_M, back=True)],
            id="too far apart",
        ),
        pytest.param(
            [one_way(1, near_is_left=True, junction=-1), one_way(2, near_is_left=True, junction=-1)],
            [bow(0.0), bow(0.0, back=True)],
            id="outside junctions",
        ),
    ],
)
def test_other_sides_stay_as_they_are(stretches: list[Stretch], lines: list[np.ndarray]) -> None:
    same, after = joined(stretches, lines)
    assert same == {}
    np.testing.assert_array_equal(after[0], lines[0])


def test_three_ways_make_one_pair() -> None:
    stretches = [one_way(1, near_is_left=True), *(one_way(n, near_is_left=True) for n in (2, 3))]
    same, lines = joined(stretches, [bow(0.0), bow(0.05, back=True), bow(0.1, back=True)])
    assert len(same) == 1
    gaps = [np.abs(a - b).max() for a, b in pairwise([lines[4], bow(0.1, back=True)])]
    assert gaps == [0.0]
