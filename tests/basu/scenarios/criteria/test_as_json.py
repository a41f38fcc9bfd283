"""Claims about judging a case again from what was written of it."""

import json
from pathlib import Path

from basu.history.files import read_history, write_history
from basu.outcome import Outcome, Status
from basu.scenarios.criteria import (
    Arrives,
    Gentle,
    HeedsStopSigns,
    InTime,
    KeepsLane,
    KeepsSpeed,
    LeastDistance,
    NoCollision,
    Thing,
    told_always,
)
from basu.scenarios.criteria.as_json import judgement_from_json, judgement_to_json, played_from_json, played_to_json
from fakes.drives import hit
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride


def test_a_case_judged_again_from_its_folder_is_judged_the_same(tmp_path: Path) -> None:
    case = played(
        ride(6.0, eastward(braked(8.0, 3.0, 4.0), 7.0), others=[(9, moving(40.0, 9.0, 0.0, -2.0))]),
        outcome=Outcome(Status.SCENARIO_TIMEOUT, "not over after 6 s"),
        things=(Thing("barrier", 37.0, 0.3, 0.1, 0.5, 1.5),),
        collisions=(hit(90, "vehicle.audi.tt", 9),),
    )
    criteria = [NoCollision(), Arrives(), InTime(6.0), KeepsLane(), KeepsSpeed(), HeedsStopSigns(), Gentle()]
    criteria += [LeastDistance(0.5, to="child"), *told_always()]
    write_history(tmp_path, case.history)
    document = json.loads(json.dumps(played_to_json(case)))
    again = played_from_json(document, read_history(tmp_path))
    assert again._replace(history=case.history) == case
    assert [one.judge(again) for one in criteria] == [one.judge(case) for one in criteria]


def test_a_judgement_reads_back_as_it_was() -> None:
    case = played(ride(2.0, eastward(lambda _: 8.0, 3.0), others=[(9, moving(30.0, 2.0, 0.0, 0.0))]))
    for said in (LeastDistance(0.5).judge(case), HeedsStopSigns().judge(case)):
        assert judgement_from_json(json.loads(json.dumps(judgement_to_json(said)))) == said
