"""Claims about progress: monotone enough, sideways signed, and not led astray by a route that meets itself."""

from dataclasses import replace

import numpy as np
import pytest

from basu.routing import Route
from basu.routing.planned_route import Progress, advance
from fakes.drives import straight_route


def followed(route: Route, path_m: np.ndarray) -> list[Progress]:
    places = [Progress.at_start()]
    for x_m, y_m in path_m:
        places.append(advance(route, places[-1], float(x_m), float(y_m)))
    return places[1:]


def there_and_back() -> Route:
    """100 m east, then back west 4 m to the south."""
    east = np.column_stack([np.arange(0.0, 101.0), np.zeros(101)])
    west = np.column_stack([np.arange(100.0, -1.0, -1.0), np.full(101, 4.0)])
    plane = np.vstack([east, west])
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(plane, axis=0).T))])
    return replace(straight_route(), points_m=np.column_stack([plane, np.zeros(len(plane))]), s_m=s_m)


def test_the_place_is_projected_between_the_points() -> None:
    (place,) = followed(straight_route(), np.array([[12.3, 0.0]]))
    assert place.s_m == pytest.approx(12.3)
    assert place.distance_m == pytest.approx(0.0)


def test_south_of_an_eastbound_route_is_to_its_right() -> None:
    right, left = followed(straight_route(), np.array([[10.0, 1.5], [11.0, -0.5]]))
    assert right.lateral_m == pytest.approx(1.5)
    assert left.lateral_m == pytest.approx(-0.5)


def test_the_way_back_beside_the_way_there_is_not_mistaken_for_it() -> None:
    route = there_and_back()
    places = followed(route, route.points_m[:, :2] + (0.0, 1.9))  # on the way there, nearly as near to the way back
    assert np.allclose([place.s_m for place in places], route.s_m, atol=2.5)


def test_a_lap_ends_at_its_end_although_it_begins_there() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 315)
    plane = 50.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    s_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(plane, axis=0).T))])
    lap = replace(straight_route(), points_m=np.column_stack([plane, np.zeros(315)]), s_m=s_m)
    places = followed(lap, plane)
    assert places[0].s_m == pytest.approx(0.0, abs=1e-6)
    assert places[-1].s_m == pytest.approx(lap.length_m, abs=1e-6)


def test_beyond_the_end_the_place_is_the_end() -> None:
    places = followed(straight_route(50.0), np.column_stack([np.arange(0.0, 70.0, 2.0), np.zeros(35)]))
    assert places[-1].s_m == pytest.approx(50.0)
    assert places[-1].distance_m == pytest.approx(18.0)


def test_going_round_something_large_finds_the_route_again() -> None:
    x_m = np.arange(0.0, 160.0, 0.5)
    y_m = np.where((x_m > 20.0) & (x_m < 120.0), 15.0, 0.0)
    places = followed(straight_route(), np.column_stack([x_m, y_m]))
    assert places[-1].s_m == pytest.approx(159.5)
