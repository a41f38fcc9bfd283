"""Claims about speeding: episodes, not frames; a stated tolerance; the limit that holds."""

import math

import pytest

from basu.metrics.score import score
from basu.metrics.scoring import TOLERANCE_MPS, Scoring
from basu.metrics.speeding import LEAST_S, SHARE_M, limits_mps, speeding
from fakes.drives import at, driven, straight_route


def test_driving_at_the_limit_and_within_the_tolerance_is_no_speeding() -> None:
    assert speeding(driven(at(11.0 + TOLERANCE_MPS, 10.0), limit_mps=11.0)) == ()


def test_an_episode_that_gains_little_is_one_infraction() -> None:
    (found,) = speeding(driven([*at(10.0, 1.0), *at(13.0, 8.0)], limit_mps=11.0))
    assert found.tick == 20
    assert found.speed_mps == pytest.approx(13.0)
    assert found.detail == "up to 13.00 m/s where 11.00 m/s are posted, for 8.0 s"


@pytest.mark.parametrize(
    ("speed_mps", "seconds", "number"),
    [(13.0, 16.0, 1), (13.0, 17.0, 2), (13.0, 33.0, 2), (13.0, 34.0, 3), (33.0, 1.4, 1), (33.0, 15.0, 10)],
)
def test_every_started_share_of_the_way_gained_is_an_infraction(speed_mps: float, seconds: float, number: int) -> None:
    """A share is 33.45 m: 2 m/s above the limit gain it in 16.7 s, 22 m/s in 1.5 s."""
    found = speeding(driven([*at(10.0, 1.0), *at(speed_mps, seconds)], limit_mps=11.0))
    assert len(found) == number == math.ceil((speed_mps - 11.0) * seconds / SHARE_M)
    assert [event.tick for event in found] == sorted({event.tick for event in found})


def test_three_times_the_limit_throughout_leaves_no_score() -> None:
    history = driven(at(33.0, 60.0), route=straight_route(2000.0))
    assert score(history, Scoring()).infraction < 1e-3


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
