"""Claims about a scenario met on a route: judged by its own part of the run."""

import pytest

from basu.scenarios.criteria import (
    Arrives,
    HeedsStopSigns,
    InTime,
    KeepsSpeed,
    LeastDistance,
    NoCollision,
    reported_always,
)
from basu.scenarios.criteria.records import part_of
from fakes.drives import at, driven, hit, stop_sign, straight_route
from fakes.played import played
from fakes.rides import eastward, moving, ride

ROUTE = straight_route(300.0, controls=(stop_sign(30.0), stop_sign(110.0, "8"), stop_sign(250.0, "9")))


def test_what_was_before_and_after_is_not_seen_and_times_stay_the_runs() -> None:
    run = driven(at(10.0, 25.0), route=ROUTE, collisions=[hit(20), hit(240), hit(480)])
    case = played(part_of(run, 160, 320, until_s_m=150.0), phases_s={"trigger": 8.0, "conflict": 10.0})
    said = NoCollision().judge(case)
    assert (said.t_s, said.x_m) == pytest.approx((12.0, 120.0))
    assert said.sentence.count("hit") == 1
    assert HeedsStopSigns().judge(case).other == "stop sign 8"
    assert KeepsSpeed(limit_mps=5.0, since="conflict").judge(case).t_s == pytest.approx(10.0)


def test_arriving_is_to_pass_the_scenarios_own_end() -> None:
    case = played(part_of(driven(at(10.0, 25.0), route=ROUTE), 160, 320, until_s_m=150.0))
    assert Arrives().judge(case).sentence == "it arrived after 6.80 s"
    assert InTime(7.0).judge(case).passed is True
    assert Arrives().judge(played(part_of(driven(at(10.0, 25.0), route=ROUTE), 160, 320))).passed is False


def test_margins_of_a_part_are_those_of_its_frames() -> None:
    """The one who stands beside the way at 30 m is passed before, the one at 120 m meanwhile."""
    others = [(9, moving(30.0, 2.5, 0.0, 0.0)), (10, moving(120.0, 4.0, 0.0, 0.0))]
    run = ride(25.0, eastward(lambda _: 10.0, 26.0), others=others, route=ROUTE)
    whole, case = played(run), played(part_of(run, 160, 320))
    assert LeastDistance().judge(whole).measured == pytest.approx(2.5 - 1.9)
    assert LeastDistance().judge(case).measured == pytest.approx(4.0 - 1.9)
    assert LeastDistance().judge(case).t_s == pytest.approx(12.0, abs=0.45)
    assert all(one.judge(case).t_s is None or one.judge(case).t_s >= 8.0 for one in reported_always())


def test_the_whole_is_its_own_part() -> None:
    run = driven(at(10.0, 25.0), route=ROUTE, collisions=[hit(20)])
    same = part_of(run, 0, len(run.frames), until_s_m=1e9)
    assert (same.frames == run.frames).all()
    assert same.facts.route.length_m == run.facts.route.length_m
    assert same.collisions == run.collisions
