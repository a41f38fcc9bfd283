"""Tiles as pictures: what lies over what, what is cleared away, and floors over floors."""

import numpy as np
import pytest

from linden.maps.navigation.raster import (
    CROSSWALK,
    EDGE,
    LEVELS,
    ROAD,
    SIDEWALK,
    VOID,
    block,
    close_gaps,
    keep_clear,
    paint,
    untangle,
)  # fmt: skip

FRAME = np.array([0.0, 0.0, 0.2])


def rectangle(x0: float, x1: float, y0: float, y1: float, z: float = 0.0) -> list[list[tuple[float, float, float]]]:
    a, b, c, d = (x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)
    return [[a, b, c], [a, c, d]]


def picture(
    *parts: tuple[int, list[list[tuple[float, float, float]]]], size: int = 50
) -> tuple[np.ndarray, np.ndarray]:
    """Paint rectangles of kinds into a picture of 10 m."""
    corners = np.array([triangle for _, shape in parts for triangle in shape])
    kinds = np.array([kind for kind, shape in parts for _ in shape], np.uint8)
    kind, z_m = np.zeros((LEVELS, size, size), np.uint8), np.zeros((LEVELS, size, size))
    paint(corners, kinds, np.arange(len(corners), dtype=np.int32), FRAME, kind, z_m)
    return kind, z_m


def test_the_carriageway_lies_over_a_pavement_and_a_crosswalk_over_the_carriageway() -> None:
    kind, _ = picture(
        (ROAD, rectangle(0, 10, 4, 8)), (SIDEWALK, rectangle(0, 10, 2, 6, 0.15)), (CROSSWALK, rectangle(4, 6, 0, 10))
    )
    assert kind[0, 15, 5] == SIDEWALK
    assert kind[0, 25, 5] == ROAD
    assert kind[0, 30, 25] == CROSSWALK
    assert kind[0, 15, 25] == SIDEWALK, "what is pavement stays pavement"
    assert kind[1:].max() == VOID


def test_a_bridge_is_a_second_floor_with_its_own_height() -> None:
    kind, z_m = picture((ROAD, rectangle(0, 10, 0, 10)), (SIDEWALK, rectangle(4, 6, 0, 10, 5.0)))
    assert (kind[0, 25, 25], kind[1, 25, 25]) == (ROAD, SIDEWALK)
    assert z_m[1, 25, 25] == pytest.approx(5.0)
    assert kind[1, 25, 5] == VOID


def test_a_floor_that_begins_as_the_only_one_becomes_whole() -> None:
    # the bridge is painted first where nothing is under it, and stands on the upper level only over the street
    kind, z_m = picture((ROAD, rectangle(4, 6, 0, 10)), (SIDEWALK, rectangle(0, 10, 4, 6, 5.0)))
    assert {*np.unique(kind[0])} == {VOID, ROAD, SIDEWALK}
    untangle(kind, z_m)
    assert sorted({*np.unique(kind[0])} | {*np.unique(kind[1])}) == [VOID, SIDEWALK, ROAD]
    for level in range(2):
        assert len({*np.unique(kind[level])} - {VOID}) == 1
    assert (kind[:2] == SIDEWALK).sum() == 50 * 10


def test_a_seam_between_two_lanes_is_closed_and_a_gap_is_not() -> None:
    kind, z_m = picture(
        (SIDEWALK, rectangle(0, 10, 0, 4)), (SIDEWALK, rectangle(0, 10, 4.2, 6)), (SIDEWALK, rectangle(0, 10, 7, 9))
    )
    assert kind[0, 20, 25] == VOID
    close_gaps(kind, z_m)
    assert kind[0, 20, 25] == SIDEWALK
    assert kind[0, 32, 25] == VOID


def test_shoulders_keep_off_the_brink_and_out_of_the_traffic() -> None:
    kind, z_m = picture((ROAD, rectangle(0, 10, 6, 10)), (SIDEWALK, rectangle(0, 10, 2, 6)))
    keep_clear(kind, z_m)
    column = kind[0, :, 25].tolist()
    assert column[10] == VOID
    assert column[11:29] == [SIDEWALK] * 18
    assert column[29] == EDGE
    assert column[30] == ROAD


def test_a_box_is_cut_out_at_any_angle_and_only_where_it_stands_in_the_way() -> None:
    kind, z_m = picture((SIDEWALK, rectangle(0, 10, 0, 10)))
    half = np.array([[2.0, 0.5, 1.0]])
    block(np.array([[5.0, 5.0, 1.0]]), half, np.array([np.pi / 4]), FRAME, kind, z_m)
    assert kind[0, 25 + 6, 25 + 6] == VOID
    assert kind[0, 25 + 6, 25 - 6] == SIDEWALK
    before = kind.copy()
    block(np.array([[2.0, 2.0, 3.5]]), half, np.array([0.0]), FRAME, kind, z_m)  # a sign over everybody's head
    np.testing.assert_array_equal(kind, before)
