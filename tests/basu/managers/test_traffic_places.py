"""Claims about where traffic begins: near the route, away from the vehicle under test, as many as a density says."""

import numpy as np
import pytest

from basu.managers.traffic_places import CLEAR_M, REACH_M, distance_m, suitable, vehicles_for
from fakes.drives import straight_route

ROUTE_M = straight_route(1000.0).points_m[:, :2]


def test_the_distance_is_that_to_the_nearest_part_of_the_route() -> None:
    random = np.random.default_rng(5)
    places_m = random.uniform(-800.0, 1800.0, (200, 2))
    inside = np.clip(places_m[:, 0], 0.0, 1000.0)
    exact_m = np.hypot(places_m[:, 0] - inside, places_m[:, 1])
    found_m = distance_m(places_m, ROUTE_M)
    assert (found_m >= exact_m - 1e-9).all()
    assert found_m[exact_m > 50.0] == pytest.approx(exact_m[exact_m > 50.0], abs=0.3)


def test_places_are_within_reach_and_away_from_the_start() -> None:
    places_m = np.array(
        [
            [0.0, CLEAR_M - 1.0],
            [0.0, CLEAR_M + 1.0],
            [500.0, REACH_M - 1.0],
            [500.0, REACH_M + 2.0],
            [-REACH_M - 9.0, 0.0],
        ]
    )
    assert suitable(places_m, ROUTE_M, (0.0, 0.0)).tolist() == [1, 2]


def test_a_density_is_vehicles_on_a_kilometre_of_lane() -> None:
    assert [vehicles_for(density, 12.0) for density in (0.0, 2.5, 5.0)] == [0, 30, 60]


def test_no_places_are_no_mistake() -> None:
    assert suitable(np.empty((0, 2)), ROUTE_M, (0.0, 0.0)).tolist() == []
