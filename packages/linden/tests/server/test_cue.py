"""Claims about the order of a tick's answer and the question of the Traffic Manager before it."""

import time
from collections import deque
from types import SimpleNamespace

from fakes.raw_client import RawClient
from linden.protocol.wire.rpc import Call
from linden.server.cue import (
    MOST_LATE,
    PATIENCE_S,
    SETTLING_S,
    TRUSTED_AGAIN,
    Cue,
)
from servers import RunningServer


def _traffic_manager(client: RawClient, port: int) -> None:
    settings = client.call("get_episode_settings")
    settings[0], settings[2] = True, [True, 0.05]
    client.call("set_episode_settings", settings)
    assert client.call("add_traffic_manager_running", ["127.0.0.1", port])


def _peer(*methods: str) -> SimpleNamespace:
    """A client with these calls, the tick first."""
    return SimpleNamespace(calls=deque(Call(n, name, [], False) for n, name in enumerate(("tick_cue", *methods))))


def test_a_question_behind_a_tick_is_answered_before_it(server: RunningServer, manager_port: int) -> None:
    with RawClient(server.port) as client:
        _traffic_manager(client, manager_port)
        tick = client.request("tick_cue")
        question = client.request("get_episode_settings")
        client.socket.sendall(tick + question)
        first, second = client.answer(), client.answer()
    assert first[1] == second[1] + 1


def test_ticks_stop_waiting_where_no_client_asks() -> None:
    cue, waited_s = Cue(), []
    for _ in range(MOST_LATE + 3):
        cue.ticked(b"frame", now_s=10.0)
        waited_s.append(round(cue.deadline_s - 10.0, 6))
        assert cue.finish() == b"frame"
    assert waited_s == [PATIENCE_S] * MOST_LATE + [0.0] * 3


def test_ticks_wait_again_once_the_question_has_come_in_time_for_long() -> None:
    cue = Cue()
    for _ in range(MOST_LATE):
        cue.ticked(b"frame", now_s=10.0)
        cue.finish()
    cue.answered(11.0)  # the overdue one
    for _ in range(TRUSTED_AGAIN):
        assert cue.late == MOST_LATE
        cue.answered(11.0)
        cue.ticked(b"frame", now_s=11.0)
        cue.finish()
    assert cue.late == 0


def test_a_tick_with_another_call_behind_it_does_not_wait() -> None:
    cue = Cue()
    cue.ticked(b"frame", now_s=10.0)
    assert cue.waits(_peer(), 10.0)
    assert not cue.waits(_peer("apply_batch"), 10.0)
    assert not cue.waits(_peer("get_episode_settings"), 10.0), "that is what it waits for"
    cue.answered(10.0)
    assert cue.waits(_peer("apply_batch"), 10.0 + SETTLING_S / 2.0), "the thread goes to sleep"
    assert not cue.waits(_peer(), 10.0 + SETTLING_S)


def test_the_frames_own_time_is_part_of_the_wait() -> None:
    cue = Cue()
    cue.answered(10.0)
    cue.ticked(b"frame", now_s=10.0 + 2.0 * SETTLING_S)
    assert not cue.waits(_peer(), 10.0 + 2.0 * SETTLING_S)


def test_ticks_of_a_traffic_manager_in_asynchronous_mode_cost_no_wait(server: RunningServer, manager_port: int) -> None:
    with RawClient(server.port) as client:
        _traffic_manager(client, manager_port)
        first, begun_s = client.call("tick_cue"), time.monotonic()
        frames = []
        for _ in range(100):
            behind = client.request("tick_cue") + client.request("get_weather_parameters")
            client.socket.sendall(behind)
            frames.append(client.answer()[3][0][1])
            client.answer()
        took_s = time.monotonic() - begun_s
    assert frames == list(range(first + 1, first + 101))
    assert took_s < 100 * PATIENCE_S / 2.0, "each of them waited"


def test_other_clients_are_served_while_a_tick_waits(server: RunningServer, manager_port: int) -> None:
    with RawClient(server.port) as client, RawClient(server.port) as other:
        _traffic_manager(client, manager_port)
        served = 0
        client.send("tick_cue")
        client.socket.settimeout(0.0)
        while True:
            other.call("version")
            try:
                client.answer()
            except BlockingIOError:
                served += 1
            else:
                break
    assert served >= 3, "the server slept"


def test_a_late_question_counts_for_the_step_it_belongs_to() -> None:
    cue = Cue()
    cue.ticked(b"frame", now_s=0.0)
    cue.finish()  # nobody has asked: the tick went ahead
    cue.answered(1.0)
    assert cue.answered_s is None
    cue.answered(2.0)
    assert cue.answered_s == 2.0


def test_the_wait_after_a_question_is_hardly_longer_than_the_thread_needs(
    server: RunningServer, manager_port: int
) -> None:
    took_s = []
    with RawClient(server.port) as client:
        _traffic_manager(client, manager_port)
        for _ in range(300):
            client.call("get_episode_settings")
            began_s = time.perf_counter()
            client.call("tick_cue")
            took_s.append(time.perf_counter() - began_s)
    assert min(took_s) < SETTLING_S + 0.0005


def test_a_thread_is_left_the_whole_wait_however_quick_its_calls_are(server: RunningServer, manager_port: int) -> None:
    took_s = []
    with RawClient(server.port) as client:
        _traffic_manager(client, manager_port)
        for _ in range(300):
            client.call("get_vehicle_light_states")
            client.call("get_weather_parameters")
            began_s = time.perf_counter()
            client.call("get_episode_settings")
            client.call("tick_cue")
            took_s.append(time.perf_counter() - began_s)
    assert min(took_s) >= SETTLING_S
