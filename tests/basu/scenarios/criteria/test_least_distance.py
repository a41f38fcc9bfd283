"""Claims about the least distance: between boxes, to actors and to things, and with whom."""

import math

import pytest

from basu.scenarios.criteria import LeastDistance, Thing
from fakes.drives import at, driven, hit
from fakes.played import played
from fakes.rides import braked, eastward, moving, ride

CHILD = (9, moving(30.0, 3.0, 0.0, 0.0))  # a box 2.0 m to either end and 0.9 m to either side; the ego 2.0 m and 1.0 m


def test_passing_a_parked_box_the_gap_is_between_the_sides() -> None:
    said = LeastDistance(0.5).judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert said.passed is True
    assert said.measured == pytest.approx(3.0 - 1.0 - 0.9)
    assert said.other == "child"
    assert 2.6 <= (said.t_s or 0.0) <= 3.4
    assert "child (vehicle.audi.tt) was 1.10 m away" in said.sentence


def test_too_near_fails_and_the_limit_is_told() -> None:
    said = LeastDistance(1.5, to="child").judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert (said.passed, said.criterion, said.limit) == (False, "least distance to child", "at least 1.5 m")


def test_without_a_limit_it_only_tells() -> None:
    said = LeastDistance().judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert (said.passed, said.deciding) == (None, False)
    assert said.measured == pytest.approx(1.1)


def test_things_of_the_scenario_count_like_actors() -> None:
    cone = Thing("cone", 20.0, 1.6, 0.4, 0.2, 0.2)
    said = LeastDistance(0.5).judge(played(driven(at(10.0, 4.0)), things=(cone,)))
    assert said.other == "cone"
    assert said.measured == pytest.approx(1.6 - 1.0 - 0.2 * (math.cos(0.4) + math.sin(0.4)))  # to its corner
    assert said.passed is False


def test_only_the_one_that_is_asked_about_counts() -> None:
    case = played(
        ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD, (10, moving(30.0, -2.5, 0.0, 0.0))]),
        roles={9: "child", 10: "car"},
    )
    assert LeastDistance(to="child").judge(case).measured == pytest.approx(1.1)
    assert LeastDistance(to="car").judge(case).measured == pytest.approx(2.5 - 1.0 - 0.9)
    assert LeastDistance().judge(case).other == "car"


def test_who_comes_close_to_a_vehicle_at_rest_has_done_so_alone() -> None:
    """The ego stands from 2 s on, 8 m before; the other arrives at 5 s."""
    crossing = (9, moving(24.0, 40.0, 0.0, -8.0))
    case = played(ride(6.0, eastward(braked(10.0, 1.0, 10.0), 7.0), others=[crossing]))
    assert LeastDistance(1.0, while_moving=True).judge(case).measured == pytest.approx(22.0, abs=2.0)
    assert LeastDistance(8.0).judge(case).passed is False


def test_a_contact_is_no_distance_whatever_the_boxes_say() -> None:
    history = ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])
    said = LeastDistance(0.1).judge(played(history, collisions=(hit(59, "vehicle.audi.tt", 9),)))
    assert (said.measured, said.passed) == (0.0, False)


def test_alone_there_is_nothing_to_judge() -> None:
    assert LeastDistance(0.5).judge(played(driven(at(10.0, 4.0)))).passed is None
    said = LeastDistance(0.5, to="child").judge(played(driven(at(10.0, 4.0))))
    assert (said.passed, said.sentence) == (None, "child never was within 60 m of the ego")
    assert LeastDistance(0.5, since="end").judge(played(driven(at(10.0, 4.0)))).sentence == "'end' never began"


def test_a_contact_is_told_with_the_speed_before_it() -> None:
    history = ride(5.0, eastward(braked(10.0, 2.95, 100.0), 6.0), others=[CHILD])
    said = LeastDistance().judge(played(history, collisions=(hit(60, "vehicle.audi.tt", 9),)))
    assert said.sentence == "child (vehicle.audi.tt) was touched at 3.00 s, the ego at 10.00 m/s"


def test_a_thing_that_was_touched_was_no_distance_away_whatever_its_box() -> None:
    """The sensor names the actor that the thing is; its role is the thing's name."""
    door = Thing("door", 20.0, 2.5, 0.0, 0.1, 0.5)
    case = played(driven(at(10.0, 4.0)), roles={31: "door"}, things=(door,))
    assert LeastDistance().judge(case).measured == pytest.approx(1.0)
    case = played(case.history, roles={31: "door"}, things=(door,), collisions=(hit(38, "static.prop.sign", 31),))
    said = LeastDistance(0.1, to="door").judge(case)
    assert (said.measured, said.other, said.t_s) == (0.0, "door", pytest.approx(1.9))
