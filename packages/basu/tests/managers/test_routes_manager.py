"""Claims about the end of a run: arrival, deviation, standing still, time."""

from types import SimpleNamespace
from typing import Any

import pytest

from basu.managers.base_manager import Ego, Frame, WorldChanges
from basu.managers.routes_manager import BLOCKED_S, RoutesManager, time_limit_s
from basu.outcome import Outcome, Status
from fakes.drives import straight_route

STEP_S = 0.05


def begun(length_m: float = 100.0) -> RoutesManager:
    manager = RoutesManager()
    run: Any = SimpleNamespace(
        route=straight_route(length_m),
        step_s=STEP_S,
        world=None,
        carla_map=SimpleNamespace(get_waypoint=lambda *_, **__: None),
        weather=(),
        changes=WorldChanges(),
    )
    manager.setup(run)
    return manager


def outcome_at(
    manager: RoutesManager, tick: int, x_m: float, y_m: float = 0.0, speed_mps: float = 5.0
) -> Outcome | None:
    ego = Ego(x_m, y_m, 0.0, 0.0, 0.0, 0.0, speed_mps, *[0.0] * 8)
    manager.tick(Frame(tick, 1000 + tick, None, ego))
    return manager.outcome


def status_of(outcome: Outcome | None) -> Status | None:
    return None if outcome is None else outcome.status


def test_a_drive_goes_on_until_the_end_of_the_route() -> None:
    manager = begun()
    found = [status_of(outcome_at(manager, tick, x_m)) for tick, x_m in enumerate(range(0, 101, 3))]
    assert found[:-1] == [None] * 33
    assert found[-1] is Status.COMPLETED


@pytest.mark.parametrize(("speed_mps", "status"), [(0.0, Status.COMPLETED), (2.0, None)])
def test_parking_shortly_before_the_end_is_arriving(speed_mps: float, status: Status | None) -> None:
    manager = begun(20.0)
    assert status_of(outcome_at(manager, 1, 16.5, speed_mps=speed_mps)) is status


def test_more_than_thirty_metres_off_the_route_ends_the_run() -> None:
    manager = begun()
    assert outcome_at(manager, 1, 10.0, y_m=29.9) is None
    assert outcome_at(manager, 2, 10.0, y_m=30.5) == (
        Status.ROUTE_DEVIATION,
        "30 m off the route at 10 m of its 100 m",
    )


def test_standing_still_for_three_minutes_ends_the_run() -> None:
    manager = begun()
    last = round(BLOCKED_S / STEP_S)
    assert outcome_at(manager, 0, 10.0, speed_mps=1.0) is None
    assert outcome_at(manager, last, 10.0, speed_mps=0.05) is None
    assert status_of(outcome_at(manager, last + 1, 10.0, speed_mps=0.05)) is Status.ROUTE_BLOCKED


def test_creeping_on_is_not_standing_still_but_time_runs_out() -> None:
    manager = begun()
    limit_s = time_limit_s(straight_route(100.0))
    last = round(limit_s / STEP_S)
    assert outcome_at(manager, last, 10.0, speed_mps=0.2) is None
    assert status_of(outcome_at(manager, last + 1, 10.0, speed_mps=0.2)) is Status.ROUTE_TIMEOUT


def test_a_longer_route_with_more_stops_may_take_longer() -> None:
    assert time_limit_s(straight_route(200.0)) > time_limit_s(straight_route(100.0))
