"""Lines round patches: few corners, and the same ones for both neighbours."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from linden.maps.navigation.contour import Face, faces_of, twice_area

PICTURES = arrays(np.uint8, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.integers(0, 3))
EXACT = 1e-3


def faces(kind: np.ndarray, tolerance_m: float = EXACT, z_m: np.ndarray | None = None) -> list[Face]:
    heights = np.zeros((kind.shape[0] + 1, kind.shape[1] + 1)) if z_m is None else z_m
    return faces_of(kind, heights, cell_m=1.0, tolerance_m=tolerance_m, tolerance_z_m=0.25)


def area(face: Face) -> float:
    return -0.5 * (twice_area(np.array(face.outer)) + sum(twice_area(np.array(hole)) for hole in face.holes))


def sides(face: Face) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    return [side for loop in (face.outer, *face.holes) for side in zip(loop, [*loop[1:], loop[0]], strict=True)]


@given(PICTURES)
@settings(max_examples=100, deadline=None)
def test_the_faces_of_a_picture_cover_its_cells_and_nothing_else(kind: np.ndarray) -> None:
    found = faces(kind)
    for number in range(1, 4):
        assert sum(area(face) for face in found if face.kind == number) == (kind == number).sum()


@given(PICTURES, st.sampled_from([EXACT, 0.7, 1.45]))
@settings(max_examples=100, deadline=None)
def test_every_side_between_two_faces_is_a_side_of_both(kind: np.ndarray, tolerance_m: float) -> None:
    rows, columns = kind.shape
    full = np.where(kind == 0, 1, kind).astype(np.uint8)  # nothing is nowhere, so every inner side has two owners
    known = {side for face in faces(full, tolerance_m) for side in sides(face)}
    for a, b in known:
        on_border = (a[0] == b[0] and a[0] in (0, columns)) or (a[1] == b[1] and a[1] in (0, rows))
        assert on_border or (b, a) in known


def test_a_staircase_becomes_a_straight_line() -> None:
    kind = np.triu(np.ones((40, 40), np.uint8))
    (face,) = faces(kind, tolerance_m=1.45)
    assert face.outer == [(0, 0), (0, 1), (39, 40), (40, 40), (40, 0)]  # its ends at the border, and the corners


def test_a_line_that_bends_upwards_keeps_the_corner_there() -> None:
    kind = np.zeros((3, 40), np.uint8)
    kind[1] = 1
    hill_m = np.tile(np.maximum(0.0, 2.0 - 0.1 * np.abs(np.arange(41) - 20)), (4, 1))
    (face,) = faces(kind, tolerance_m=1.45, z_m=hill_m)
    assert (20, 1) in face.outer


def test_an_island_is_a_hole_in_what_surrounds_it() -> None:
    kind = np.full((9, 9), 3, np.uint8)
    kind[3:5, 4:6] = 0
    (face,) = faces(kind)
    assert sorted(face.holes[0]) == [(4, 3), (4, 5), (6, 3), (6, 5)]
    assert twice_area(np.array(face.outer)) < 0 < twice_area(np.array(face.holes[0]))
