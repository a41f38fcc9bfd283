"""Claims about speeding: episodes, not frames; a stated tolerance; the limit that holds."""

import math

import pytest

from basu.metrics.scoring import TOLERANCE_MPS
from basu.metrics.speeding import LEAST_S, limits_mps, speeding
from fakes.drives import at, driven, straight_route


def test_driving_at_the_limit_and_within_the_tolerance_is_no_speeding() -> None:
    assert speeding(driven(at(11.0 + TOLERANCE_MPS, 10.0), limit_mps=11.0)) == ()


def test_one_episode_however_long_is_one_infraction() -> None:
    (found,) = speeding(driven([*at(10.0, 1.0), *at(13.0, 8.0)], limit_mps=11.0))
    assert found.tick == 20
    assert found.speed_mps == pytest.approx(13.0)
    assert found.detail == "up to 13.00 m/s where 11.00 m/s are posted, for 8.0 s"


def test_swinging_about_the_tolerance_is_one_episode_until_the_limit_is_kept_again() -> None:
    wave = [*at(13.0, 1.0), *at(11.5, 1.0), *at(13.0, 1.0)]
    assert len(speeding(driven(wave, limit_mps=11.0))) == 1
    assert len(speeding(driven([*wave, *at(10.9, 1.0), *at(13.0, 1.0)], limit_mps=11.0))) == 2


def test_an_excess_of_a_moment_is_forgiven() -> None:
    assert speeding(driven([*at(10.0, 1.0), *at(13.0, LEAST_S - 0.1), *at(10.0, 1.0)], limit_mps=11.0)) == ()


def test_on_the_planned_lane_its_own_limit_holds_whatever_lies_over_it() -> None:
    route = straight_route(limit_mps=11.0)
    assert speeding(driven(at(10.0, 5.0), route=route, limit_mps=5.0)) == ()
    assert len(speeding(driven(at(13.0, 5.0), route=route, limit_mps=20.0))) == 1


def test_off_the_planned_lane_the_simulators_limit_holds() -> None:
    route = straight_route(limit_mps=20.0)
    assert len(speeding(driven(at(10.0, 5.0), route=route, limit_mps=5.0, lateral_m=3.0))) == 1


def test_where_the_map_posts_none_the_simulators_limit_holds() -> None:
    route = straight_route(limit_mps=math.nan)
    assert len(speeding(driven(at(10.0, 5.0), route=route, limit_mps=5.0))) == 1


def test_without_any_limit_nothing_is_too_fast() -> None:
    history = driven(at(40.0, 4.0), route=straight_route(limit_mps=math.nan))
    assert limits_mps(history).tolist() == [math.inf] * 80
    assert speeding(history) == ()
