"""Tests of ``basu.agents.calls``."""

import math
import signal
import threading
import time
from collections.abc import Callable
from enum import IntEnum
from typing import Any

import carla
import pytest

from basu.agents.calls import OverrunError, call_within, route_point
from basu.routing.route_file import RoutePoint
from fakes.one_road import one_road


class RoadOption(IntEnum):
    """As in CARLA's agents."""

    LANEFOLLOW = 4


def test_pairs_of_a_planner_are_points_of_a_route() -> None:
    waypoint = one_road().get_waypoint(carla.Location(20.0, 1.75, 0.0))
    at = waypoint.transform.location
    expected = RoutePoint(at.x, at.y, at.z, math.radians(waypoint.transform.rotation.yaw))
    option = RoadOption.LANEFOLLOW
    assert route_point((waypoint, option)) == expected
    assert route_point([waypoint.transform, option]) == expected
    assert route_point((at, option)) == RoutePoint(at.x, at.y, at.z)
    assert route_point(waypoint) == expected


@pytest.mark.parametrize("place", [(1.0, 2.0), "ab", None, (carla.Location(),), (None, RoadOption.LANEFOLLOW)])
def test_what_is_no_place_is_none(place: Any) -> None:
    with pytest.raises((TypeError, ValueError, AttributeError)):
        route_point(place)


LIMIT_S = 0.1


def sleeps() -> None:
    time.sleep(3600.0)


def loops() -> None:
    while not released.is_set():
        pass


def swallows_every_exception_once() -> None:
    try:
        time.sleep(3600.0)
    except BaseException:  # noqa: BLE001 - what a careless agent does
        time.sleep(3600.0)


released = threading.Event()  # ends the busy loop that a thread was left with


def elsewhere(task: Callable[[], object]) -> object:
    """Run ``task`` in another thread; what it raised or returned."""
    answer: list[object] = []

    def work() -> None:
        try:
            answer.append(task())
        except BaseException as error:  # noqa: BLE001 - handed over to the waiting thread, whatever it is
            answer.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(60.0)
    return answer[0]


@pytest.mark.parametrize("hanging", [sleeps, loops, swallows_every_exception_once])
def test_a_hanging_call_is_brought_back_in_the_main_thread(hanging: Callable[[], None]) -> None:
    released.clear()
    with pytest.raises(OverrunError):
        call_within(LIMIT_S, hanging)


@pytest.mark.parametrize("hanging", [sleeps, loops])
def test_a_hanging_call_is_left_behind_in_another_thread(hanging: Callable[[], None]) -> None:
    released.clear()
    try:
        assert isinstance(elsewhere(lambda: call_within(LIMIT_S, hanging)), OverrunError)
    finally:
        released.set()


def test_an_answer_comes_back_from_both() -> None:
    assert call_within(60.0, lambda: 7) == 7
    assert elsewhere(lambda: call_within(60.0, lambda: 7)) == 7


def test_an_exception_comes_back_from_both() -> None:
    def fails() -> None:
        raise KeyError("x")

    with pytest.raises(KeyError):
        call_within(60.0, fails)
    assert isinstance(elsewhere(lambda: call_within(60.0, fails)), KeyError)


def test_nothing_is_left_ticking() -> None:
    before = signal.getsignal(signal.SIGALRM)
    call_within(60.0, lambda: None)
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert signal.getsignal(signal.SIGALRM) is before


def test_an_overrun_is_no_exception_that_an_agent_would_catch() -> None:
    def catches() -> str:
        try:
            time.sleep(3600.0)
        except Exception:  # noqa: BLE001 - what an agent does
            return "caught"
        return "slept"

    with pytest.raises(OverrunError):
        call_within(LIMIT_S, catches)
