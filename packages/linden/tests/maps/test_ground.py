"""The ground answers as the obvious search over all triangles does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet import slow_uncompiled
from linden.maps.ground import STEP_M, Ground, surface_under
from naive.physics import surface

SQUARE = ((0, 1, 2), (1, 3, 2))


def plate(z: float, size: float = 10.0, rise: float = 0.0) -> list[tuple[float, float, float]]:
    return [(x, y, z + rise * x) for x in (0.0, size) for y in (0.0, size)]


def stacked(*heights: float) -> Ground:
    corners = [corner for z in heights for corner in plate(z)]
    return Ground.from_triangles(
        corners, [(a + 4 * k, b + 4 * k, c + 4 * k) for k in range(len(heights)) for a, b, c in SQUARE]
    )


def height(ground: Ground, x: float, y: float, hint: float) -> float:
    return surface_under(ground, x, y, hint)[0]


@slow_uncompiled
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_height_is_that_of_the_highest_triangle_within_a_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices = rng.uniform((-20.0, -20.0, 0.0), (20.0, 20.0, 6.0), (30, 3))
    triangles = rng.integers(0, 30, (25, 3))
    ground = Ground.from_triangles(vertices, triangles)
    for x, y, hint in rng.uniform((-20.0, -20.0, 0.0), (20.0, 20.0, 6.0), (20, 3)):
        z, _, _, _, triangle = surface_under(ground, x, y, hint)
        expected = surface(vertices, triangles, x, y, hint + STEP_M)
        if expected is None:
            assert triangle == -1
        else:
            assert z == pytest.approx(expected, abs=1e-6)


def test_under_a_bridge_the_road_below_is_the_ground() -> None:
    ground = stacked(0.0, 6.0)
    assert height(ground, 5.0, 5.0, 0.1) == pytest.approx(0.0)
    assert height(ground, 5.0, 5.0, 6.2) == pytest.approx(6.0)


def test_a_kerb_is_stepped_onto_and_a_wall_is_not() -> None:
    ground = stacked(0.0, 0.4)
    assert height(ground, 5.0, 5.0, 0.0) == pytest.approx(0.4)
    assert height(stacked(0.0, 0.6), 5.0, 5.0, 0.0) == pytest.approx(0.0)


def test_the_normal_points_up_and_stands_on_the_slope() -> None:
    ground = Ground.from_triangles(plate(0.0, rise=0.1), [(2, 1, 0), (1, 3, 2)])
    _, x, y, z, _ = surface_under(ground, 5.0, 5.0, 1.0)
    assert (x, y, z) == pytest.approx((-0.1 / 1.01**0.5, 0.0, 1.0 / 1.01**0.5))


def test_beside_the_road_the_terrain_lies_at_the_height_of_the_nearest_road() -> None:
    ground = Ground.from_triangles(plate(3.0), SQUARE)
    for x, y in ((-5.0, 5.0), (15.0, 15.0), (-50.0, 70.0), (1e6, -1e6)):
        z, _, _, up, triangle = surface_under(ground, x, y, 100.0)
        assert (z, up, triangle) == (pytest.approx(3.0), pytest.approx(1.0), -1)


def test_the_terrain_beside_a_slope_follows_it() -> None:
    ground = Ground.from_triangles(plate(0.0, size=100.0, rise=0.05), SQUARE)
    assert height(ground, 20.0, -4.0, 50.0) == pytest.approx(1.0, abs=0.15)
    assert height(ground, 80.0, 104.0, 50.0) == pytest.approx(4.0, abs=0.15)


def test_a_body_below_everything_stands_on_the_terrain() -> None:
    ground = stacked(0.0, 6.0)
    assert surface_under(ground, 5.0, 5.0, -40.0)[0] == pytest.approx(0.0)


@pytest.mark.parametrize("place", [(np.nan, 0.0), (0.0, np.nan), (np.inf, -np.inf)])
def test_a_place_that_is_no_number_still_has_a_height(place: tuple[float, float]) -> None:
    assert np.isfinite(height(Ground.from_triangles(plate(3.0), SQUARE), *place, 0.0)) or np.isnan(place).any()


def test_flat_ground_is_flat_everywhere() -> None:
    assert surface_under(Ground.flat(2.5), -1e5, 1e5, 0.0) == (2.5, 0.0, 0.0, 1.0, -1)


def test_walls_and_lines_are_no_ground() -> None:
    wall = [(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.0, 0.0, 5.0)]
    assert surface_under(Ground.from_triangles(wall, [(0, 1, 2)]), 5.0, 0.0, 9.0)[4] == -1


def test_heights_of_many_points_come_at_once() -> None:
    ground = stacked(0.0, 6.0)
    heights, triangles = ground.surfaces_under([(5.0, 4.0, 0.0), (5.0, 4.0, 9.0), (-5.0, 4.0, 9.0)])
    assert heights == pytest.approx([0.0, 6.0, 0.0])
    assert (triangles >= 0).tolist() == [True, True, False]


def test_no_triangles_make_flat_ground() -> None:
    assert height(Ground.from_triangles(np.empty((0, 3)), np.empty((0, 3))), 1.0, 1.0, 0.0) == 0.0


@pytest.mark.parametrize(
    ("vertices", "triangles", "reason"),
    [
        ([(0, 0, 0), (1, 0, 0), (0, 1, float("nan"))], [(0, 1, 2)], "finite"),
        ([(0, 0, 0), (1, 0, 0)], [(0, 1, 2)], "outside 0..1"),
    ],
)
def test_a_broken_mesh_is_refused(vertices: list, triangles: list, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        Ground.from_triangles(vertices, triangles)
