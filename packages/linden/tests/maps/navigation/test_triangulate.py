"""Faces cut into convex polygons: nothing lost, nothing twice."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from linden.maps.navigation.contour import Face, faces_of, twice_area
from linden.maps.navigation.triangulate import MOST_CORNERS, convex_polygons

PICTURES = arrays(np.uint8, st.tuples(st.integers(1, 10), st.integers(1, 10)), elements=st.integers(0, 2))


def faces(kind: np.ndarray) -> list[Face]:
    heights = np.zeros((kind.shape[0] + 1, kind.shape[1] + 1))
    return faces_of(kind, heights, cell_m=1.0, tolerance_m=1e-3, tolerance_z_m=1.0)


def turns(loop: list[tuple[int, int]]) -> list[int]:
    count = len(loop)
    found = []
    for n in range(count):
        (ax, ay), (bx, by), (cx, cy) = loop[n - 1], loop[n], loop[(n + 1) % count]
        found.append((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    return found


@given(PICTURES)
@settings(max_examples=200, deadline=None)
def test_the_polygons_of_any_face_are_convex_and_have_its_area(kind: np.ndarray) -> None:
    for face in faces(kind):
        polygons = convex_polygons(face.outer, face.holes)
        for polygon in polygons:
            assert 3 <= len(polygon) <= MOST_CORNERS
            assert max(turns(polygon)) < 0
        whole = twice_area(np.array(face.outer)) + sum(twice_area(np.array(hole)) for hole in face.holes)
        assert sum(twice_area(np.array(polygon)) for polygon in polygons) == whole


@given(PICTURES)
@settings(max_examples=100, deadline=None)
def test_no_side_belongs_to_two_polygons_the_same_way_round(kind: np.ndarray) -> None:
    for face in faces(kind):
        polygons = convex_polygons(face.outer, face.holes)
        sides = [side for loop in polygons for side in zip(loop, [*loop[1:], loop[0]], strict=True)]
        assert len(sides) == len(set(sides))


def test_a_rectangle_stays_one_polygon() -> None:
    rectangle = [(0, 0), (0, 4), (30, 4), (30, 0)]
    assert [sorted(polygon) for polygon in convex_polygons(rectangle, [])] == [sorted(rectangle)]


def test_a_corner_on_a_straight_side_stays_a_corner() -> None:
    rectangle = [(0, 0), (0, 4), (13, 4), (30, 4), (30, 0)]
    assert any((13, 4) in polygon for polygon in convex_polygons(rectangle, []))


def test_two_holes_that_lie_close_together_take_nothing_of_a_face_with_them() -> None:
    outer = [(0, 197), (0, 232), (2, 232), (2, 245), (0, 244), (0, 250), (320, 268), (320, 215)]
    holes = [
        [(88, 241), (89, 237), (114, 238), (113, 250), (88, 249)],
        [(124, 239), (148, 240), (147, 252), (124, 251)],
    ]
    whole = sum(twice_area(np.array(loop)) for loop in (outer, *holes))
    assert sum(twice_area(np.array(polygon)) for polygon in convex_polygons(outer, holes)) == whole
