"""Curves of lines and arcs meet their ends with the headings asked for."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from linden_maps.streets.curves import (
    Path,
    Piece,
    Pose,
    along,
    joined,
    length,
    pose_at,
    rounded,
    sampled,
    seen_from,
    sharpest,
    trimmed,
    wrapped,
)

metres = st.floats(-200, 200, allow_nan=False)
headings = st.floats(-math.pi, math.pi)
poses = st.builds(Pose, metres, metres, headings)


def gaps(path: Path) -> list[tuple[float, float]]:
    """Distance and change of heading between the end of each piece and the start of the next."""
    found = []
    for piece, after in pairwise(path):
        end = along(piece, piece.length_m)
        turn_rad = abs(wrapped(end.heading_rad - after.start.heading_rad))
        found.append((math.dist(end[:2], after.start[:2]), turn_rad))
    return found


@given(poses, poses)
@example(Pose(4.0, 2.0, 0.0), Pose(0.0, 0.0, 6.103515625e-05))  # back by two arcs with radii of 30 km
def test_a_join_leaves_and_arrives_as_asked_without_a_kink(begin: Pose, end: Pose) -> None:
    assume(math.dist(begin[:2], end[:2]) > 1.0)
    ahead, behind = seen_from(begin, end[:2]), seen_from(end, begin[:2])
    assume(abs(math.atan2(ahead[1], ahead[0])) < 2.8)  # right behind, no arc leads there
    assume(abs(math.atan2(behind[1], -behind[0])) < 2.8)
    path = joined(begin, end)
    arrived = along(path[-1], path[-1].length_m)
    assert math.dist(path[0].start[:2], begin[:2]) < 1e-6
    assert math.dist(arrived[:2], end[:2]) < 1e-4
    assert abs(wrapped(path[0].start.heading_rad - begin.heading_rad)) < 1e-3
    assert abs(wrapped(arrived.heading_rad - end.heading_rad)) < 1e-3
    assert all(gap_m < 1e-4 and kink_rad < 1e-3 for gap_m, kink_rad in gaps(path))


def test_a_right_angle_with_equal_sides_is_one_arc() -> None:
    path = joined(Pose(0.0, 0.0, 0.0), Pose(10.0, 10.0, math.pi / 2))
    assert len(path) == 1
    assert path[0].curvature_per_m == pytest.approx(0.1)
    assert length(path) == pytest.approx(5 * math.pi)


def test_a_shift_to_the_side_is_two_arcs_that_bend_opposite_ways() -> None:
    left, right = joined(Pose(0.0, 0.0, 0.0), Pose(30.0, 4.0, 0.0))
    assert left.curvature_per_m == pytest.approx(-right.curvature_per_m)
    assert left.curvature_per_m > 0


def test_a_nearly_straight_join_is_a_line() -> None:
    path = joined(Pose(0.0, 0.0, 0.0), Pose(20.0, 1e-6, 0.0))
    assert sharpest(path) == 0.0


def test_rounding_keeps_the_ends_and_touches_each_corner_with_its_radius() -> None:
    path = rounded([(0.0, 0.0), (100.0, 0.0), (100.0, 80.0)], radius_m=20.0, ends_kept_m=10.0)
    assert pose_at(path, 0.0) == Pose(0.0, 0.0, 0.0)
    assert along(path[-1], path[-1].length_m)[:2] == pytest.approx((100.0, 80.0))
    assert [piece.curvature_per_m for piece in path] == pytest.approx([0.0, 1 / 20.0, 0.0])
    assert length(path) == pytest.approx(180.0 - 40.0 + 10 * math.pi)


def test_a_corner_between_short_sides_gets_the_radius_that_fits() -> None:
    path = rounded([(0.0, 0.0), (50.0, 0.0), (50.0, 10.0), (90.0, 10.0)], radius_m=20.0, ends_kept_m=10.0)
    assert 1 / sharpest(path) == pytest.approx(5.0)
    assert all(gap_m < 1e-9 and kink_rad < 1e-9 for gap_m, kink_rad in gaps(path))


@given(st.lists(st.tuples(metres, metres), min_size=2, max_size=6, unique=True), st.floats(1, 50))
def test_rounding_never_leaves_a_gap(points: list[tuple[float, float]], radius_m: float) -> None:
    sides = list(pairwise(points))
    assume(all(math.dist(a, b) > 5.0 for a, b in sides))
    turns = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in sides]
    assume(all(abs(wrapped(b - a)) < 3.0 for a, b in pairwise(turns)))
    path = rounded(points, radius_m, ends_kept_m=10.0)
    assert all(gap_m < 1e-3 and kink_rad < 1e-6 for gap_m, kink_rad in gaps(path))


def test_trimming_cuts_inside_pieces() -> None:
    path = rounded([(0.0, 0.0), (100.0, 0.0), (100.0, 80.0)], radius_m=20.0, ends_kept_m=10.0)
    cut = trimmed(path, 90.0, 100.0)
    assert length(cut) == pytest.approx(10.0)
    assert pose_at(cut, 0.0) == pytest.approx(pose_at(path, 90.0))


def test_samples_stand_beside_the_path() -> None:
    found = sampled((Piece(Pose(0.0, 0.0, 0.0), 10.0, 0.0),), 4.0, left_m=2.0)
    assert [pose[:2] for pose in found] == [pytest.approx((x, 2.0)) for x in (0.0, 10 / 3, 20 / 3, 10.0)]


@given(poses, poses)
def test_a_point_is_seen_where_it_lies(eye: Pose, other: Pose) -> None:
    ahead_m, left_m = seen_from(eye, other[:2])
    cos, sin = math.cos(eye.heading_rad), math.sin(eye.heading_rad)
    assert eye.x_m + ahead_m * cos - left_m * sin == pytest.approx(other.x_m, abs=1e-9)
    assert eye.y_m + ahead_m * sin + left_m * cos == pytest.approx(other.y_m, abs=1e-9)
