"""Tests of ``basu.scenarios.criteria.surrogate_measures``."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from shapely import Polygon, affinity

from basu.errors import ScenarioError
from basu.scenarios.criteria import KeepsHeadway, LeastDistance, LeastTtc, Pet, StandingThing
from basu.scenarios.criteria.surrogate_measures import gap_m
from fakes.drives import at, driven, hit
from fakes.played import played
from fakes.rides import Row, braked, eastward, moving, ride

CHILD = (9, moving(30.0, 3.0, 0.0, 0.0))  # a box 2.0 m to either end and 0.9 m to either side; the ego 2.0 m and 1.0 m


def test_passing_a_parked_box_the_gap_is_between_the_sides() -> None:
    said = LeastDistance(0.5).judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert said.passed is True
    assert said.measured == pytest.approx(3.0 - 1.0 - 0.9)
    assert said.other == "child"
    assert 2.6 <= (said.t_s or 0.0) <= 3.4
    assert "child (vehicle.audi.tt) was 1.10 m away" in said.sentence


def test_too_near_fails_and_the_limit_is_reported() -> None:
    said = LeastDistance(1.5, to="child").judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert (said.passed, said.criterion, said.limit) == (False, "least distance to child", "at least 1.5 m")


def test_without_a_limit_it_only_tells() -> None:
    said = LeastDistance().judge(played(ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD])))
    assert (said.passed, said.deciding) == (None, False)
    assert said.measured == pytest.approx(1.1)


def test_things_of_the_scenario_count_like_actors() -> None:
    cone = StandingThing("cone", 20.0, 1.6, 0.4, 0.2, 0.2)
    said = LeastDistance(0.5).judge(played(driven(at(10.0, 4.0)), things=(cone,)))
    assert said.other == "cone"
    assert said.measured == pytest.approx(1.6 - 1.0 - 0.2 * (math.cos(0.4) + math.sin(0.4)))  # to its corner
    assert said.passed is False


def test_only_the_chosen_actor_counts() -> None:
    case = played(
        ride(5.0, eastward(lambda _: 10.0, 6.0), others=[CHILD, (10, moving(30.0, -2.5, 0.0, 0.0))]),
        roles={9: "child", 10: "car"},
    )
    assert LeastDistance(to="child").judge(case).measured == pytest.approx(1.1)
    assert LeastDistance(to="car").judge(case).measured == pytest.approx(2.5 - 1.0 - 0.9)
    assert LeastDistance().judge(case).other == "car"


def test_an_ego_that_comes_close_to_a_vehicle_at_rest_has_done_so_alone() -> None:
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


def test_a_contact_is_reported_with_the_speed_before_it() -> None:
    history = ride(5.0, eastward(braked(10.0, 2.95, 100.0), 6.0), others=[CHILD])
    said = LeastDistance().judge(played(history, collisions=(hit(60, "vehicle.audi.tt", 9),)))
    assert said.sentence == "child (vehicle.audi.tt) was touched at 3.00 s, the ego at 10.00 m/s"


def test_a_thing_that_was_touched_was_no_distance_away_whatever_its_box() -> None:
    """The sensor names the actor that the thing is; its role is the thing's name."""
    door = StandingThing("door", 20.0, 2.5, 0.0, 0.1, 0.5)
    case = played(driven(at(10.0, 4.0)), roles={31: "door"}, things=(door,))
    assert LeastDistance().judge(case).measured == pytest.approx(1.0)
    case = played(case.history, roles={31: "door"}, things=(door,), collisions=(hit(38, "static.prop.sign", 31),))
    said = LeastDistance(0.1, to="door").judge(case)
    assert (said.measured, said.other, said.t_s) == (0.0, "door", pytest.approx(1.9))


def test_towards_an_actor_at_rest_it_is_the_gap_over_the_speed() -> None:
    """At 8 m/s from 0: after 3 s the front is at 26 m, the other's rear at 38 m."""
    said = LeastTtc(1.0).judge(played(ride(3.05, eastward(lambda _: 8.0, 4.0), others=[(9, moving(40.0, 0.0, 0, 0))])))
    assert said.measured == pytest.approx(12.0 / 8.0, abs=1e-6)
    assert (said.passed, said.t_s) == (True, pytest.approx(3.0))
    assert said.sentence == (
        "child (vehicle.audi.tt) was 1.50 s from a collision at 3.00 s, the ego at 8.00 m/s and the other at 0.00 m/s"
    )


def test_towards_each_other_both_speeds_count() -> None:
    """After 1 s the front is at 12 m and the other's at 60 - 2 - 6 = 52 m; they close at 16 m/s."""
    oncoming = (9, moving(60.0, 0.0, -6.0, 0.0))
    said = LeastTtc().judge(played(ride(1.05, eastward(lambda _: 10.0, 2.0), others=[oncoming])))
    assert said.measured == pytest.approx(40.0 / 16.0, abs=1e-6)


def test_on_crossing_courses_the_clock_runs_down_to_the_contact() -> None:
    """The front comes to the other's strip (x = 29.1) after 2.71 s, its nose is then 0.5 m into the ego's already."""
    touch_s = (30.0 - 0.9 - 2.0) / 10.0
    crossing = (9, moving(30.0, 1.0 + 2.0 - 0.5 + 8.0 * touch_s, 0.0, -8.0))
    said = LeastTtc(1.0).judge(played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[crossing])))
    assert said.measured == pytest.approx(touch_s - 1.95, abs=1e-6)
    assert said.passed is False


def test_braking_in_front_of_an_actor_it_is_least_on_the_way() -> None:
    """5 m/s² from 10 m/s to rest 4 m short: 4 / v + v / 10 at a speed of v, least at v = sqrt(40)."""
    parked = (9, moving(20.0 + 10.0 + 2.0 + 4.0 + 2.0, 0.0, 0.0, 0.0))
    said = LeastTtc().judge(played(ride(6.0, eastward(braked(10.0, 2.0, 5.0), 6.0), others=[parked])))
    assert said.measured == pytest.approx(math.sqrt(1.6), abs=0.005)


def test_things_are_run_towards_like_actors() -> None:
    said = LeastTtc(2.0).judge(
        played(driven(at(10.0, 2.05)), things=(StandingThing("barrier", 30.5, 0.0, 0.0, 0.5, 1.0),))
    )
    assert (said.other, said.passed) == ("barrier", False)
    assert said.measured == pytest.approx((30.0 - 22.0) / 10.0, abs=1e-6)


def test_beyond_five_seconds_nothing_is_measured_and_the_limit_is_kept() -> None:
    case = played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, moving(40.0, 6.0, 10.0, 0.0))]))
    said = LeastTtc(1.0).judge(case)
    assert (said.passed, said.measured, said.sentence) == (True, None, "it never was below 5 s")
    assert LeastTtc().judge(case).passed is None


def test_an_ego_that_was_touched_was_no_time_away() -> None:
    history = ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, moving(40.0, 6.0, 10.0, 0.0))])
    said = LeastTtc(0.5).judge(played(history, collisions=(hit(30, "vehicle.audi.tt", 9),)))
    assert (said.measured, said.passed, said.t_s) == (0.0, False, pytest.approx(1.5))


def test_a_limit_that_is_never_measured_is_refused() -> None:
    with pytest.raises(ScenarioError, match="cannot be held against 6 s: it is measured from 0 to 5 s"):
        LeastTtc(6.0)


LEAVES_S = (20.9 + 2.0) / 10.0  # when the ego's tail is past the strip that a crossing at x = 20 m sweeps


def across_at_rest(_: float) -> Row:
    """An actor that stands across the road."""
    return {"x_m": 24.0, "yaw_rad": math.pi / 2.0}


@pytest.mark.parametrize("after_s", [0.5, 1.2, 3.0, 4.5])
def test_an_ego_that_comes_after_the_ego_comes_so_much_later(after_s: float) -> None:
    crossing = (9, moving(20.0, 1.0 + 2.0 + 8.0 * (LEAVES_S + after_s), 0.0, -8.0))
    said = Pet(1.0).judge(played(ride(9.0, eastward(lambda _: 10.0, 10.0), others=[crossing])))
    assert said.measured == pytest.approx(after_s, abs=0.06)
    assert said.passed is (after_s >= 1.0)
    assert said.t_s == pytest.approx(LEAVES_S + after_s, abs=0.1)
    assert said.other == "child"


def test_an_ego_that_goes_before_the_ego_counts_as_well() -> None:
    """Its tail leaves the ego's strip (y = -1) at 1 s; the ego's front comes to its own (x = 19.1) 0.71 s later."""
    crossing = (9, moving(20.0, -1.0 - 2.0 + 8.0, 0.0, -8.0))
    said = Pet().judge(played(ride(4.0, eastward(lambda _: 10.0, 5.0), others=[crossing])))
    assert said.measured == pytest.approx((20.0 - 0.9 - 2.0) / 10.0 - 1.0, abs=0.06)


def test_an_ego_that_follows_in_the_lane_crosses_nobodys_way() -> None:
    case = played(ride(4.0, eastward(lambda _: 10.0, 5.0), others=[(9, moving(12.0, 0.0, 10.0, 0.0))]))
    assert Pet(1.0).judge(case).measured is None


@pytest.mark.parametrize(
    ("moves", "measured"),
    [(moving(24.0, 4.0, 0.0, -4.0), 0.0), (moving(24.0, 4.0, 4.0, 0.0), None), (across_at_rest, None)],
    ids=["across", "ahead", "standing across"],
)
def test_an_ego_that_was_hit_coming_across_the_way_was_no_time_apart(
    moves: Callable[[float], Row], measured: float | None
) -> None:
    history = ride(1.0, eastward(lambda _: 10.0, 2.0), others=[(9, moves)])
    said = Pet().judge(played(history, collisions=(hit(18, "vehicle.audi.tt", 9),)))
    assert said.measured == measured
    assert ("was touched" if measured == 0.0 else "no actor crossed its way within 5 s") in said.sentence


def test_it_is_the_gap_between_the_bumpers_over_the_egos_speed() -> None:
    case = played(ride(3.0, eastward(lambda _: 10.0, 4.0), others=[(9, moving(20.0, 0.0, 10.0, 0.0))]))
    said = KeepsHeadway(2.0, to="child").judge(case)
    assert said.measured == pytest.approx((20.0 - 2.0 - 2.0) / 10.0)
    assert (said.passed, said.criterion) == (False, "headway to child")


@pytest.mark.parametrize(
    "other",
    [moving(-10.0, 0.0, 10.0, 0.0), moving(20.0, 2.0, 10.0, 0.0), moving(90.0, 0.0, -10.0, 0.0)],
    ids=["behind", "beside", "oncoming"],
)
def test_an_ego_that_is_not_ahead_the_same_way_has_none(other: object) -> None:
    case = played(ride(2.0, eastward(lambda _: 10.0, 3.0), others=[(9, other)]))  # type: ignore[list-item]
    assert KeepsHeadway(1.0).judge(case).measured is None


def test_a_slanting_leader_reaches_back_with_its_corner() -> None:
    slanted = moving(20.0, 0.0, 10.0 * math.cos(0.3), 10.0 * math.sin(0.3))
    said = KeepsHeadway().judge(played(ride(0.1, eastward(lambda _: 10.0, 1.0), others=[(9, slanted)])))
    assert said.measured == pytest.approx((18.0 - 2.0 * math.cos(0.3) - 0.9 * math.sin(0.3)) / 10.0, abs=0.01)


def test_moving_up_in_a_queue_is_no_headway() -> None:
    case = played(ride(2.0, eastward(lambda _: 2.0, 3.0), others=[(9, moving(6.0, 0.0, 2.0, 0.0))]))
    assert KeepsHeadway(1.0).judge(case).passed is None


BOX = st.tuples(
    st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(-7.0, 7.0), st.floats(0.05, 6.0), st.floats(0.05, 3.0)
)


def polygon(box: tuple[float, ...]) -> Polygon:
    """The box as shapely has it."""
    x_m, y_m, yaw_rad, length_m, width_m = box
    square = Polygon([(length_m, width_m), (length_m, -width_m), (-length_m, -width_m), (-length_m, width_m)])
    return affinity.translate(affinity.rotate(square, yaw_rad, origin=(0, 0), use_radians=True), x_m, y_m)


@given(BOX, BOX)
def test_it_is_the_distance_of_polygons(a: tuple[float, ...], b: tuple[float, ...]) -> None:
    assert gap_m(np.array([a]), np.array([b]))[0] == pytest.approx(polygon(a).distance(polygon(b)), abs=1e-9)


@given(arrays.arrays(np.float64, (7, 5), elements=st.floats(0.1, 9.0)))
def test_many_pairs_are_each_their_own(boxes: np.ndarray) -> None:
    turned = boxes[::-1].copy()
    alone = [gap_m(boxes[index : index + 1], turned[index : index + 1])[0] for index in range(7)]
    assert gap_m(boxes, turned).tolist() == alone


def test_one_within_the_other_is_no_distance_away() -> None:
    assert gap_m(np.array([[0.0, 0.0, 0.3, 9.0, 9.0]]), np.array([[1.0, 1.0, 1.0, 0.2, 0.2]])) == pytest.approx([0.0])


def test_corner_to_corner_is_pythagoras() -> None:
    assert gap_m(np.array([[0.0, 0.0, 0.0, 2.0, 1.0]]), np.array([[7.0, 6.0, 0.0, 2.0, 1.0]])) == pytest.approx([5.0])
