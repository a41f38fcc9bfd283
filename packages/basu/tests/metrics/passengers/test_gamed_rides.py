"""Records that game the passengers' verdict: each loses against the honest ride."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from basu.metrics.passengers.service import Visit, fault_of, service
from basu.metrics.passengers.verdict import PassengerJudgement, judge
from basu.metrics.success import success
from basu.outcome import Outcome, Status
from basu.records.history import History
from basu.routing import Stop
from basu.routing.timetable import Call, Hours, Timetable
from fakes.drives import stop_sign, straight_route
from fakes.rides import eastward, ride

LENGTH_M = 100.0
ARRIVED = Outcome(Status.COMPLETED, "arrived")


def judged(history: History, *, ended_early: bool = False) -> PassengerJudgement:
    found = judge(history, ended_early=ended_early)
    assert found is not None
    return found


def comfort(history: History, *, ended_early: bool = False) -> float:
    found = judged(history, ended_early=ended_early).comfort
    assert found is not None
    return found


def jolting(t_s: float) -> float:
    """At 5 m/s, with a jolt of 1.2 m/s² for half a second every 5 s."""
    return 5.0 - 0.6 * max(0.0, 1.0 - abs(t_s % 5.0 - 2.5) / 0.5)


def then(first: Callable[[float], float], until_s: float, later_mps: float) -> Callable[[float], float]:
    """A speed until a time, gently slowed over 8 s to another that is held from then on."""
    end_mps = first(until_s)
    return lambda t_s: (
        first(t_s) if t_s < until_s else end_mps + (later_mps - end_mps) * min(1.0, (t_s - until_s) / 8.0)
    )


def test_to_stand_until_the_scenario_is_over_earns_no_comfort() -> None:
    found = judged(ride(30.0, eastward(lambda _: 0.0, 30.0)), ended_early=True)
    assert (found.passed, found.comfort) == (False, 0.0)
    assert found.reasons == ("the vehicle stood: a ride that goes nowhere earns no comfort",)


@pytest.mark.parametrize("later_mps", [0.0, 0.15], ids=["standing", "creeping"])
def test_neither_standing_nor_creeping_dilutes_what_was_felt(later_mps: float) -> None:
    """Two minutes of it behind twenty seconds of jolts."""
    short = ride(28.0, eastward(then(jolting, 20.0, later_mps), 28.0))
    long = ride(148.0, eastward(then(jolting, 20.0, later_mps), 148.0))
    honest, gamed = judged(short, ended_early=True), judged(long, ended_early=True)
    share = honest.balance.step_s / honest.balance.moving_s
    assert share > 0.03
    assert gamed.balance.step_share == pytest.approx(share, rel=0.5)
    assert gamed.parts["vibration"] <= honest.parts["vibration"] + 0.15
    assert gamed.comfort is not None
    assert honest.comfort is not None
    assert gamed.comfort <= honest.comfort + 0.1


def test_the_sign_that_was_missed_is_a_reason() -> None:
    route = straight_route(LENGTH_M, controls=(stop_sign(50.0),))
    found = judged(ride(20.0, eastward(lambda _: 5.0, 20.0), route=route))
    assert not found.passed
    assert any("crossed the line of stop sign 7" in reason for reason in found.reasons)


def oncoming(metres: float, *, past_a_van: bool = False) -> History:
    """A ride of 100 m at 5 m/s, from 20 m on in the oncoming lane, perhaps beside a parked van."""

    def state(t_s: float) -> dict[str, float]:
        row = eastward(lambda _: 5.0, 22.0)(t_s)
        wrong = 20.0 <= row["x_m"] <= 20.0 + metres
        lane = {"y_m": -3.5, "lateral_m": -3.5, "lane_id": 1.0, "lane_heading_rad": math.pi} if wrong else {}
        return {**row, "road_id": 1.0, "lane_id": -1.0, "lane_type": 2.0, "lane_width_m": 3.5, **lane}

    van = [(9, lambda _: {"x_m": 30.0, "y_m": 0.0})]
    return ride(20.0, state, others=van if past_a_van else (), route=straight_route(LENGTH_M))


@pytest.mark.parametrize(
    ("history", "reason"),
    [
        pytest.param(oncoming(20.0), "with nothing to pass", id="nothing to pass"),
        pytest.param(oncoming(20.0, past_a_van=True), None, id="a parked van"),
        pytest.param(oncoming(70.0, past_a_van=True), "farther than passing takes", id="far past a van"),
    ],
)
def test_the_wrong_lane_is_a_reason_by_the_rule_of_success(history: History, reason: str | None) -> None:
    for reasons in (judged(history, ended_early=True).reasons, success(ARRIVED, history, ()).reasons):
        found = [each for each in reasons if "lane of oncoming traffic" in each]
        assert len(found) == (reason is not None), reasons
        assert reason is None or reason in found[0]


def test_to_ride_against_the_route_is_a_reason() -> None:
    history = ride(10.0, lambda t_s: {"x_m": 80.0 - 3.0 * t_s, "route_s_m": 80.0 - 3.0 * t_s, "velocity_x_mps": -3.0})
    assert any("against the direction of the route" in reason for reason in judged(history).reasons)


HALT = Stop(id="A", name="Stop A", s_m=50.0, x_m=50.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)


def calling(rest_s: float, planned: Call | None = None) -> History:
    """A ride that rests at a stop for a while and goes on to the end of its route."""

    def speed(t_s: float) -> float:
        if t_s < 14.0:
            return min(4.0, 0.8 * t_s, max(0.0, 0.8 * (15.0 - 0.0 - t_s)))
        if t_s < 15.0 + rest_s:
            return max(0.0, 0.8 * (15.0 - t_s))
        return min(4.0, 0.8 * (t_s - 15.0 - rest_s))

    table = (
        None
        if planned is None
        else Timetable(
            round_s=1440.0,
            headway_s=720.0,
            service=(Hours(days=("Mon",), from_s=0.0, to_s=7200.0),),
            run_day="Mon",
            run_departure_s=0.0,
            calls=(planned,),
        )
    )
    route = replace(straight_route(LENGTH_M, stops=(replace(HALT, s_m=40.0, x_m=40.0),)), timetable=table)
    seconds = 36.0 + rest_s
    return ride(seconds, eastward(speed, seconds), route=route)


def test_boarding_takes_time() -> None:
    """A rest of a moment at the stop let no person on."""
    honest, gamed = judged(calling(10.0)), judged(calling(0.2))
    assert honest.parts["service"] == 1.0
    assert not any("service stop" in reason for reason in honest.reasons)
    assert gamed.parts["service"] == 0.0
    assert any("boarding takes 5 s" in reason for reason in gamed.reasons)
    assert gamed.harm.stops_passed == 1
    assert comfort(calling(0.2)) < comfort(calling(10.0))


def test_to_leave_early_costs() -> None:
    keeps = calling(10.0, Call(stop_id="A", arrival_s=15.0, departure_s=30.0))
    leaves = calling(10.0, Call(stop_id="A", arrival_s=15.0, departure_s=120.0))
    assert judged(keeps).parts["service"] == 1.0
    assert judged(leaves).parts["service"] == 0.0
    assert comfort(leaves) < comfort(keeps)
    (visit,) = service(leaves)
    assert str(fault_of(visit)).endswith("s early")


def test_to_leave_persons_behind_costs() -> None:
    (visit,) = service(calling(10.0))
    assert fault_of(visit) is None
    left: Visit = visit._replace(waiting=3, boarded=1, left_behind=2)
    assert fault_of(left) == "was left with 2 persons behind"
