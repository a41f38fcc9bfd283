"""Claims about the buildings and the furniture that a map itself has."""

import math

import numpy as np
import pytest

from linden.maps.archive import pack, unpack
from linden.maps.facts import derive
from linden.maps.standing import MOST_STRIPS, footprint_boxes
from opendrive_texts import street_through_junction

OUTLINE = "".join(f'<cornerLocal u="{u}" v="{v}" z="0" height="6"/>' for u, v in ((0, 0), (12, 0), (12, 8), (0, 8)))
HOUSE = f'<object id="1" type="building" name="Library" s="10" t="20" hdg="0"><outline>{OUTLINE}</outline></object>'
BENCH = HOUSE.replace("building", "obstacle").replace("Library", "bench").replace('id="1"', 'id="2"')


def with_objects(*objects: str) -> str:
    """The street with objects beside its first road."""
    return street_through_junction(objects="".join(objects))


def area(boxes: list[tuple[float, float, float, float, float]]) -> float:
    return sum(4.0 * half_u * half_v for _, _, half_u, half_v, _ in boxes)


def turned(corners: list[tuple[float, float]], degrees: float) -> np.ndarray:
    turn = math.radians(degrees)
    return np.array(corners) @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])


ELL = [(0.0, 0.0), (30.0, 0.0), (30.0, 8.0), (10.0, 8.0), (10.0, 25.0), (0.0, 25.0)]
YARD = [(0, 0), (30, 0), (30, 20), (20, 20), (20, 10), (10, 10), (10, 20), (0, 20)]  # three wings about a yard


@pytest.mark.parametrize(("corners", "count", "square_m"), [(ELL, 2, 410.0), (YARD, 3, 500.0)])
@pytest.mark.parametrize("degrees", [0.0, 17.0, 90.0, 200.0])
def test_a_footprint_of_right_angles_is_covered_exactly(
    corners: list[tuple[float, float]], count: int, square_m: float, degrees: float
) -> None:
    boxes = footprint_boxes(turned(corners, degrees))
    assert len(boxes) == count
    assert area(boxes) == pytest.approx(square_m)


def test_a_round_footprint_becomes_a_bounded_number_of_steps() -> None:
    angles = np.linspace(0.0, math.tau, 90, endpoint=False)
    boxes = footprint_boxes(10.0 * np.column_stack([np.cos(angles), np.sin(angles)]))
    assert len(boxes) <= MOST_STRIPS
    assert area(boxes) == pytest.approx(math.pi * 100.0, rel=0.02)


def test_a_footprint_without_area_has_no_boxes() -> None:
    assert footprint_boxes(np.array([(0.0, 0.0), (5.0, 0.0), (10.0, 0.0)])) == []


def test_buildings_and_furniture_of_a_map_stand_on_the_ground() -> None:
    house, bench = derive(with_objects(HOUSE, BENCH)).standing
    assert (house.kind, house.name, bench.kind, bench.name) == ("building", "Library", "bench", "")
    (box,) = house.boxes
    assert sorted((box.half_x_m, box.half_y_m)) == pytest.approx([4.0, 6.0])
    assert box.z_m - box.half_z_m == pytest.approx(house.z_m)
    assert house.y_m < -20.0  # left of a road that runs east is north, and y points south


@pytest.mark.parametrize(
    "change",
    [
        ('height="6"', 'height="0"'),  # flat: an outline of something painted
        ('type="building"', 'type="roadMark"'),
        (OUTLINE, ""),
    ],
)
def test_what_has_no_height_or_no_outline_does_not_stand(change: tuple[str, str]) -> None:
    assert derive(with_objects(HOUSE.replace(*change))).standing == ()


def test_what_stands_survives_the_cache() -> None:
    facts = derive(with_objects(HOUSE, BENCH))
    assert unpack(pack(facts)).standing == facts.standing
