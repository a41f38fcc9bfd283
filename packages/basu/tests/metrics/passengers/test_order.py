"""Claims about the order of rides, over drawn records: a ride with harm never scores better than one without."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from basu.metrics.boxes import other_boxes, own_boxes, touching
from basu.metrics.passengers.verdict import PassengerJudgement, judge
from basu.records.history import Collision, History
from basu.routing import RouteControl, Stop
from fakes.drives import STEP_S, VEHICLE, stop_sign, straight_route
from fakes.rides import Row, eastward, ride

pytestmark = pytest.mark.unmeasured
WALKER = 9
SIZES = {WALKER: (0.25, 0.25)}
LENGTH_M, MARK_M = 100.0, 50.0  # of the route, and where something happens on it
GENTLE_MPS2 = 0.8
PACE_MPS = st.floats(3.0, 7.0)
drawn = settings(max_examples=15, deadline=None, derandomize=True, phases=[Phase.explicit, Phase.generate])


def until_arrival(cruise_mps: float, halts: list[tuple[float, float, float]]) -> tuple[Callable[[float], float], float]:
    """A speed by time, and its duration: with halts (place, braking, seconds), gentle otherwise, to rest at the end."""
    speeds, x_m, v_mps = [0.0], 0.0, 0.0
    ahead = [*sorted(halts), (LENGTH_M - 0.5, GENTLE_MPS2, 1.0)]
    while ahead:
        at_m, braking_mps2, seconds = ahead[0]
        most_mps = (2.0 * braking_mps2 * max(0.0, at_m - x_m)) ** 0.5
        v_mps = min(cruise_mps, v_mps + GENTLE_MPS2 * STEP_S, most_mps)
        if at_m - x_m < 0.002 or v_mps * STEP_S > at_m - x_m:
            speeds += [0.0] * round(seconds / STEP_S)
            ahead.pop(0)
            v_mps = 0.0
            continue
        x_m += v_mps * STEP_S
        speeds.append(v_mps)
    times_s = np.arange(len(speeds)) * STEP_S
    return (lambda t_s: float(np.interp(t_s, times_s, speeds))), float(times_s[-1])


def driven(
    cruise_mps: float,
    halts: list[tuple[float, float, float]] | None = None,
    *,
    walker: Callable[[float], Row] | None = None,
    stops: tuple[Stop, ...] = (),
    controls: tuple[RouteControl, ...] = (),
) -> History:
    """A ride to the end of a straight route; where boxes touch, the collision sensor has sent its message."""
    speed_mps, seconds = until_arrival(cruise_mps, halts or [])
    history = ride(
        seconds,
        eastward(speed_mps, seconds, lane_type=2.0, lane_width_m=3.5),
        others=[] if walker is None else [(WALKER, walker)],
        sizes=SIZES,
        route=straight_route(LENGTH_M, controls=controls, stops=stops),
    )
    if walker is None:
        return history
    own = own_boxes(history.facts, history.frames)[history.others["tick"]]
    touched = np.flatnonzero(touching(own, other_boxes(history.facts, history.others)))
    if len(touched) == 0:
        return history
    event = Collision(
        tick=int(history.others["tick"][touched[0]]),
        other_id=WALKER,
        other_type="walker.pedestrian.0001",
        impulse_ns=(200.0, 0.0, 0.0),
    )
    return replace(history, collisions=(event,))


def crossing(at_s: float, walks_mps: float) -> Callable[[float], Row]:
    """A walker that crosses the road at `MARK_M` from right to left, in its middle at ``at_s``."""
    return lambda t_s: {
        "x_m": MARK_M,
        "y_m": (at_s - t_s) * walks_mps,
        "yaw_rad": -np.pi / 2.0,
        "velocity_y_mps": -walks_mps,
    }


def waiting(until_s: float) -> Callable[[float], Row]:
    """A walker that stands on the road at `MARK_M` and leaves it to the left at 2 m/s from ``until_s`` on."""

    def state(t_s: float) -> Row:
        gone_s = max(0.0, t_s - until_s)
        return {"x_m": MARK_M, "y_m": -2.0 * gone_s, "yaw_rad": -np.pi / 2.0, "velocity_y_mps": -2.0 * (gone_s > 0.0)}

    return state


def judged(history: History) -> PassengerJudgement:
    found = judge(history)
    assert found is not None
    assert found.comfort is not None
    return found


def comfort(history: History) -> float:
    found = judged(history).comfort
    assert found is not None
    return found


def at_mark_s(cruise_mps: float) -> float:
    """When the front bumper of a ride that stops for nothing comes to `MARK_M`."""
    history = driven(cruise_mps)
    return float(history.frames["t_s"][np.argmax(history.frames["route_s_m"] + VEHICLE.front_m >= MARK_M)])


def braked_for_walker(cruise_mps: float, braking_mps2: float, margin_m: float) -> History:
    """A ride that brakes harshly for a walker on the road, waits, and goes on when the road is free."""
    at_m = MARK_M - VEHICLE.front_m - margin_m
    return driven(cruise_mps, [(at_m, braking_mps2, 9.0)], walker=waiting(at_mark_s(cruise_mps) + 4.0))


@drawn
@given(PACE_MPS, st.floats(1.8, 2.4), st.floats(4.0, 6.0), st.floats(0.2, 0.9), st.floats(1.0, 2.0))
def test_collision_near_miss_harsh_stop_with_a_cause_gentle_ride(
    cruise_mps: float, braking_mps2: float, margin_m: float, gap_s: float, walks_mps: float
) -> None:
    mark_s = at_mark_s(cruise_mps)
    clear_s = (VEHICLE.width_m / 2.0 + 0.25) / walks_mps  # from the middle of the road until out of the vehicle's way
    collision = judged(driven(cruise_mps, walker=waiting(mark_s + 9.0)))
    near_miss = judged(driven(cruise_mps, walker=crossing(mark_s - clear_s - gap_s, walks_mps)))
    harsh = judged(braked_for_walker(cruise_mps, braking_mps2, margin_m))
    gentle = judged(driven(cruise_mps))
    assert collision.contacts
    assert not near_miss.contacts
    assert any(party.is_near_miss for party in near_miss.parties)
    assert not harsh.harm.near_misses
    assert harsh.stops
    assert [found.passed for found in (collision, near_miss, harsh, gentle)] == [False, False, False, True]
    assert collision.comfort == 0.0
    assert collision.parts["collisions"] == 0.0
    assert comfort_of(collision) < comfort_of(near_miss) < comfort_of(harsh) < comfort_of(gentle)


def comfort_of(found: PassengerJudgement) -> float:
    assert found.comfort is not None
    return found.comfort


@drawn
@given(PACE_MPS, st.floats(0.6, 4.0), st.floats(0.3, 5.0), st.floats(-4.0, 3.0), st.floats(0.8, 3.0))
def test_to_ignore_a_walker_never_beats_to_brake(
    cruise_mps: float, braking_mps2: float, margin_m: float, early_s: float, walks_mps: float
) -> None:
    """Whenever to drive on is a contact or a near miss; by how much the braking throws the passengers is no matter."""
    walker = crossing(at_mark_s(cruise_mps) - early_s, walks_mps)
    ignored = judged(driven(cruise_mps, walker=walker))
    braked = judged(driven(cruise_mps, [(MARK_M - VEHICLE.front_m - margin_m, braking_mps2, 12.0)], walker=walker))
    assert not braked.contacts
    if ignored.harm.contacts or ignored.harm.near_misses:
        assert comfort_of(braked) >= comfort_of(ignored)
        assert not ignored.passed


def service_stop(s_m: float) -> Stop:
    return Stop(id="A", name="Stop A", s_m=s_m, x_m=s_m, y_m=0.0, z_m=0.0, yaw_rad=0.0)


@drawn
@given(PACE_MPS, st.floats(0.6, 5.0), st.floats(-2.0, 2.0))
def test_a_stop_passed_never_beats_one_served(cruise_mps: float, braking_mps2: float, off_m: float) -> None:
    stops = (service_stop(MARK_M),)
    served = judged(driven(cruise_mps, [(MARK_M + off_m, braking_mps2, 10.0)], stops=stops))
    passed = judged(driven(cruise_mps, stops=stops))
    assert (served.visits[0].served, passed.visits[0].served) == (True, False)
    assert comfort_of(passed) < comfort_of(served)
    assert not passed.passed
    assert "the service stop 'Stop A' was passed" in passed.reasons


@drawn
@given(PACE_MPS, st.floats(0.6, 5.0), st.floats(0.1, 1.5))
def test_to_run_a_stop_sign_never_beats_to_brake_for_it(cruise_mps: float, braking_mps2: float, short_m: float) -> None:
    controls = (stop_sign(MARK_M),)
    heeded = judged(driven(cruise_mps, [(MARK_M - VEHICLE.front_m - short_m, braking_mps2, 1.0)], controls=controls))
    run = judged(driven(cruise_mps, controls=controls))
    assert (len(heeded.breaches), len(run.breaches)) == (0, 1)
    assert comfort_of(run) < comfort_of(heeded)
    assert not run.passed


@drawn
@given(PACE_MPS, st.floats(0.01, 0.93), st.sampled_from(["gentle", "harsh", "near miss", "stop passed"]))
def test_a_drive_cut_short_never_gains_by_what_it_did_not_drive(cruise_mps: float, share: float, what: str) -> None:
    mark_s = at_mark_s(cruise_mps)
    whole = {
        "gentle": lambda: driven(cruise_mps),
        "harsh": lambda: braked_for_walker(cruise_mps, 2.2, 4.0),
        "near miss": lambda: driven(cruise_mps, walker=crossing(mark_s - 1.3, 1.5)),
        "stop passed": lambda: driven(cruise_mps, stops=(service_stop(MARK_M),)),
    }[what]()
    ticks = max(4, int(np.argmax(whole.frames["route_s_m"] >= share * LENGTH_M)))
    cut = replace(whole, frames=whole.frames[:ticks], others=whole.others[whole.others["tick"] < ticks])
    assert comfort(cut) < comfort(whole)
    assert not judged(cut).passed


def test_a_crash_at_the_beginning_is_no_better_than_one_at_the_end() -> None:
    whole = driven(5.0, walker=waiting(60.0))
    ticks = whole.collisions[0].tick + 5
    cut = replace(whole, frames=whole.frames[:ticks], others=whole.others[whole.others["tick"] < ticks])
    assert comfort(cut) == comfort(whole) == 0.0


def test_to_stand_still_is_worth_nothing() -> None:
    history = ride(20.0, eastward(lambda _: 0.0, 20.0), route=straight_route(LENGTH_M))
    assert comfort(history) == 0.0


def test_to_leave_the_road_for_an_actor_never_beats_to_brake() -> None:
    beside = driven(5.0)
    beside.frames["off_lane_m"][200:260] = 0.8
    assert comfort(beside) < comfort(braked_for_walker(5.0, 2.2, 4.0))
    assert not judged(beside).passed


@drawn
@given(PACE_MPS, st.floats(1.9, 2.4), st.floats(4.0, 6.0))
def test_a_phantom_stop_is_worse_than_the_same_stop_with_a_cause(
    cruise_mps: float, braking_mps2: float, margin_m: float
) -> None:
    at_m = MARK_M - VEHICLE.front_m - margin_m
    phantom = judged(driven(cruise_mps, [(at_m, braking_mps2, 9.0)]))
    assert phantom.harm.phantom_stops == 1
    assert comfort_of(phantom) < comfort(braked_for_walker(cruise_mps, braking_mps2, margin_m))
    assert not phantom.passed
