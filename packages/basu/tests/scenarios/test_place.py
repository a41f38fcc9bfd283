"""Claims about a place: poses seen from the trigger point along the ego's route."""

import math

import numpy as np
import pytest

from basu.errors import ScenarioError
from basu.testing import offline_place

ARC = [(30.0 * math.sin(a), 30.0 - 30.0 * math.cos(a)) for a in np.linspace(0.0, math.pi / 2.0, 90)]  # to the right


def test_ahead_counts_from_the_trigger_point() -> None:
    place = offline_place([(0.0, 0.0), (100.0, 0.0)], trigger_s_m=20.0)
    assert place.at(15.0)[:2] == pytest.approx((35.0, 0.0))
    assert place.left_m == pytest.approx(80.0)


def test_right_is_south_of_an_ego_that_drives_east_and_turned_is_clockwise() -> None:
    pose = offline_place([(0.0, 0.0), (100.0, 0.0)]).at(10.0, 3.0, 90.0)
    assert pose[:2] == pytest.approx((10.0, 3.0))
    assert pose.yaw_rad == pytest.approx(math.pi / 2.0)


def test_beyond_both_ends_of_the_route_it_goes_straight_on() -> None:
    place = offline_place(ARC, trigger_s_m=5.0)
    assert place.at(-15.0)[:2] == pytest.approx((-10.0, 0.0), abs=0.1)
    end = place.at(place.left_m + 10.0)
    assert end[:2] == pytest.approx((30.0, 40.0), abs=0.15)
    assert end.yaw_rad == pytest.approx(math.pi / 2.0, abs=0.02)


def test_a_heading_turns_with_the_route_and_stays_within_half_a_turn() -> None:
    place = offline_place([*ARC, (30.0, 200.0)])
    assert place.heading_rad(30.0 * math.pi / 4.0) == pytest.approx(math.pi / 4.0, abs=0.03)
    assert all(abs(place.at(s, 0.0, 170.0).yaw_rad) <= math.pi for s in range(60))


def test_the_width_is_that_of_the_routes_lane() -> None:
    assert offline_place([(0.0, 0.0), (50.0, 0.0)], lane_width_m=3.1).width_m(70.0) == 3.1


def test_what_only_a_map_knows_is_refused_without_one() -> None:
    with pytest.raises(ScenarioError, match="'offline' was not laid on a map"):
        offline_place([(0.0, 0.0), (50.0, 0.0)]).waypoint(10.0)
