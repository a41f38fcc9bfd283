"""Claims about collisions in a scenario: parties, times, speeds, and resting vehicles."""

import pytest

from basu.scenarios.criteria import NoCollision
from fakes.drives import at, driven, hit
from fakes.played import played
from fakes.rides import eastward, moving, ride


def test_touching_no_actor_passes() -> None:
    said = NoCollision().judge(played(driven(at(5.0, 4.0))))
    assert said.passed is True
    assert said.sentence == "it touched no actor and no thing"


def test_a_contact_is_known_by_role_with_both_speeds_and_the_place() -> None:
    history = ride(4.0, eastward(lambda _: 8.0, 5.0), others=[(9, moving(20.0, 3.0, 0.0, -1.5))])
    touched = tuple(hit(tick, "walker.pedestrian.0012", other_id=9) for tick in range(40, 50))
    said = NoCollision().judge(played(history, collisions=touched))
    assert said.passed is False
    assert said.other == "child"
    assert said.measured == pytest.approx(8.0)
    assert (said.t_s, said.x_m) == pytest.approx((2.0, 16.0))
    assert said.sentence == (
        "hit child (walker.pedestrian.0012), which had 1.50 m/s, at 2.00 s at 8.00 m/s with an impulse of 100 N s"
    )


def test_messages_of_one_contact_are_one_and_scenery_is_known_by_its_kind() -> None:
    history = driven(at(5.0, 10.0), collisions=[hit(tick) for tick in [*range(40, 60), 120]])
    said = NoCollision().judge(played(history))
    assert said.other == "static.poles"
    assert said.sentence.count("hit static.poles") == 2


def test_many_contacts_are_counted_after_the_third() -> None:
    history = driven(at(5.0, 30.0), collisions=[hit(tick) for tick in range(40, 440, 50)])
    assert NoCollision().judge(played(history)).sentence.endswith("; and 5 more")


@pytest.mark.parametrize(("counts", "passed"), [(True, False), (False, True)])
def test_that_stands_and_is_touched_is_reported_and_may_be_forgiven(counts: bool, passed: bool) -> None:  # noqa: FBT001
    history = driven(at(0.0, 4.0), collisions=[hit(40, "vehicle.audi.tt", 9)])
    said = NoCollision(standing_counts=counts).judge(played(history))
    assert said.passed is passed
    assert said.sentence.startswith("was touched by child (vehicle.audi.tt) at 2.00 s at 0.00 m/s")


def test_actors_that_the_scenario_excepts_may_be_touched_and_others_not() -> None:
    history = driven(at(5.0, 4.0), collisions=[hit(30, "vehicle.audi.tt", 9), hit(60)])
    said = NoCollision(except_with=["child"]).judge(played(history))
    assert (said.passed, said.other, said.t_s) == (False, "static.poles", pytest.approx(3.0))
