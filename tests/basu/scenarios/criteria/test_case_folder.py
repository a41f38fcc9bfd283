"""Claims about judging a case again from its folder."""

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
    Thing,
    reported_always,
)
from basu.scenarios.criteria.records import judgements_in, played_in
from fakes.drives import hit
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride

CRITERIA = [NoCollision(), Arrives(), InTime(6.0), KeepsLane(), KeepsSpeed(), HeedsStopSigns(), Gentle()]
CRITERIA += [LeastDistance(0.5, to="child"), *reported_always()]


def driven_case() -> Played:
    """One with somebody who is touched, a thing, and an end by the clock."""
    return played(
        ride(6.0, eastward(braked(8.0, 3.0, 4.0), 7.0), others=[(9, moving(40.0, 9.0, 0.0, -2.0))]),
        outcome=Outcome(Status.SCENARIO_TIMEOUT, "not over after 6 s"),
        things=(Thing("barrier", 37.0, 0.3, 0.1, 0.5, 1.5),),
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
