"""Claims about thinning a plan: against the obvious reading of the leaderboard's rule, and on its corner cases."""

import itertools

import carla
from hypothesis import given
from hypothesis import strategies as st

from basu_leaderboard.provided.planned_agent import RoadOption, downsample_route

FOLLOW, LEFT = RoadOption.LANEFOLLOW, RoadOption.LEFT
CHANGE = RoadOption.CHANGELANELEFT


def plan(options: list[RoadOption]) -> list[tuple[carla.Transform, RoadOption]]:
    """A point a metre, straight ahead."""
    return [(carla.Transform(carla.Location(float(x_m), 0.0, 0.0)), option) for x_m, option in enumerate(options)]


def test_a_straight_road_keeps_its_ends_and_a_point_behind_every_factor() -> None:
    # metres are added up where a point is left out: the first after more than ten of them is the twelfth
    assert downsample_route(plan([FOLLOW] * 31), 10.0) == [0, 12, 24, 30]


def test_points_where_the_option_changes_are_kept() -> None:
    assert downsample_route(plan([FOLLOW] * 5 + [LEFT] * 5 + [FOLLOW] * 5), 200.0) == [0, 5, 10, 14]


def test_all_points_of_a_lane_change_are_kept_and_the_one_behind_it_is_not() -> None:
    assert downsample_route(plan([FOLLOW] * 3 + [CHANGE] * 2 + [FOLLOW] * 3), 200.0) == [0, 3, 4, 7]


def test_a_plan_of_nothing_is_thinned_to_nothing() -> None:
    assert downsample_route([], 50.0) == []


@given(st.lists(st.sampled_from([FOLLOW, LEFT, CHANGE]), min_size=1, max_size=40), st.floats(0.0, 20.0))
def test_both_ends_and_every_turn_survive(options: list[RoadOption], factor_m: float) -> None:
    kept = downsample_route(plan(options), factor_m)
    assert kept == sorted(set(kept))
    assert {0, len(options) - 1} <= set(kept)
    turns = {
        index
        for index, (before, now) in enumerate(itertools.pairwise(options), start=1)
        if now != before and CHANGE not in {before, now}
    }
    assert turns <= set(kept)
