"""Claims about harsh stops: what is one, how it is described, and what it is said to be for."""

import numpy as np
import pytest

from basu.metrics.passengers.causes import Cause, StopCause, cause, reach_m
from basu.metrics.passengers.felt import Felt, felt
from basu.metrics.passengers.harsh_stops import HarshStop, harsh_stops
from basu.records.history import History
from basu.routing import ControlKind, Route, RouteControl, Stop
from fakes.drives import hit, straight_route
from fakes.rides import braked, eastward, moving, ride

SPEED_MPS = 7.1 * 0.44704  # that of 20 February 2020
AT_S = 4.0
BRAKED_AT_M = SPEED_MPS * AT_S  # where the origin is when it begins; the front bumper is 2 m farther


def sensed(history: History) -> Felt:
    found = felt(history)
    assert found is not None
    return found


def stopped(**more: object) -> History:
    """Braking with 3.5 m/s² at walking pace, with whatever is ahead."""
    return ride(9.0, eastward(braked(SPEED_MPS, AT_S, 3.5), 9.0), **more)  # type: ignore[arg-type]


def why(history: History) -> Cause:
    (stop,) = harsh_stops(sensed(history))
    return cause(history, stop)


def control(kind: ControlKind, s_m: float) -> RouteControl:
    return RouteControl(kind=kind, landmark_id="7", s_m=s_m, x_m=s_m, y_m=0.0, z_m=0.0, yaw_rad=0.0)


def test_a_hard_stop_is_reported_with_its_speed_its_strength_and_its_length() -> None:
    (stop,) = harsh_stops(sensed(stopped()))
    assert stop.t_s == pytest.approx(AT_S, abs=0.051)
    assert stop.from_mps == pytest.approx(SPEED_MPS)
    assert stop.to_mps == 0.0
    assert stop.to_rest
    assert 3.5 < stop.strongest_mps2 < 3.5 * 1.065
    assert stop.above_s == pytest.approx(SPEED_MPS / 3.5, abs=0.15)


@pytest.mark.parametrize(("braking_mps2", "number"), [(1.3, 0), (1.6, 1)])
def test_the_threshold_parts_harsh_from_firm(braking_mps2: float, number: int) -> None:
    history = ride(12.0, eastward(braked(6.0, 2.0, braking_mps2), 12.0))
    assert len(harsh_stops(sensed(history))) == number


def test_pulling_away_hard_is_no_harsh_stop() -> None:
    assert harsh_stops(sensed(ride(6.0, eastward(lambda t: 3.0 * t, 6.0)))) == ()


def test_two_brakings_with_a_pause_are_two_and_a_stutter_is_one() -> None:
    def twice(pause_s: float) -> History:
        def speed(t: float) -> float:
            return 10.0 - 3.0 * float(np.clip(t - 2.0, 0.0, 1.0) + np.clip(t - 3.0 - pause_s, 0.0, 1.0))

        return ride(10.0, eastward(speed, 10.0))

    assert len(harsh_stops(sensed(twice(3.0)))) == 2
    assert len(harsh_stops(sensed(twice(0.2)))) == 1


def test_rolling_down_a_slope_from_rest_is_no_braking() -> None:
    assert harsh_stops(sensed(ride(6.0, lambda _: {"pitch_rad": -0.2}))) == ()


def test_with_nothing_ahead_it_is_a_phantom_stop() -> None:
    found = why(stopped())
    assert found.kind is StopCause.NOTHING
    assert found.detail.startswith(f"nothing was ahead within {reach_m(SPEED_MPS):.1f} m; in the 2 s before")


@pytest.mark.parametrize("kind", [ControlKind.STOP_SIGN, ControlKind.YIELD_SIGN])
def test_a_line_within_reach_is_a_reason_and_one_farther_off_is_not(kind: ControlKind) -> None:
    front_m = BRAKED_AT_M + 2.0
    near = why(stopped(route=straight_route(controls=(control(kind, front_m + 5.0),))))
    assert near.kind.value == kind.value
    assert near.away_m == pytest.approx(5.0, abs=0.2)
    assert near.needed_mps2 == pytest.approx(SPEED_MPS**2 / 10.0, rel=0.05)
    far = straight_route(controls=(control(kind, front_m + reach_m(SPEED_MPS) + 1.0),))
    assert why(stopped(route=far)).kind is StopCause.NOTHING
    passed = straight_route(controls=(control(kind, front_m - 1.5),))
    assert why(stopped(route=passed)).kind is StopCause.NOTHING


@pytest.mark.parametrize(
    ("light", "kind"), [(0, StopCause.TRAFFIC_LIGHT), (1, StopCause.TRAFFIC_LIGHT), (2, StopCause.NOTHING)]
)
def test_a_light_is_a_reason_unless_it_is_green(light: int, kind: StopCause) -> None:
    route = straight_route(controls=(control(ControlKind.TRAFFIC_LIGHT, BRAKED_AT_M + 6.0),))
    state = eastward(braked(SPEED_MPS, AT_S, 3.5), 9.0, route_light=light)
    assert why(ride(9.0, state, route=route)).kind is kind


def test_service_stops_and_the_routes_end_are_reasons() -> None:
    stop = Stop(id="S1", name="School", s_m=BRAKED_AT_M + 4.0, x_m=0.0, y_m=0.0, z_m=0.0, yaw_rad=0.0)
    assert why(stopped(route=straight_route(stops=(stop,)))).detail.startswith("service stop 'School' 4.")
    assert why(stopped(route=straight_route(length_m=round(BRAKED_AT_M + 5.0)))).kind is StopCause.ROUTE_END


def test_a_lower_limit_ahead_is_a_reason() -> None:
    route = straight_route()
    route.speed_limit_mps[route.s_m > BRAKED_AT_M + 3.0] = 1.0
    assert why(stopped(route=route)).kind is StopCause.LIMIT


def test_a_limit_that_is_exceeded_already_is_a_reason() -> None:
    found = why(stopped(route=straight_route(limit_mps=2.0)))
    assert found.kind is StopCause.LIMIT
    assert found.detail.startswith("the limit of 2.0 m/s, exceeded already, demanded 0.")


def test_a_bend_too_tight_for_the_speed_is_a_reason() -> None:
    straight = straight_route()
    turning_rad = np.maximum(0.0, straight.s_m - BRAKED_AT_M - 3.0) / 5.0  # a radius of 5 m allows for 2.2 m/s
    fields = {name: getattr(straight, name) for name in straight.__slots__}  # type: ignore[attr-defined]
    bent = Route(**{**fields, "yaw_rad": np.arctan2(np.sin(turning_rad), np.cos(turning_rad))})
    found = why(stopped(route=bent))
    assert found.kind is StopCause.BEND
    assert "radius" in found.detail


def test_a_contact_explains_the_braking_it_makes_whatever_else_is_there() -> None:
    history = stopped(route=straight_route(limit_mps=2.0))
    tick = round(AT_S / 0.05)
    struck = History(
        facts=history.facts,
        frames=history.frames,
        others=history.others,
        collisions=(hit(tick, "static.poles"),),
        lane_invasions=(),
    )
    assert why(struck) == Cause(StopCause.CONTACT, 0.0, pytest.approx(3.6, abs=0.2), "the vehicle hit static.poles")


@pytest.mark.parametrize(
    ("actor", "kind"),
    [
        pytest.param(moving(BRAKED_AT_M + 10.0, 0.0, 0.0, 0.0), StopCause.ACTOR, id="parked ahead in the lane"),
        pytest.param(moving(BRAKED_AT_M + 10.0, 3.5, 0.0, 0.0), StopCause.NOTHING, id="parked beside the lane"),
        pytest.param(moving(BRAKED_AT_M + 30.0, 0.0, 0.0, 0.0), StopCause.NOTHING, id="parked far ahead"),
        pytest.param(moving(BRAKED_AT_M - 8.0, 0.0, 0.0, 0.0), StopCause.NOTHING, id="behind"),
        pytest.param(moving(60.0, 3.5, -9.0, 0.0), StopCause.NOTHING, id="oncoming in its own lane"),
        pytest.param(moving(BRAKED_AT_M + 6.0, -10.5, 0.0, 2.0), StopCause.ACTOR, id="about to cross"),
        pytest.param(moving(BRAKED_AT_M + 6.0, 2.0, 0.0, 2.0), StopCause.NOTHING, id="has crossed"),
    ],
)
def test_an_actor_is_a_reason_where_the_way_is_theirs(actor: object, kind: StopCause) -> None:
    assert why(stopped(others=[(9, actor)])).kind is kind


def test_of_two_reasons_the_one_that_asks_for_more_is_reported() -> None:
    line = straight_route(controls=(control(ControlKind.STOP_SIGN, BRAKED_AT_M + 9.0),))
    found = why(stopped(route=line, others=[(9, moving(BRAKED_AT_M + 7.0, 0.0, 0.0, 0.0))]))
    assert found.kind is StopCause.ACTOR
    assert found.detail == f"vehicle.audi.tt (actor 9) {found.away_m:.1f} m ahead demanded {found.needed_mps2:.2f} m/s²"


def test_off_the_route_the_way_is_straight_ahead() -> None:
    state = eastward(braked(SPEED_MPS, AT_S, 3.5), 9.0, lateral_m=5.0, y_m=5.0)
    assert why(ride(9.0, state, others=[(9, moving(BRAKED_AT_M + 10.0, 5.0, 0.0, 0.0))])).kind is StopCause.ACTOR
    assert why(ride(9.0, state, others=[(9, moving(BRAKED_AT_M + 10.0, 0.0, 0.0, 0.0))])).kind is StopCause.NOTHING


def test_in_reverse_braking_pushes_the_other_way_and_counts() -> None:
    (stop,) = harsh_stops(sensed(ride(6.0, eastward(lambda t: -max(0.0, 3.0 - 2.5 * max(0.0, t - 2.0)), 6.0))))
    assert isinstance(stop, HarshStop)
    assert stop.from_mps == pytest.approx(3.0)
