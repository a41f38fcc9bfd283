"""Claims about the distance between boxes, held against shapely's polygons."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from shapely import Polygon, affinity

from basu.scenarios.criteria.surrogate_measures import gap_m

BOX = st.tuples(
    st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(-7.0, 7.0), st.floats(0.05, 6.0), st.floats(0.05, 3.0)
)


def polygon(box: tuple[float, ...]) -> Polygon:
    """The box as shapely has it."""
    x_m, y_m, yaw_rad, length_m, width_m = box
    square = Polygon([(length_m, width_m), (length_m, -width_m), (-length_m, -width_m), (-length_m, width_m)])
    return affinity.translate(affinity.rotate(square, yaw_rad, origin=(0, 0), use_radians=True), x_m, y_m)


@given(BOX, BOX)
def test_it_is_the_distance_of_polygons(a: tuple[float, ...], b: tuple[float, ...]) -> None:
    assert gap_m(np.array([a]), np.array([b]))[0] == pytest.approx(polygon(a).distance(polygon(b)), abs=1e-9)


@given(arrays.arrays(np.float64, (7, 5), elements=st.floats(0.1, 9.0)))
def test_many_pairs_are_each_their_own(boxes: np.ndarray) -> None:
    turned = boxes[::-1].copy()
    alone = [gap_m(boxes[index : index + 1], turned[index : index + 1])[0] for index in range(7)]
    assert gap_m(boxes, turned).tolist() == alone


def test_one_within_the_other_is_no_distance_away() -> None:
    assert gap_m(np.array([[0.0, 0.0, 0.3, 9.0, 9.0]]), np.array([[1.0, 1.0, 1.0, 0.2, 0.2]])) == pytest.approx([0.0])


def test_corner_to_corner_is_pythagoras() -> None:
    assert gap_m(np.array([[0.0, 0.0, 0.0, 2.0, 1.0]]), np.array([[7.0, 6.0, 0.0, 2.0, 1.0]])) == pytest.approx([5.0])
