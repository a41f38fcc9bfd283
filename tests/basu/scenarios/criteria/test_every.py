"""Claims about all criteria alike: the shortest records, and words for whatever they say."""

import pytest

from basu.scenarios import criteria
from basu.scenarios.criteria import Criterion, Thing
from fakes.drives import hit
from fakes.played import played
from fakes.rides import eastward, moving, ride

EVERY: list[Criterion] = [
    criteria.Arrives(),
    criteria.Gentle(),
    criteria.HeedsRedLights(),
    criteria.HeedsStopSigns(),
    criteria.InTime(),
    criteria.KeepsHeadway(1.0),
    criteria.KeepsLane(),
    criteria.KeepsLane(passing=True),
    criteria.KeepsSpeed(),
    criteria.LeastDistance(0.5),
    criteria.LeastTtc(1.0),
    criteria.MinimumSpeed(1.0),
    criteria.NoCollision(),
    criteria.Pet(1.0),
    criteria.Reaches(5.0),
    criteria.ReachesPoint(5.0, 0.0, 1.0),
    criteria.Regains(after="trigger"),
    criteria.StoppedFor("child"),
    criteria.StoppedFor("the line", s_m=9.0),
]


def test_every_criterion_of_the_package_is_here() -> None:
    classes = {value for value in vars(criteria).values() if isinstance(value, type) and issubclass(value, Criterion)}
    assert classes - {Criterion} == {type(one) for one in EVERY}


@pytest.mark.parametrize("criterion", EVERY, ids=lambda one: one.name)
@pytest.mark.parametrize("frames", [1, 2, 3, 5, 40])
@pytest.mark.parametrize("alone", [True, False])
def test_records_of_any_length_are_judged_in_words(criterion: Criterion, frames: int, alone: bool) -> None:  # noqa: FBT001
    """Plain values, a sentence without figures that are none, and a limit for whatever decides."""
    others = [] if alone else [(9, moving(12.0, 1.0, -1.0, 0.0))]
    history = ride(frames * 0.05 + 1e-3, eastward(lambda _: 10.0, 3.0), others=others)
    assert len(history.frames) == frames
    contact = () if alone else (hit(frames - 1, "vehicle.audi.tt", 9),)
    things = () if alone else (Thing("cone", 9.0, 3.0, 0.0, 0.2, 0.2),)
    said = criterion.judge(played(history, things=things, collisions=contact))
    assert said.sentence
    assert "nan" not in said.sentence
    assert "inf" not in said.sentence
    assert type(said.passed) in (bool, type(None))
    assert type(said.measured) in (float, type(None))
    assert {type(value) for value in (said.t_s, said.x_m, said.y_m, said.speed_mps)} <= {float, type(None)}
    assert said.passed is None or said.limit
