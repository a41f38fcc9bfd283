"""Claims about when a conflict came about: by the record, and by what the ego would have met had it driven on."""

from collections.abc import Callable

import pytest

from basu.scenarios.criteria import Played, StandingThing
from basu.scenarios.exercise import EFFECT_MPS, came_about, effect_felt
from fakes.drives import at, driven, hit, ramp, stop_sign, straight_route
from fakes.played import played
from fakes.rides import Row, braked, eastward, moving, ride

CROSSES_AT_M = 40.0


def crossing(meets_s: float, speed_mps: float = 8.0) -> Callable[[float], Row]:
    """An actor that crosses the road from the right at 40 m, in the middle of it at ``meets_s``."""
    return moving(CROSSES_AT_M, speed_mps * meets_s, 0.0, -speed_mps)


def drive(
    speed_mps: Callable[[float], float], other: Callable[[float], Row], seconds: float = 12.0, **more: object
) -> Played:
    """A drive east with one actor, "child"."""
    history = ride(seconds, eastward(speed_mps, seconds), others=[(9, other)])
    return played(history, **more)  # type: ignore[arg-type]


def test_a_driver_that_brakes_for_crossing_traffic_has_met_it() -> None:
    found = came_about(drive(braked(8.0, 2.0, 2.0), crossing(5.0)))
    assert found.holds is True
    assert "the ego would have met child" in found.sentence


def test_a_driver_that_crawls_far_from_crossing_traffic_has_not_met_it() -> None:
    found = came_about(drive(lambda _: 2.0, crossing(5.0)))
    assert found.holds is False
    assert "at most 2.00 m/s fast" in found.sentence


def test_a_driver_that_stands_has_met_no_actor() -> None:
    assert came_about(drive(lambda _: 0.0, crossing(5.0))).holds is False
    towards_it = moving(60.0, 1.2, -8.0, 0.0)  # passes beside the standing ego
    assert came_about(drive(lambda _: 0.0, towards_it)).holds is False


@pytest.mark.parametrize(("late_s", "met"), [(-4.0, False), (-1.0, True), (0.0, True), (1.0, True), (4.0, False)])
def test_an_ego_that_slows_and_an_actor_within_two_seconds_have_met(late_s: float, met: bool) -> None:  # noqa: FBT001
    arrives_s = CROSSES_AT_M / 8.0
    found = came_about(drive(lambda t_s: 8.0 if t_s < 2.0 else 6.5, crossing(arrives_s + late_s)))
    assert found.holds is met


@pytest.mark.parametrize(("late_s", "met"), [(-1.0, False), (0.0, True), (1.0, False)])
def test_an_ego_that_does_not_respond_meets_only_at_the_same_time(late_s: float, met: bool) -> None:  # noqa: FBT001
    found = came_about(drive(lambda _: 8.0, crossing(CROSSES_AT_M / 8.0 + late_s)))
    assert found.holds is met


def test_touching_a_partner_is_meeting_it() -> None:
    case = drive(lambda _: 2.0, crossing(1.0), collisions=(hit(60, "vehicle.audi.tt", 9),))
    assert came_about(case).sentence.startswith("the ego touched child")


def test_what_happened_before_the_conflict_is_none_of_it() -> None:
    early = drive(lambda _: 8.0, crossing(5.0), phases_s={"trigger": 0.0, "conflict": 9.0})
    assert came_about(early).holds is False
    assert came_about(drive(lambda _: 8.0, crossing(5.0), phases_s={"trigger": 0.0})).holds is False


def test_a_leader_that_is_caught_up_with_is_met_and_one_that_drives_away_is_not() -> None:
    assert came_about(drive(braked(8.0, 1.5, 1.0), moving(30.0, 0.0, 3.0, 0.0))).holds is True
    assert came_about(drive(lambda _: 8.0, moving(30.0, 0.0, 10.0, 0.0))).holds is False


def test_a_side_road_that_empties_while_the_ego_stands_at_its_stop_sign_is_not_met() -> None:
    """The ego sets off at 10 s, and lets another cross at 14 s; the cross traffic of 6 s is gone by then."""
    route = straight_route(200.0, controls=(stop_sign(30.0),))
    stops = [*at(7.0, 2.0), *ramp(7.0, 0.0, 4.0), *at(0.0, 4.0), *ramp(0.0, 4.0, 3.0)]
    stops += [*ramp(4.0, 0.0, 1.0), *at(0.0, 2.0), *ramp(0.0, 7.0, 7.0), *at(7.0, 3.0)]
    speeds = lambda t_s: stops[min(len(stops) - 1, round(t_s / 0.05))]  # noqa: E731
    for meets_s, met in ((6.0, False), (14.0, True)):
        other = moving(CROSSES_AT_M, 8.0 * meets_s, 0.0, -8.0)
        history = ride(20.0, eastward(speeds, 21.0), others=[(9, other)], route=route)
        assert came_about(played(history)).holds is met, meets_s


def test_partners_are_an_ego_that_moves_unless_the_scenario_names_them() -> None:
    beside = StandingThing("van", 24.0, 2.4, 0.0, 2.0, 1.0)
    history = ride(12.0, eastward(lambda _: 2.0, 13.0), others=[(9, crossing(2.0))])
    case = played(history, things=(beside,))
    assert came_about(case).holds is False
    assert came_about(case, ["van"]).holds is True
    alone = played(driven(at(2.0, 10.0)), roles={}, things=(beside,))
    assert came_about(alone).holds is True  # nothing moves, so the van is what has to be passed


@pytest.mark.parametrize("speed_mps", [EFFECT_MPS - 0.5, EFFECT_MPS + 0.5])
def test_without_a_partner_the_ego_has_to_be_driving_when_it_begins(speed_mps: float) -> None:
    case = played(driven(at(speed_mps, 4.0)), roles={})
    assert came_about(case).holds is (speed_mps >= EFFECT_MPS)
    assert effect_felt(case) == came_about(case)
