"""Claims about the triangles of the land."""

import numpy as np

from linden.scenery.streets.terrain import _delaunay


def test_no_corner_lies_inside_a_triangle_s_circle_and_the_triangles_fill_the_hull() -> None:
    points = np.random.default_rng(7).uniform(-500.0, 500.0, (400, 2)) + np.array([20_000.0, -9_000.0])
    triangles = _delaunay(points)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    (bx, by), (cx, cy) = (b - a).T, (c - a).T
    twice = bx * cy - by * cx
    ux = (cy * (bx**2 + by**2) - by * (cx**2 + cy**2)) / (2.0 * twice)
    uy = (bx * (cx**2 + cy**2) - cx * (bx**2 + by**2)) / (2.0 * twice)
    centre, radius = a + np.column_stack([ux, uy]), np.hypot(ux, uy)
    away = np.linalg.norm(points[None, :, :] - centre[:, None, :], axis=2)
    assert (away >= radius[:, None] * (1.0 - 1e-9)).all()
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    hull = int((count == 1).sum())
    assert count.max() == 2
    assert len(triangles) == 2 * len(points) - 2 - hull  # Euler's formula


def test_a_square_has_two_triangles() -> None:
    triangles = _delaunay(np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]))
    assert len(triangles) == 2
    assert set(triangles.ravel().tolist()) == {0, 1, 2, 3}
