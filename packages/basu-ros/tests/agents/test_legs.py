"""The goals of a route for a planner that takes one at a time."""

import numpy as np
import pytest

from basu.routing.planned_route import Route
from basu_ros.agents.legs import AHEAD_M, LEG_M, Legs, goals_of
from driving_plant import make_route

RADIUS_M = 300.0


def round_trip(part: float = 1.0) -> Route:
    """A circle, or a part of it, with a point a metre."""
    count = int(2.0 * np.pi * RADIUS_M * part)
    angle = np.linspace(0.0, 2.0 * np.pi * part, count)
    return make_route(RADIUS_M * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle]))


def test_the_goal_of_a_route_that_leads_elsewhere_is_its_end() -> None:
    route = round_trip(0.7)
    assert goals_of(route) == [len(route.s_m) - 1]


def test_a_round_has_goals_on_the_way_and_none_in_a_junction() -> None:
    route = round_trip()
    route.is_junction[460:480] = True
    goals = goals_of(route)
    assert goals[-1] == len(route.s_m) - 1
    assert np.diff([0.0, *route.s_m[goals]]) == pytest.approx(np.full(4, route.length_m / 4), abs=15.0)
    assert np.diff([0.0, *route.s_m[goals]]).max() < LEG_M
    assert not route.is_junction[goals].any()
    assert goals[0] in {459, 480}


def test_each_goal_is_due_once_and_in_order_as_the_vehicle_comes_near_the_one_before() -> None:
    """At the start of a round the vehicle stands at its end too, which must not count."""
    route = round_trip()
    goals = goals_of(route)
    legs, sent = Legs(route), []
    assert legs.goal == goals[0]
    for number, (x_m, y_m) in enumerate(route.points_m[:, :2]):
        due = legs.advance(x_m, y_m + 1.5)
        if due is not None:
            sent.append((due, route.s_m[number]))
    assert [due for due, _ in sent] == goals[1:]
    for (_, s_m), before in zip(sent, goals, strict=False):
        assert route.s_m[before] - s_m == pytest.approx(AHEAD_M, abs=4.0)


def test_a_vehicle_that_stands_gets_no_further_goal() -> None:
    route = round_trip()
    legs = Legs(route)
    assert [legs.advance(*route.points_m[0, :2]) for _ in range(100)] == [None] * 100
