"""Drives past what stands in the lane, in the small world: the street leads east, oncoming cars drive at y = -3.2."""

import itertools
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from basu.agents.builtin.driving.manner import AGGRESSIVE, CAUTIOUS, NORMAL, Manner
from basu.agents.builtin.passing.overtaking import PassingPhase
from basu.agents.builtin.scene import ActorKind, Other
from basu.routing import ControlKind, Route
from driving_plant import SHUTTLE_BODY, Log, Plant, bends, body_at, drive, line, make_behavioral, make_route

PARKED_AT_M = 120.0
PARKED = body_at(ActorKind.VEHICLE, PARKED_AT_M, 0.1)
Scene = Callable[[float], Sequence[Other]]


def on_a_street(scene: Scene, seconds: float = 60.0, manner: Manner = NORMAL, route: Route | None = None) -> Log:
    return drive(make_behavioral(route or make_route(line(300.0)), manner), Plant(0.0, 0.0, 0.0), seconds, scene)


def oncoming(time_s: float, *, from_x_m: float, speed_mps: float = 9.0, number: int = 9) -> Other:
    x_m = from_x_m - speed_mps * time_s
    return body_at(ActorKind.VEHICLE, x_m, -3.2, velocity_mps=(-speed_mps, 0.0), yaw_deg=180.0, number=number)


def least_distance_m(log: Log, scene: Scene) -> float:
    """Between the shuttle and the nearest other, both taken as boxes along the street."""
    found = [np.inf]
    for time_s, x_m, y_m in zip(log.time_s, log.x_m, log.y_m, strict=True):
        for other in scene(time_s):
            along_m = abs(other.x_m - x_m) - other.half_length_m - SHUTTLE_BODY.front_m
            across_m = abs(other.y_m - y_m) - other.half_width_m - SHUTTLE_BODY.half_width_m
            found.append(max(along_m, across_m))
    return float(min(found))


@pytest.mark.parametrize("manner", [CAUTIOUS, NORMAL, AGGRESSIVE])
@pytest.mark.parametrize("kind", [ActorKind.VEHICLE, ActorKind.PROP])
def test_what_stands_in_the_lane_is_gone_round_and_the_lane_is_taken_again(manner: Manner, kind: ActorKind) -> None:
    thing = body_at(kind, PARKED_AT_M, 0.1)
    log = on_a_street(lambda _: [thing], manner=manner)
    assert manner.passing is not None
    beside = np.abs(log.x_m - PARKED_AT_M) < thing.half_length_m + SHUTTLE_BODY.front_m
    gap_m = 0.1 - thing.half_width_m - (log.y_m[beside] + SHUTTLE_BODY.half_width_m)
    assert gap_m.min() > manner.passing.beside_m - 0.15
    assert log.speed_mps[beside].max() <= manner.passing.top_mps + 0.1
    assert log.x_m[-1] > 250.0
    assert np.abs(log.y_m[log.x_m > 160.0]).max() < 0.15
    assert np.abs(log.accel_mps2).max() < manner.comfort.accel_mps2 + 0.2


def test_an_oncoming_car_is_let_past_first() -> None:
    scene: Scene = lambda t: [PARKED, oncoming(t, from_x_m=350.0)]  # noqa: E731 - the scene is asked for twice
    log = on_a_street(scene, 80.0)
    passed_s = (350.0 - 95.0) / 9.0
    assert np.abs(log.y_m[log.time_s < passed_s]).max() < 0.2  # it kept its lane until the car was past
    assert least_distance_m(log, scene) > 0.4
    assert log.x_m[-1] > 250.0


def test_a_stream_of_oncoming_cars_is_waited_out_where_one_can_still_swing_out() -> None:
    scene: Scene = lambda t: [PARKED, *(oncoming(t, from_x_m=200.0 + 60.0 * k, number=20 + k) for k in range(5))]  # noqa: E731
    log = on_a_street(scene, 85.0)
    waits = (log.speed_mps < 0.05) & (log.time_s > 5.0) & (log.x_m < 200.0)
    assert waits.any()
    room_m = PARKED_AT_M - PARKED.half_length_m - (log.x_m[waits] + SHUTTLE_BODY.front_m)
    assert 8.0 < room_m.min() <= room_m.max() < 25.0
    assert np.abs(log.y_m[log.time_s < (440.0 - 130.0) / 9.0]).max() < 0.2
    assert least_distance_m(log, scene) > 0.4
    assert log.x_m[-1] > 200.0


@pytest.mark.parametrize("turns_up_s", [18.5, 20.0, 23.0])
@pytest.mark.parametrize("turns_up_m", [150.0, 200.0])
def test_one_that_turns_up_late_is_never_hit(turns_up_s: float, turns_up_m: float) -> None:
    """It comes out of a drive while the shuttle is on its way round, and brakes at 3 m/s² for who comes towards it."""

    class Late:
        def __init__(self) -> None:
            self.x_m, self.speed_mps, self.time_s = turns_up_m, 9.0, turns_up_s

        def __call__(self, time_s: float) -> list[Other]:
            if time_s < turns_up_s:
                return [PARKED]
            while self.time_s < time_s - 1e-9:
                stops_m = self.speed_mps**2 / 6.0
                if plant.y_m < -0.8 and 0.0 < self.x_m - plant.x_m - 4.2 < stops_m + plant.speed_mps * 2.0 + 4.0:
                    self.speed_mps = max(0.0, self.speed_mps - 3.0 * 0.05)
                self.x_m -= self.speed_mps * 0.05
                self.time_s += 0.05
            there = body_at(
                ActorKind.VEHICLE, self.x_m, -3.2, velocity_mps=(-self.speed_mps, 0.0), yaw_deg=180.0, number=9
            )
            seen.append((self.x_m - plant.x_m, -3.2 - plant.y_m))
            return [PARKED, there]

    seen: list[tuple[float, float]] = []
    plant = Plant(0.0, 0.0, 0.0)
    drive(make_behavioral(make_route(line(300.0))), plant, 60.0, Late())
    assert min(max(abs(along) - 4.21, abs(across) - 1.95) for along, across in seen) > 0.0


def test_as_long_as_one_can_one_gives_up_for_an_oncoming_car() -> None:
    driver, plant = make_behavioral(make_route(line(300.0))), Plant(0.0, 0.0, 0.0)
    phases = []

    def scene(time_s: float) -> list[Other]:
        phases.append(driver.overtaking.phase)
        begun = PassingPhase.PASSING in phases
        return [PARKED, *([oncoming(0.0, from_x_m=190.0)] if begun and plant.x_m < 90.0 else [])]

    drive(driver, plant, 60.0, scene)
    changes = [b for a, b in itertools.pairwise(phases) if a is not b]
    assert changes[:3] == [PassingPhase.WAITING, PassingPhase.PASSING, PassingPhase.WAITING]


def test_a_queue_before_a_stop_sign_is_not_overtaken() -> None:
    route = make_route(line(300.0), controls=[(ControlKind.STOP_SIGN, 135.0)], junctions_s_m=[(137.0, 150.0)])
    queue = [body_at(ActorKind.VEHICLE, 131.0 - 7.0 * k, 0.0, number=30 + k) for k in range(2)]
    log = on_a_street(lambda _: queue, 45.0, route=route)
    assert np.abs(log.y_m).max() < 0.1
    assert 1.0 < 124.0 - 2.2 - (log.x_m[-1] + SHUTTLE_BODY.front_m) < 3.0  # closed up


def test_no_actor_is_overtaken_that_stands_on_foot_in_a_jam_or_in_a_junction() -> None:
    walker = body_at(ActorKind.WALKER, PARKED_AT_M, 0.0)
    jam = [body_at(ActorKind.VEHICLE, 120.0 + 7.0 * k, 0.0, number=30 + k) for k in range(5)]
    junction = make_route(line(300.0), junctions_s_m=[(126.0, 140.0)])
    for scene, route in (([walker], None), (jam, None), ([PARKED], junction)):
        log = on_a_street(lambda _, s=scene: s, 32.0, route=route)  # type: ignore[misc]
        assert np.abs(log.y_m).max() < 0.1
        assert log.speed_mps[-1] == 0.0


def test_without_a_lane_to_the_left_one_stays_behind() -> None:
    driver = make_behavioral(make_route(line(300.0)), left_width_m=0.0)
    log = drive(driver, Plant(0.0, 0.0, 0.0), 32.0, lambda _: [PARKED])
    assert np.abs(log.y_m).max() < 0.1
    assert log.speed_mps[-1] == 0.0


def test_what_only_reaches_into_the_lane_is_passed_within_it_despite_oncoming_traffic() -> None:
    wide = make_route(line(300.0))
    wide = type(wide)(**{**{f: getattr(wide, f) for f in wide.__slots__}, "lane_width_m": np.full(301, 4.4)})
    cone = body_at(ActorKind.PROP, PARKED_AT_M, 1.6)
    scene: Scene = lambda t: [cone, *(oncoming(t, from_x_m=100.0 + 45.0 * k, number=20 + k) for k in range(10))]  # noqa: E731
    log = drive(make_behavioral(wide, AGGRESSIVE, left_width_m=4.4), Plant(0.0, 0.0, 0.0), 45.0, scene)
    assert log.speed_mps[(log.time_s > 8.0) & (log.x_m < 250.0)].min() > 3.0
    assert log.y_m.min() - SHUTTLE_BODY.half_width_m > -2.2


def test_a_leader_that_stops_for_a_moment_is_followed_not_passed() -> None:
    def scene(time_s: float) -> list[Other]:
        x_m = 30.0 + 5.0 * min(time_s, 15.0) + 5.0 * max(0.0, time_s - 25.0)
        moves = time_s < 15.0 or time_s > 25.0
        return [body_at(ActorKind.VEHICLE, x_m, 0.0, velocity_mps=(5.0 if moves else 0.0, 0.0))]

    log = on_a_street(scene, 50.0)
    assert np.abs(log.y_m).max() < 0.1
    assert log.x_m[-1] > 150.0


def test_one_that_sets_off_while_being_passed_is_let_go_first() -> None:
    plant = Plant(0.0, 0.0, 0.0)
    at: list[float] = [PARKED_AT_M, 0.0]

    def scene(_time_s: float) -> list[Other]:
        if plant.x_m > PARKED_AT_M - 6.0:
            at[1] = min(at[1] + 0.08, 5.0)
        at[0] += at[1] * 0.05
        car = body_at(ActorKind.VEHICLE, at[0], 0.1, velocity_mps=(at[1], 0.0))
        gaps.append(max(abs(at[0] - plant.x_m) - 4.21, abs(0.1 - plant.y_m) - 1.95))
        return [car]

    gaps: list[float] = []
    log = drive(make_behavioral(make_route(line(400.0))), plant, 60.0, scene)
    assert min(gaps) > 0.3
    assert np.abs(log.y_m[-20:]).max() < 0.2
    assert log.x_m[-1] > 180.0


def test_a_bend_is_no_hindrance() -> None:
    route = make_route(bends((60.0, 0.0), (120.0, 1 / 120), (120.0, 0.0)))
    driver, plant = make_behavioral(route), Plant(0.0, 0.0, 0.0)
    x_m, y_m, yaw_rad = route.points_m[110, 0], route.points_m[110, 1], route.yaw_rad[110]
    parked = body_at(ActorKind.VEHICLE, x_m, y_m, yaw_deg=np.degrees(yaw_rad))
    log = drive(driver, plant, 70.0, lambda _: [parked])
    assert log.s_m[-1] > 280.0
    assert np.hypot(log.x_m - x_m, log.y_m - y_m).min() > 2.4
