"""Rays agree with the obvious way to cast them, and say what a person would."""

import math

import numpy as np
import pytest

from fleet import slow_uncompiled
from linden.geometry import rotation_matrix
from linden.maps.ground import Ground
from linden.protocol.values.space import Rotation
from linden.scenery.ray_query import MovingBoxes, StandingBoxes, Surface, crossings
from linden.scenery.ray_surfaces import parabola_roots
from naive import rays as naive

NO_BOXES = StandingBoxes.of(np.empty((0, 3)), np.empty((0, 3)), np.empty(0))
NOBODY = MovingBoxes(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3, 3)))
RANDOM = np.random.default_rng(7)


def hits(found: np.ndarray, surface: Surface) -> list[tuple[float, int]]:
    return [(float(at), int(number)) for at, kind, number in found if kind == surface]


def hilly_road(side: int = 9) -> tuple[np.ndarray, np.ndarray]:
    """A bent sheet of triangles of about 6 m with holes, under which a second one lies in part."""
    x, y = np.meshgrid(np.arange(side) * 6.0, np.arange(side) * 6.0)
    upper = np.column_stack([x.ravel(), y.ravel(), 2.0 * np.sin(x.ravel() / 9.0) + RANDOM.uniform(0.0, 1.0, x.size)])
    corners = np.arange(side * side).reshape(side, side)
    a, b, c, d = corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    kept = triangles[RANDOM.random(len(triangles)) < 0.7]
    below = kept[::3] + len(upper)
    return np.concatenate([upper, upper - (0.0, 0.0, 4.0)]), np.concatenate([kept, below])


VERTICES, TRIANGLES = hilly_road()
GROUND = Ground.from_triangles(VERTICES, TRIANGLES)


def ways(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Random ways, some of them along an axis of the grids."""
    found = []
    for number in range(count):
        start, end = RANDOM.uniform((-20.0, -20.0, -6.0), (70.0, 70.0, 8.0), (2, 3))
        if number % 4 < 3:
            end[number % 4 % 2] = start[number % 4 % 2]
        if number % 4 == 2:
            end[:2] = start[:2]
        found.append((start, end))
    return found


def test_every_triangle_on_the_way_is_met_once_or_twice_at_its_place() -> None:
    met = 0
    for start, end in ways(240):
        found = hits(crossings(GROUND, NO_BOXES, NOBODY, start, end), Surface.ROAD)
        for at, triangle in (expected := naive.road(VERTICES, TRIANGLES, start, end)):
            assert any(number == triangle and abs(at - place) < 1e-9 for place, number in found), (start, end)
        beyond = {number for _, number in found} - {number for _, number in expected}
        assert len(beyond) <= 1  # a ray through a shared edge may meet the neighbour too
        met += len(expected)
    assert met > 30


@pytest.mark.parametrize(("start", "end"), ways(12))
@slow_uncompiled
def test_the_terrain_is_met_wherever_the_way_passes_through_it(start: np.ndarray, end: np.ndarray) -> None:
    found = [at for at, _ in hits(crossings(GROUND, NO_BOXES, NOBODY, start, end), Surface.TERRAIN)]
    expected = naive.terrain(GROUND, start, end)
    assert len(found) == len(expected)
    np.testing.assert_allclose(found, expected, atol=1.0 / naive.STEPS)


def test_boxes_that_stand_are_met_where_they_are_entered() -> None:
    centres, halves = RANDOM.uniform(0.0, 80.0, (60, 3)), RANDOM.uniform(0.2, 9.0, (60, 3))
    yaws = RANDOM.uniform(-4.0, 4.0, 60)
    standing = StandingBoxes.of(centres, halves, yaws)
    for start, end in RANDOM.uniform(-10.0, 90.0, (12, 2, 3)):
        found = dict(map(reversed, hits(crossings(Ground.flat(-50.0), standing, NOBODY, start, end), Surface.STANDING)))
        for number in range(60):
            axes = rotation_matrix(Rotation(0.0, math.degrees(yaws[number]), 0.0))
            expected = naive.box(centres[number], halves[number], axes, start, end)
            grazed = naive.box(centres[number], halves[number] - 0.01, axes, start, end) is None
            assert grazed or abs(found[number] - expected) <= 1.0 / naive.STEPS
            assert (number in found) or expected is None


def test_boxes_that_move_may_lean() -> None:
    lean = rotation_matrix(Rotation(25.0, 40.0, -60.0))
    boxes = MovingBoxes(np.array([[10.0, 2.0, 3.0]]), np.array([[4.0, 1.0, 0.5]]), lean[None])
    met = 0
    for start, end in RANDOM.uniform((4.0, -4.0, 0.0), (16.0, 8.0, 6.0), (40, 2, 3)):
        found = hits(crossings(Ground.flat(-50.0), NO_BOXES, boxes, start, end), Surface.MOVING)
        expected = naive.box(boxes.centre_m[0], boxes.half_m[0], lean, start, end)
        met += expected is not None
        if found and expected is not None:
            assert abs(found[0][0] - expected) <= 1.0 / naive.STEPS
        elif expected is not None:
            pytest.fail(f"a way from {start} to {end} misses a box it enters at {expected}")
    assert met > 5


def test_a_ray_that_begins_inside_meets_the_box_at_once() -> None:
    standing = StandingBoxes.of(np.array([[0.0, 0.0, 1.0]]), np.ones((1, 3)), np.zeros(1))
    found = crossings(Ground.flat(), standing, NOBODY, np.array([0.2, 0.0, 1.0]), np.array([9.0, 0.0, 1.0]))
    assert found.tolist() == [[0.0, Surface.STANDING, 0.0]]


def test_what_is_met_stands_in_the_order_of_the_way() -> None:
    standing = StandingBoxes.of(np.array([[20.0, 0.0, 1.0], [8.0, 0.0, 1.0]]), np.ones((2, 3)), np.zeros(2))
    moving = MovingBoxes(np.array([[14.0, 0.0, 1.0]]), np.ones((1, 3)), np.eye(3)[None])
    there = crossings(Ground.flat(), standing, moving, np.array([0.0, 0.0, 1.5]), np.array([30.0, 0.0, -0.5]))
    assert [(int(kind), int(number)) for _, kind, number in there] == [
        (Surface.STANDING, 1), (Surface.MOVING, 0), (Surface.STANDING, 0), (Surface.TERRAIN, -1),
    ]  # fmt: skip


def test_a_ray_without_length_and_one_beyond_the_map_end_well() -> None:
    here = np.array([3.0, 3.0, 30.0])
    assert len(crossings(GROUND, NO_BOXES, NOBODY, here, here)) == 0
    far = np.array([1e7, 1e7, 1e6])
    assert len(crossings(GROUND, NO_BOXES, NOBODY, far, far + 100.0)) == 0
    down = crossings(GROUND, NO_BOXES, NOBODY, far, far * (1.0, 1.0, -1.0))
    assert [int(kind) for _, kind, _ in down] == [Surface.TERRAIN]  # its edge goes on for ever


@pytest.mark.parametrize(
    ("values", "roots"),
    [
        pytest.param((1.0, 0.0, -1.0), (0.5, math.inf), id="a line"),
        pytest.param((1.0, -1.0, 1.0), (0.5 - math.sqrt(0.125), 0.5 + math.sqrt(0.125)), id="a dip"),
        pytest.param((1.0, 2.0, 3.0), (math.inf, math.inf), id="above"),
        pytest.param((0.0, 0.0, 0.0), (math.inf, math.inf), id="along"),
        pytest.param((0.0, -1.0, -2.0), (0.0, math.inf), id="from zero down"),
        pytest.param((0.0, 1.0, 2.0), (math.inf, math.inf), id="from zero up"),
    ],
)
def test_a_parabola_changes_its_sign_where_it_should(values, roots) -> None:
    np.testing.assert_allclose(parabola_roots(*values), roots, atol=1e-12)
