"""Tests of ``basu.scenarios.criteria.case_record``."""

import json
from pathlib import Path

import pytest

from basu.errors import UserError
from basu.outcome import Outcome, Status
from basu.records.history.files import write_history
from basu.scenarios.criteria import (
    Arrives,
    Gentle,
    HeedsStopSigns,
    InTime,
    KeepsLane,
    KeepsSpeed,
    LeastDistance,
    NoCollision,
    Played,
    StandingThing,
    reported_always,
)
from basu.scenarios.criteria.case_record import judgements_in, part_of, played_in
from fakes.drives import at, driven, hit, stop_sign, straight_route
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride

CRITERIA = [NoCollision(), Arrives(), InTime(6.0), KeepsLane(), KeepsSpeed(), HeedsStopSigns(), Gentle()]
CRITERIA += [LeastDistance(0.5, to="child"), *reported_always()]


def driven_case() -> Played:
    """A case with a touched actor, a thing, and an end by the clock."""
    return played(
        ride(6.0, eastward(braked(8.0, 3.0, 4.0), 7.0), others=[(9, moving(40.0, 9.0, 0.0, -2.0))]),
        outcome=Outcome(Status.SCENARIO_TIMEOUT, "not over after 6 s"),
        things=(StandingThing("barrier", 37.0, 0.3, 0.1, 0.5, 1.5),),
        collisions=(hit(90, "vehicle.audi.tt", 9),),
    )


def written(folder: Path, case: Played) -> Path:
    """The folder of a case, with all that matters here."""
    document = {
        "status": case.outcome.status.value,
        "message": "the verdict's own words",
        "ended": case.outcome.message,
        "phases_s": dict(case.phases_s),
        "judgements": [one.judge(case)._asdict() for one in CRITERIA],
        "actors": [{"id": key, "role": role, "type": "vehicle.audi.tt"} for key, role in case.roles.items()],
        "things": [thing._asdict() for thing in case.things],
        "timeout_s": case.timeout_s,
    }
    write_history(folder, case.history)
    (folder / "result.json").write_text(json.dumps(document), encoding="utf-8")
    return folder


def test_a_case_judged_again_from_its_folder_is_judged_the_same(tmp_path: Path) -> None:
    case = driven_case()
    again = played_in(written(tmp_path, case))
    assert again._replace(history=case.history) == case
    assert tuple(one.judge(again) for one in CRITERIA) == judgements_in(tmp_path)


def test_what_is_no_case_is_refused_in_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="holds no result that can be read"):
        played_in(tmp_path)
    written(tmp_path, driven_case())
    (tmp_path / "result.json").write_text('{"status": "Completed"}', encoding="utf-8")
    for read in (played_in, judgements_in):
        with pytest.raises(UserError, match="holds no case of a scenario"):
            read(tmp_path)


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
    """The walker beside the way at 30 m is passed before, the one at 120 m meanwhile."""
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
