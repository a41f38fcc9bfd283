"""Claims about what is told of every case."""

from basu.scenarios.criteria import LeastDistance, LeastTtc, NoCollision, margins_of, reported_always
from fakes.drives import at, driven
from fakes.played import judgement, played
from fakes.rides import eastward, moving, ride


def test_the_three_margins_are_told_of_every_case_and_decide_none() -> None:
    told = reported_always([NoCollision()])
    assert [one.name for one in told] == ["least distance", "least time to collision", "post-encroachment time"]
    assert not any(one.deciding for one in told)


def test_what_the_scenario_asks_of_everybody_is_not_told_twice() -> None:
    told = reported_always([LeastDistance(0.5), LeastTtc(1.0, to="child")])
    assert [one.name for one in told] == ["least time to collision", "post-encroachment time"]


def test_the_margins_of_a_drive_are_figures_or_nothing() -> None:
    case = played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[(9, moving(30.0, 3.0, 0.0, 0.0))]))
    margins = margins_of([one.judge(case) for one in reported_always()])
    assert margins["ttc_s"] is margins["pet_s"] is None
    assert round(margins["distance_m"] or 0.0, 6) == 1.1
    alone = played(driven(at(5.0, 2.0)))
    assert margins_of([one.judge(alone) for one in reported_always()]) == {
        "distance_m": None,
        "ttc_s": None,
        "pet_s": None,
    }


def test_the_least_of_several_is_taken_and_other_figures_are_not() -> None:
    said = [
        judgement("least distance", measured=0.8),
        judgement("least distance to child", measured=0.6),
        judgement("no collision", measured=0.1),
        judgement("least time to collision to child", measured=2.0),
    ]
    assert margins_of(said) == {"distance_m": 0.6, "ttc_s": 2.0, "pet_s": None}
