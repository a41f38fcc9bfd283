"""Claims about arriving, reaching and being in time."""

import pytest

from basu.outcome import Outcome, Status
from basu.scenarios.criteria import Arrives, InTime, Reaches, ReachesPoint
from basu.scenarios.triggers import along_route
from fakes.drives import at, driven, ramp, straight_route
from fakes.played import played

COLLIDED = Outcome(Status.COMPLETED, "it touched an actor")
TIMEOUT = Outcome(Status.ROUTE_TIMEOUT, "the time was used up")


def test_where_the_run_ends_the_ego_has_arrived() -> None:
    """The criterion and the trigger have the run's definition with a slack that is not negative."""
    assert along_route.SLACK_M >= 0.0
    assert along_route.SLACK_MPS >= 0.0


def test_an_ego_that_passes_the_end_has_arrived_and_its_time_is_reported() -> None:
    said = Arrives().judge(played(driven(at(10.0, 12.0), route=straight_route(100.0))))
    assert said.passed is True
    assert said.t_s == pytest.approx(9.8)
    assert said.sentence == "it arrived after 9.80 s"


@pytest.mark.parametrize(("short_m", "arrived"), [(4.5, True), (6.0, False)])
def test_an_ego_that_parks_within_five_metres_of_the_end_has_arrived(short_m: float, arrived: bool) -> None:  # noqa: FBT001
    speeds = [*at(10.0, 9.0), *at(0.0, 2.0)]
    said = Arrives().judge(played(driven(speeds, route=straight_route(100.0), start_m=10.0 - short_m)))
    assert said.passed is arrived


def test_creeping_past_five_metres_is_not_parking_there() -> None:
    history = driven(at(0.5, 4.0), route=straight_route(100.0), start_m=95.5)
    assert Arrives().judge(played(history)).passed is False


def test_an_ego_that_did_not_arrive_is_reported_how_far_it_got_and_why_it_ended() -> None:
    said = Arrives().judge(played(driven(at(10.0, 4.0)), outcome=COLLIDED))
    assert said.passed is False
    assert said.sentence == "it got to 39.5 m of 200.0 m: it touched an actor"
    assert said.measured == pytest.approx(39.5)


def test_a_place_along_the_route_is_reached_when_it_is_passed() -> None:
    case = played(driven(at(10.0, 4.0)))
    reached = Reaches(20.0, "the exit").judge(case)
    assert (reached.passed, reached.criterion, reached.t_s) == (True, "reaches the exit", pytest.approx(2.0))
    short = Reaches(50.0, "the exit").judge(case)
    assert short.passed is False
    assert short.sentence == "it got to 39.5 m of its route, 10.5 m short of the exit"


def test_a_point_is_reached_within_its_radius() -> None:
    case = played(driven(at(10.0, 4.0), lateral_m=1.0))
    assert ReachesPoint(20.0, 3.0, 2.5).judge(case).passed is True
    missed = ReachesPoint(20.0, 4.0, 2.5, "the bay").judge(case)
    assert missed.passed is False
    assert missed.measured == pytest.approx(3.0)
    assert missed.sentence == "it came no nearer to the bay than 3.0 m, at 2.00 s"


def test_in_time_is_from_the_first_frame_to_the_arrival() -> None:
    case = played(driven(at(10.0, 12.0), route=straight_route(100.0)))
    assert InTime(10.0).judge(case).passed is True
    late = InTime(9.0).judge(case)
    assert (late.passed, late.measured) == (False, pytest.approx(9.8))


def test_a_scenario_that_is_over_before_the_arrival_is_over_then() -> None:
    case = played(driven(at(10.0, 12.0)), phases_s={"trigger": 0.0, "end": 6.0})
    said = InTime().judge(case)
    assert (said.passed, said.measured) == (True, pytest.approx(6.0))


def test_an_ego_that_is_stopped_by_the_clock_is_late_and_one_that_is_stopped_by_a_collision_is_neither() -> None:
    history = driven([*at(10.0, 4.0), *ramp(10.0, 0.0, 1.0)])
    assert InTime().judge(played(history, outcome=TIMEOUT)).passed is False
    said = InTime().judge(played(history, outcome=COLLIDED))
    assert said.passed is None
    assert said.sentence.endswith("before it was over: it touched an actor")
    assert InTime(4.95).judge(played(history, outcome=COLLIDED)).passed is False
