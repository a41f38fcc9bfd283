"""Claims about the lane under a vehicle: which it is, how one stands in it, and how far beyond all lanes one is."""

import math
from typing import Any

import carla
import pytest

from basu.managers.base_manager import Ego
from basu.managers.lane_under import LaneFinder, LaneUnder, lane_under
from fakes.crossing_map import LANE_M, crossing

DRIVING = int(carla.LaneType.Driving)


@pytest.fixture(scope="module")
def town() -> carla.Map:
    return carla.Map("Crossing", crossing())


def at(town: carla.Map, x_m: float, y_m: float, yaw_rad: float = 0.0) -> LaneUnder:
    return lane_under(town, Ego(x_m, y_m, 0.0, 0.0, 0.0, yaw_rad, *[0.0] * 9))


def test_in_the_lane_to_the_east_one_stands_as_it_goes(town: carla.Map) -> None:
    lane = at(town, 40.0, LANE_M / 2.0 + 0.5)
    assert lane.lane_type == DRIVING
    assert lane.lane_offset_m == pytest.approx(0.5, abs=1e-3)
    assert lane.lane_heading_rad == pytest.approx(0.0, abs=1e-6)
    assert lane.lane_width_m == pytest.approx(LANE_M)
    assert not lane.in_junction
    assert lane.off_lane_m == 0.0


def test_across_the_middle_one_stands_against_the_lane(town: carla.Map) -> None:
    lane = at(town, 40.0, -LANE_M / 2.0 - 0.5)
    assert abs(lane.lane_heading_rad) == pytest.approx(math.pi, abs=1e-6)
    assert lane.lane_offset_m == pytest.approx(0.5, abs=1e-3)  # to the right of a lane that goes west


def test_in_the_middle_of_the_crossing_one_is_in_a_junction(town: carla.Map) -> None:
    assert at(town, 0.0, 1.0).in_junction


@pytest.mark.parametrize("beyond_m", [0.2, 1.5, 12.0])
def test_beside_the_road_there_is_no_lane_but_a_distance_to_its_edge(town: carla.Map, beyond_m: float) -> None:
    lane = at(town, 50.0, LANE_M + beyond_m)
    assert (lane.road_id, lane.lane_id, lane.lane_type) == (0, 0, 0)
    assert math.isnan(lane.lane_offset_m)
    assert lane.off_lane_m == pytest.approx(beyond_m, abs=1e-3)


def test_who_stands_still_is_not_looked_for_again(town: carla.Map) -> None:
    asked = []

    class Map:
        def get_waypoint(self, place: Any, **options: Any) -> Any:
            asked.append(place)
            return town.get_waypoint(place, **options)

    finder, there = LaneFinder(Map()), Ego(5.0, 1.0, 0.0, 0.0, 0.0, 0.0, *[0.0] * 9)
    first = finder.under(there)
    count = len(asked)
    assert finder.under(there) is first
    assert len(asked) == count
    assert finder.under(there._replace(y_m=1.5)).lane_offset_m != first.lane_offset_m
