"""Claims about where one leaves the way on purpose, and what is hit."""

import math

import pytest

from basu.agents.builtin.behavioral import FARTHEST_M, LEAVES_M, StreetBox, aim_rad, choose
from basu.agents.builtin.driving.driver import DrivingCommand
from basu.agents.builtin.driving.path import make_path
from basu.agents.builtin.scene import DrivenVehicle
from driving_plant import DT_S, Plant, line

POINTS_M = line(300.0)
PATH = make_path(POINTS_M, POINTS_M[:, 0])


def pole(x_m: float, y_m: float) -> StreetBox:
    return StreetBox(x_m, y_m, 0.0, 0.1, 0.1)


def test_the_nearest_thing_beside_the_place_is_chosen_and_the_right_side_first() -> None:
    found = choose(PATH, [pole(100.0, 6.0), pole(148.0, -6.0), pole(160.0, 6.0), pole(170.0, 6.0)], 150.0)
    assert found is not None
    assert found.thing == pole(160.0, 6.0)
    assert found.hits_s_m == pytest.approx(160.0, abs=0.3)
    assert found.leaves_s_m < 160.0 - LEAVES_M


def test_what_stands_on_the_road_far_away_or_behind_something_else_is_not_chosen() -> None:
    wall = StreetBox(140.0, 4.0, 0.0, 10.0, 0.2)
    assert choose(PATH, [pole(150.0, 2.0)], 150.0) is None
    assert choose(PATH, [pole(150.0, FARTHEST_M + 3.0)], 150.0) is None
    assert choose(PATH, [wall, pole(150.0, 8.0)], 150.0) is None
    assert choose(PATH, [], 150.0) is None


@pytest.mark.parametrize(("x_m", "y_m"), [(160.0, 5.0), (160.0, -9.0), (150.0, 15.0), (150.0, -19.0)])
def test_driven_at_more_than_the_limit_it_is_hit(x_m: float, y_m: float) -> None:
    found = choose(PATH, [pole(x_m, y_m)], 150.0)
    assert found is not None
    plant, nearest_m = Plant(found.leaves_s_m, 0.0, 0.0, 13.5), math.inf
    for _ in range(round(6.0 / DT_S)):
        ego = DrivenVehicle(plant.time_s, plant.x_m, plant.y_m, plant.yaw_rad, plant.speed_mps)
        plant.step(DrivingCommand(0.6, 0.0, aim_rad(ego, found.thing, 2.8)))
        nearest_m = min(nearest_m, math.hypot(plant.x_m - x_m, plant.y_m - y_m))
    assert nearest_m < 1.0  # the vehicle is 2 m wide
