"""Claims about answers to the destruction of cars that a Traffic Manager drives."""

from typing import Any

from fakes.raw_client import RawClient
from linden.protocol.wire.commands import COMMANDS, ApplyLocation, ApplyVehicleControl, DestroyActor
from linden.server.driven_vehicles import LONG_PATIENCE_S, PATIENCE_S, DrivenVehicles
from servers import RunningServer

APPLY_LOCATION = COMMANDS.index(ApplyLocation)
CONTROL = COMMANDS.index(ApplyVehicleControl)


def _batch(*actor_ids: int) -> list[Any]:
    return [[[CONTROL, [actor_id, None]]] for actor_id in actor_ids]


def test_an_answer_waits_for_a_batch_without_the_car() -> None:
    driven = DrivenVehicles()
    assert driven.batch(_batch(5, 6)) == []
    assert driven.destroyed(5, b"gone", 1.0, frames_come=True)
    assert driven.batch(_batch(5, 6)) == [], "of the step before"
    assert driven.batch(_batch(6)) == [b"gone"]
    assert driven.waiting == []


def test_an_answer_that_no_batch_confirms_is_overdue() -> None:
    driven = DrivenVehicles()
    driven.batch(_batch(5, 6))
    assert driven.destroyed(5, b"5", 1.0, frames_come=True)
    assert driven.destroyed(6, b"6, the last", 1.0, frames_come=True)
    assert driven.overdue(1.0 + PATIENCE_S / 2.0) == []
    assert driven.overdue(1.0 + PATIENCE_S) == [b"6, the last"]
    assert driven.overdue(1.0 + LONG_PATIENCE_S) == [b"5"]


def test_other_actors_and_a_second_destruction_do_not_wait() -> None:
    driven = DrivenVehicles()
    driven.batch(_batch(5))
    assert not driven.destroyed(9, b"gone", 1.0, frames_come=True)
    assert driven.destroyed(5, b"gone", 1.0, frames_come=True)
    assert not driven.destroyed(5, b"refused", 1.0, frames_come=True)


def test_between_ticks_an_idle_thread_is_enough() -> None:
    driven = DrivenVehicles()
    driven.shown()
    driven.batch(_batch(5, 6))
    assert not driven.destroyed(5, b"gone", 1.0, frames_come=False)
    driven.shown()
    assert driven.destroyed(6, b"gone", 1.0, frames_come=False), "it works on the last frame"
    assert driven.batch(_batch(5, 6)) == [b"gone"]


def test_a_frame_without_a_car_waits_for_the_step_on_it() -> None:
    driven, there = DrivenVehicles(), {5, 6}
    driven.batch(_batch(5, 6))
    driven.shown()
    assert driven.frame_wait_s(1.0, there.__contains__) == 0.0
    there.remove(5)
    assert driven.frame_wait_s(1.0, there.__contains__) == PATIENCE_S
    driven.batch(_batch(5, 6))
    assert driven.frame_wait_s(1.0, there.__contains__) == 0.0, "the thread is idle"


def test_a_step_that_began_before_the_last_frame_is_followed_by_another() -> None:
    driven = DrivenVehicles()
    driven.batch(_batch(5))
    for _ in range(3):
        driven.shown()
    assert driven.frame_wait_s(1.0, set().__contains__) > 0.0
    driven.batch(_batch(5))
    assert driven.frame_wait_s(1.1, set().__contains__) > 0.0
    driven.batch(_batch(5))
    assert driven.frame_wait_s(1.1, set().__contains__) == 0.0


def test_a_frame_waits_once_for_a_thread_that_stands_still() -> None:
    driven = DrivenVehicles()
    driven.batch(_batch(5))
    driven.shown()
    assert driven.frame_wait_s(1.0, set().__contains__) == PATIENCE_S
    assert driven.frame_wait_s(1.0 + PATIENCE_S, set().__contains__) == 0.0
    driven.shown()
    assert driven.frame_wait_s(1.1 + PATIENCE_S, set().__contains__) == 0.0


def test_batches_of_another_form_are_no_traffic_managers() -> None:
    driven = DrivenVehicles()
    destroy = [[[COMMANDS.index(DestroyActor), [5]]]]
    for commands in (None, 3, [3], [[]], [[[1, [[5]]]]], [[[1, {}]]], destroy):
        assert driven.batch(commands) == []
    assert driven.actor_ids == frozenset()


def test_the_answer_comes_after_that_to_the_batch_and_other_calls_go_on(
    server: RunningServer, manager_port: int
) -> None:
    with RawClient(server.port) as client:
        client.call("add_traffic_manager_running", ["127.0.0.1", manager_port])
        points = client.call("get_map_info")[1]
        cars = [client.call("spawn_actor", [0, "vehicle.tesla.model3", []], point)[0] for point in points[:2]]
        drive = [[[APPLY_LOCATION, [car, [1.0, 2.0, 50.0]]]] for car in cars]
        drive[0][0][1][1][1], drive[1][0][1][1][1] = 2.0, 30.0
        client.send("apply_batch", drive, False)
        client.answer()
        destroyed = client.send("destroy_actor", cars[0])
        seen = client.send("version")
        assert client.answer()[1] == seen
        batch = client.send("apply_batch", drive[1:], False)
        assert [client.answer()[1], client.answer()[1]] == [batch, destroyed]
