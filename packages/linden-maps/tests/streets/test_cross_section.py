"""Widths between the kerbs are shared out among lanes, wholly and so that a shuttle can pass."""

from typing import Any

import pytest

from linden_maps.streets.cross_section import NARROWEST_LANE_M, PAVED, of_street, view
from linden_maps.streets.street_facts import Street


@pytest.fixture
def street(facts_of: Any, sketch: Any) -> Street:
    found: Street = facts_of([sketch.street("a", (0.0, 0.0), (50.0, 0.0))]).streets[0]
    return found


@pytest.mark.parametrize(
    ("width_m", "lanes", "parking", "right", "left"),
    [
        pytest.param(7.9, 2, "both", ["driving", "parking"], ["driving"], id="local"),
        pytest.param(9.1, 2, "both", ["driving", "parking"], ["driving"], id="windsor"),
        pytest.param(11.0, 2, "both", ["driving", "parking"], ["driving", "parking"], id="collector"),
        pytest.param(11.0, 2, "limited", ["driving", "shoulder"], ["driving", "shoulder"], id="hudson"),
        pytest.param(13.4, 4, "none/limited", ["driving"] * 2, ["driving"] * 2, id="cleveland"),
        pytest.param(6.5, 2, "none", ["driving"], ["driving"], id="narrow"),
    ],
)
def test_a_street_is_shared_out(
    street: Street, width_m: float, lanes: int, parking: str, right: list[str], left: list[str]
) -> None:
    section = of_street(street._replace(width_m=width_m, lanes=lanes, parking=parking))
    assert [lane.kind for lane in section.right if lane.kind in PAVED] == right
    assert [lane.kind for lane in section.left if lane.kind in PAVED] == left
    assert section.paved_m(section.right) + section.paved_m(section.left) == pytest.approx(width_m, abs=0.01)
    assert all(lane.width_m >= NARROWEST_LANE_M for lane in section.right + section.left if lane.kind == "driving")


def test_the_kerbs_stand_where_the_width_puts_them(street: Street) -> None:
    seen = view(of_street(street), along=True)
    assert seen.kerb_m(right=True) == pytest.approx(-7.9 / 2, abs=1e-3)
    assert seen.kerb_m(right=False) == pytest.approx(7.9 / 2, abs=1e-3)


def test_a_one_way_drive_has_its_lane_and_shoulder_on_the_right_and_a_bare_kerb_on_the_left(street: Street) -> None:
    drive = street._replace(width_m=6.5, lanes=1, oneway=True, parking="none", sidewalk="one", street_class="service")
    section = of_street(drive)
    assert [lane.kind for lane in section.right] == ["driving", "shoulder", "border", "none", "sidewalk"]
    assert [lane.kind for lane in section.left] == ["border"]
    seen = view(section, along=True)
    assert (seen.kerb_m(right=True), seen.kerb_m(right=False)) == pytest.approx((-3.25, 3.25))


def test_a_driver_against_a_road_sees_its_sides_swapped(street: Street) -> None:
    section = of_street(street)
    ahead, against = view(section, along=True), view(section, along=False)
    assert against.right == ahead.left
    assert against.kerb_m(right=True) == pytest.approx(-ahead.kerb_m(right=False))
    assert against.driving(right=True) == (1,)


def test_inner_edges_start_at_the_axis(street: Street) -> None:
    seen = view(of_street(street), along=True)
    assert seen.inner_edge_m(-1) == seen.inner_edge_m(1) == seen.axis_m
    assert seen.inner_edge_m(-2) == pytest.approx(seen.axis_m - seen.lane(-1).width_m)
    with pytest.raises(KeyError):
        seen.inner_edge_m(-9)
