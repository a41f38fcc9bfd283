"""The slow and obvious version of the caster of rays: everything is tried, one after the other. For tests only."""

import numpy as np

from linden.maps.ground import Ground, surface_under, triangle_under

STEPS = 10_000


def along(start: np.ndarray, end: np.ndarray, at: float) -> np.ndarray:
    return start + at * (end - start)


def road(vertices: np.ndarray, triangles: np.ndarray, start: np.ndarray, end: np.ndarray) -> list[tuple[float, int]]:
    """Place and number of every triangle met, by solving three equations for each."""
    found = []
    for number, (a, b, c) in enumerate(vertices[triangles]):
        matrix = np.array([end - start, a - b, a - c]).T
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        at, u, v = np.linalg.solve(matrix, a - start)
        if 0.0 <= at <= 1.0 and min(u, v, 1.0 - u - v) >= 0.0:
            found.append((float(at), number))
    return sorted(found)


def terrain(ground: Ground, start: np.ndarray, end: np.ndarray) -> list[float]:
    """Places between two of many small steps of which one ends above and one below, where no road is."""
    places = np.linspace(0.0, 1.0, STEPS + 1)
    above = []
    for at in places:
        x, y, z = along(start, end, at)
        above.append(z - surface_under(ground, x, y, -1e9)[0] >= 0.0)
    changes = np.flatnonzero(np.diff(np.array(above, np.int8))) + 0.5
    return [at / STEPS for at in changes if triangle_under(ground, *along(start, end, at / STEPS)[:2], 1e9)[1] < 0]


def box(centre: np.ndarray, half: np.ndarray, axes: np.ndarray, start: np.ndarray, end: np.ndarray) -> float | None:
    """Where a way enters a box: the first of many points of it that lies within."""
    places = np.linspace(0.0, 1.0, STEPS + 1)
    points = start + places[:, None] * (end - start)
    inside = (np.abs((points - centre) @ axes) <= half).all(axis=1)
    return float(places[np.argmax(inside)]) if inside.any() else None
