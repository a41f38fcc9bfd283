"""Claims about names of streets on a map: readable, beside each other and beside all marks."""

import pytest

from basu.output.report.plots.street_names import MarkPlace, placed_names, street_at
from basu.output.report.streets import Bounds, Line, Streets

BOUNDS = Bounds(0.0, 0.0, 200.0, 200.0)
ACROSS: Line = [(-50.0, 100.0), (250.0, 100.0)]


def test_a_name_stands_beside_the_middle_of_its_street_and_is_never_upside_down() -> None:
    (one,) = placed_names(Streets([ACROSS[::-1]], ["Long Street"]), BOUNDS, 600.0, [])
    assert (one.x_m, one.y_m) == pytest.approx((100.0, 100.0), abs=5.0)
    assert one.angle_deg == pytest.approx(0.0, abs=1e-9)
    (steep,) = placed_names(Streets([[(100.0, 250.0), (110.0, -50.0)]], ["Long Street"]), BOUNDS, 600.0, [])
    assert -90.0 <= steep.angle_deg <= 90.0


def test_a_street_of_two_lanes_has_one_name_and_one_without_a_name_has_none() -> None:
    beside: Line = [(x_m, y_m + 3.5) for x_m, y_m in ACROSS]
    assert (
        len(placed_names(Streets([ACROSS, beside, ACROSS], ["Long Street", "Long Street", ""]), BOUNDS, 600.0, [])) == 1
    )


def test_a_name_gives_way_to_marks_and_is_left_out_where_there_is_no_room() -> None:
    streets = Streets([ACROSS], ["Long Street"])
    (beside,) = placed_names(streets, BOUNDS, 600.0, [MarkPlace(100.0, 100.0, 0.0)])
    assert abs(beside.x_m - 100.0) * 3.0 > 35.0 + 13.0  # 3 px for each metre, half of the name and half of a mark
    everywhere = [MarkPlace(float(x_m), float(y_m), 0.0) for x_m in range(0, 201, 5) for y_m in range(0, 201, 5)]
    assert placed_names(streets, BOUNDS, 600.0, everywhere) == []


def test_two_names_do_not_touch() -> None:
    near: Line = [(x_m, y_m + 4.0) for x_m, y_m in ACROSS]
    one, other = placed_names(Streets([ACROSS, near], ["First Street", "Other Street"]), BOUNDS, 600.0, [])
    assert (
        abs(one.x_m - other.x_m) > 20.0 or abs(one.y_m - other.y_m) * 3.0 + abs(one.beside_px - other.beside_px) > 13.0
    )


def test_what_has_no_room_on_a_telephone_is_minor() -> None:
    marks = [MarkPlace(float(x_m), 100.0, 0.0) for x_m in range(0, 201, 30)]
    (one,) = placed_names(Streets([ACROSS], ["A Street With A Name"]), BOUNDS, 1100.0, marks)
    (same,) = placed_names(Streets([ACROSS], ["A"]), BOUNDS, 1100.0, marks)
    assert not same.is_minor
    assert placed_names(Streets([ACROSS], ["A Street With A Name " * 3]), BOUNDS, 1100.0, [])[0].is_minor
    assert one.name == "A Street With A Name"


def test_the_street_at_a_place_is_the_nearest_one_that_has_a_name() -> None:
    streets = Streets([ACROSS, [(100.0, 0.0), (100.0, 200.0)], ACROSS], ["Long Street", "Short Street", ""])
    assert street_at(streets, 30.0, 102.0) == "Long Street"
    assert street_at(streets, 99.0, 150.0) == "Short Street"
    assert street_at(streets, 30.0, 150.0) == ""
