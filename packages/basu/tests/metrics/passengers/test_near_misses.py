"""Claims about near misses: times to collision and post-encroachment times of drives with known answers."""

import math
from dataclasses import replace

import pytest

from basu.metrics.passengers.near_misses import near_misses
from basu.records.history import History
from fakes.drives import hit
from fakes.rides import braked, circling, eastward, moving, ride


def test_braking_hard_for_a_parked_car_the_least_time_to_collision_is_on_the_way() -> None:
    """5 m/s² from 10 m/s to rest 4 m short: 4 / v + v / 10 s at a speed of v, least at v = sqrt(40), sqrt(1.6) s."""
    parked = moving(10.0 * 2.0 + 10.0 + 2.0 + 4.0 + 2.0, 0.0, 0.0, 0.0)
    (party,) = near_misses(ride(6.0, eastward(braked(10.0, 2.0, 5.0), 6.0), others=[(9, parked)]))
    assert party.ttc_s == pytest.approx(math.sqrt(1.6), abs=0.005)
    assert party.ttc_tick == pytest.approx((2.0 + (10.0 - math.sqrt(40.0)) / 5.0) / 0.05, abs=1)
    assert party.is_near_miss
    assert party.pet_s == math.inf
    assert party.detail.startswith("vehicle.audi.tt (actor 9): 1.2")
    assert party.detail.endswith(" s, at 6.2 and 0.0 m/s")


def test_stopping_gently_behind_an_actor_is_no_near_miss() -> None:
    """1 m/s² to rest 2 m behind: at a speed of v there are 2 / v + v / 2 s left, at least 2."""
    parked = moving(10.0 + 18.0 + 2.0 + 2.0 + 2.0, 0.0, 0.0, 0.0)
    (party,) = near_misses(ride(10.0, eastward(braked(6.0, 10.0 / 6.0, 1.0), 10.0), others=[(9, parked)]))
    assert party.ttc_s == pytest.approx(2.0, abs=0.05)
    assert not party.is_near_miss


def test_passing_an_actor_in_the_next_lane_is_nothing() -> None:
    assert near_misses(ride(6.0, eastward(lambda _: 10.0, 6.0), others=[(9, moving(60.0, 3.0, -10.0, 0.0))])) == ()


def test_in_a_bend_that_stands_straight_ahead_is_in_no_danger() -> None:
    """The car stands 8 m ahead on the tangent; the vehicle turns away on a radius of 8 m."""
    parked = moving(11.0, -1.0, 0.0, 0.0)
    assert near_misses(ride(1.5, circling(8.0, 5.0), others=[(9, parked)], sizes={9: (0.5, 0.5)})) == ()


@pytest.mark.parametrize(("after_s", "near"), [(1.0, True), (2.5, False)])
def test_an_actor_that_crosses_behind_one_is_reported_by_the_post_encroachment_time(after_s: float, near: bool) -> None:  # noqa: FBT001
    """The vehicle's tail leaves the crossing's strip at x = 20.9 + 2 m; the other's nose is there ``after_s`` later."""
    leaves_s = (20.9 + 2.0) / 10.0
    crossing = moving(20.0, 1.0 + 2.0 + 8.0 * (leaves_s + after_s), 0.0, -8.0)
    (party,) = near_misses(ride(8.0, eastward(lambda _: 10.0, 9.0), others=[(9, crossing)]))
    assert party.pet_s == pytest.approx(after_s, abs=0.06)
    assert party.is_near_miss is near
    assert party.pet_tick == pytest.approx((leaves_s + after_s) / 0.05, abs=2)


def test_following_in_a_lane_has_no_post_encroachment_time() -> None:
    leader = moving(14.0, 0.0, 10.0, 0.0)
    assert near_misses(ride(4.0, eastward(lambda _: 10.0, 5.0), others=[(9, leader)])) == ()


def test_an_actor_that_was_hit_was_not_missed() -> None:
    history = ride(3.0, eastward(lambda _: 10.0, 4.0), others=[(9, moving(25.0, 0.0, 0.0, 0.0))])
    assert len(near_misses(history)) == 1
    struck = History(
        facts=history.facts,
        frames=history.frames,
        others=history.others,
        collisions=(hit(40, "vehicle.audi.tt", other_id=9),),
        lane_invasions=(),
    )
    assert near_misses(struck) == ()


def test_alone_there_is_no_actor_to_miss() -> None:
    assert near_misses(ride(1.0, eastward(lambda _: 10.0, 2.0))) == ()


@pytest.mark.parametrize(("speed_mps", "is_near_miss"), [(2.5, False), (8.0, True)])
def test_to_come_close_to_a_thing_slowly_is_no_near_miss(speed_mps: float, *, is_near_miss: bool) -> None:
    """At 2.5 m/s, 1.2 s from it, 1.0 m/s² would do; at 8 m/s 3.3 m/s² would be needed."""
    seconds = 3.0
    ahead_m = speed_mps * (seconds + 1.2) + 2.0 + 2.0
    history = ride(seconds, eastward(lambda _: speed_mps, 4.0), others=[(9, moving(ahead_m, 0.0, 0.0, 0.0))])
    facts = replace(history.facts, actor_types={9: "static.prop.streetbarrier"})
    parties = near_misses(replace(history, facts=facts))
    assert any(party.is_near_miss for party in parties) is is_near_miss
