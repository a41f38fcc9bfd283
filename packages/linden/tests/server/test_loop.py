"""Claims about the live server, around a world that only counts frames; clients speak bytes, on ports of the system."""

import contextlib
import logging
import re
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise

import pytest

from fakes.raw_client import RawClient, RawSubscriber
from fakes.simulation import FakeFrames, FakeMaps, FakeSimulation
from linden.cli.process import GRACE_S
from linden.errors import Refusal
from linden.protocol.values.episode import EpisodeSettings
from linden.server import loop, subscribers
from linden.server import stall_log as waiting
from linden.server.calls import CALLS_PER_TURN
from linden.server.lamp_readers import READING_S
from linden.server.loop import Server
from linden.server.peers import StreamPeer
from linden.server.ports import open_ports, port_of
from linden.server.rpc import registry

registry.load_handlers()  # as a server's start does

SYNCHRONOUS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
RESET_ALL_LAYERS = (True, 0xFFFF)
ON_THE_WIRE = [True, False, [True, 0.05], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]


class Live:
    """A server in a thread of the test."""

    def __init__(self, settings: EpisodeSettings, frames: FakeFrames) -> None:
        self.ports = open_ports("127.0.0.1", 0)
        self.rpc, self.streaming = port_of(self.ports.rpc), port_of(self.ports.streaming)
        self.simulation = FakeSimulation(settings)
        self.server = Server(self.simulation, FakeMaps(), frames, self.ports)
        self.thread = threading.Thread(target=self.server.run)

    def client(self) -> RawClient:
        return RawClient(self.rpc)

    def subscriber(self, stream_id: int = 1) -> RawSubscriber:
        return RawSubscriber(self.streaming, stream_id)


@contextmanager
def live(settings: EpisodeSettings = SYNCHRONOUS, frames: FakeFrames | None = None) -> Iterator[Live]:
    running = Live(settings, frames or FakeFrames())
    running.thread.start()
    try:
        yield running
    finally:
        running.server.stop()
        running.thread.join(10)
        assert not running.thread.is_alive()


@pytest.fixture
def running() -> Iterator[Live]:
    with live() as server:
        yield server


def test_calls_of_a_connection_are_answered_in_their_order(running: Live) -> None:
    with running.client() as client:
        client.socket.sendall(b"".join(client.request("tick_cue") for _ in range(3 * CALLS_PER_TURN)))
        answers = [client.answer() for _ in range(3 * CALLS_PER_TURN)]
    assert answers == [[1, i, None, [[1, i]]] for i in range(1, 3 * CALLS_PER_TURN + 1)]


def test_a_call_cut_between_packets_waits_for_its_rest(running: Live) -> None:
    with running.client() as client, running.client() as other:
        message = client.request("tick_cue")
        client.socket.sendall(message[:5])
        assert other.call("version") == "0.9.16"  # the server has seen the first part, and serves others
        client.socket.sendall(message[5:])
        assert client.answer() == [1, 1, None, [[1, 1]]]


def test_an_asynchronous_call_is_answered_too_for_its_client_keeps_an_entry_until_then(running: Live) -> None:
    with running.client() as client:
        client.socket.sendall(client.request("destroy_traffic_manager", 8000, is_async=True))
        assert client.answer() == [1, 1, None, [[1, False]]]


def test_bytes_that_are_no_call_close_their_connection_and_no_other(
    running: Live, caplog: pytest.LogCaptureFixture
) -> None:
    with running.client() as polite, running.client() as rude:
        assert polite.call("version") == "0.9.16"
        rude.socket.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert rude.is_closed()
        assert polite.call("tick_cue") == 1
    assert "is closed: expected a request [0, id, method, parameters], got int 71" in caplog.text


def test_calls_before_the_garbage_are_still_answered(running: Live) -> None:
    with running.client() as client:
        client.socket.sendall(client.request("tick_cue") + b"\xc1")
        assert client.answer() == [1, 1, None, [[1, 1]]]
        assert client.is_closed()


def test_calls_sent_before_leaving_are_carried_out(running: Live) -> None:
    with running.client() as client:
        client.socket.sendall(b"".join(client.request("tick_cue") for _ in range(2 * CALLS_PER_TURN)))
        client.socket.shutdown(socket.SHUT_WR)
        for _ in range(2 * CALLS_PER_TURN):
            client.answer()
        assert client.is_closed()


def test_a_client_that_is_killed_leaves_the_others_in_peace(running: Live) -> None:
    with running.client() as survivor:
        killed = running.client()
        killed.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # reset, not closed
        killed.socket.sendall(killed.request("tick_cue")[:-1])
        killed.socket.close()
        assert survivor.call("tick_cue") == 1


def test_a_wrong_type_refuses_one_call_by_a_sentence(running: Live) -> None:
    with running.client() as client:
        with pytest.raises(RuntimeError, match=r"get_sensor_token: argument 1 \(stream_id\): expected an integer"):
            client.call("get_sensor_token", "one")
        with pytest.raises(RuntimeError, match=r"tick_cue takes 0 arguments \(none\), got 1"):
            client.call("tick_cue", 5)
        assert client.call("tick_cue") == 1


def test_what_is_missing_is_refused_by_name(running: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(registry.METHODS, "console_command", raising=False)
    with running.client() as client:
        with pytest.raises(RuntimeError, match=r"linden has no method 'console_command': CARLA 0.9.16 has it"):
            client.call("console_command", "stat fps")
        with pytest.raises(RuntimeError, match="linden has no method 'make_coffee', nor has CARLA"):
            client.call("make_coffee")


def test_a_bug_of_ours_refuses_one_call_and_the_server_goes_on(
    running: Live, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(_dt_s: float) -> None:
        raise ZeroDivisionError("a wheel of no radius")

    with running.client() as client:
        with monkeypatch.context() as patched:
            patched.setattr(running.simulation, "step", broken)
            with pytest.raises(RuntimeError, match=r"internal error .* in tick_cue: ZeroDivisionError: a wheel of no"):
                client.call("tick_cue")
        assert client.call("tick_cue") == 1
    assert "Traceback" in caplog.text


def test_a_bug_in_a_frame_of_asynchronous_mode_is_logged_once_and_the_server_goes_on(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed = threading.Event()
    tries = []

    def broken(dt_s: float) -> None:
        tries.append(dt_s)
        if len(tries) > 3:
            failed.set()
        raise ZeroDivisionError("a wheel of no radius")

    with live(EpisodeSettings(fixed_delta_seconds=0.001)) as running:
        monkeypatch.setattr(running.simulation, "step", broken)
        assert failed.wait(10)
        with running.client() as client:
            assert client.call("version") == "0.9.16"
    assert caplog.text.count("Traceback") == 1


def test_in_synchronous_mode_time_stands_still_between_ticks(running: Live) -> None:
    with running.client() as client, running.client() as other, running.subscriber() as subscriber:
        assert subscriber.frame() == 0  # sent on joining
        assert client.call("tick_cue") == 1
        assert other.call("tick_cue") == 2
        assert [subscriber.frame(), subscriber.frame()] == [1, 2]
        assert running.simulation.steps_s == [0.05, 0.05]


def test_a_tick_waits_for_a_client_that_has_just_requested_a_stream(running: Live) -> None:
    with running.client() as client:
        client.call("get_sensor_token", 1)
        client.send("tick_cue")
        with running.subscriber() as subscriber:
            assert [subscriber.frame(), subscriber.frame()] == [0, 1]  # how it was on joining, and the tick
        client.answer()


def test_an_answer_waits_for_the_scene_and_no_other_call_does(running: Live) -> None:
    sensor_scene = running.simulation.sensor_scene
    with running.client() as client, running.client() as other:
        sensor_scene.is_there = False
        assert client.call("tick_cue") == 1  # nobody listens to a sensor that looks
        number = client.send("version")
        assert other.call("tick_cue") == 2
        sensor_scene.is_there = True
        sensor_scene.when_built()
        assert client.answer() == [1, number, None, [[1, "0.9.16"]]]
        sensor_scene.is_there = False
        assert client.call("version") == "0.9.16"  # it does not wait for ever


@contextmanager
def long_work(monkeypatch: pytest.MonkeyPatch, work: Callable[[], object]) -> Iterator[None]:
    """Let ``version`` return what ``work`` makes in the background."""

    def handler(_context: object) -> registry.Long[object]:
        return (yield work)

    registry.load_handlers()
    found = registry.METHODS["version"]
    with monkeypatch.context() as patched:
        patched.setitem(registry.METHODS, "version", replace(found, handler=handler))
        yield


def test_long_work_is_waited_for_by_its_caller_only(running: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    may_end = threading.Event()
    with long_work(monkeypatch, lambda: may_end.wait(20)), running.client() as client, running.client() as other:
        version, tick = client.send("version"), client.send("tick_cue")
        assert other.call("tick_cue") == 1
        assert other.call("tick_cue") == 2
        may_end.set()
        assert client.answer() == [1, version, None, [[1, True]]]
        assert client.answer() == [1, tick, None, [[1, 3]]]


def test_long_work_that_fails_is_refused(running: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise Refusal("not today")

    def break_down() -> None:
        raise ZeroDivisionError("a wheel of no radius")

    with running.client() as client:
        with long_work(monkeypatch, refuse), pytest.raises(RuntimeError, match="not today"):
            client.call("version")
        with long_work(monkeypatch, break_down), pytest.raises(RuntimeError, match=r"internal error .* no radius"):
            client.call("version")
        assert client.call("version") == "0.9.16"


def test_a_client_that_leaves_before_its_long_work_is_done_leaves_nothing(
    running: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_end = threading.Event()
    with long_work(monkeypatch, lambda: may_end.wait(20)), running.client() as other:
        with running.client() as client:
            client.send("version")
        assert other.call("tick_cue") == 1
        may_end.set()
        assert other.call("tick_cue") == 2


def test_a_call_for_which_the_memory_does_not_suffice_is_refused_even_without_memory_for_a_traceback(
    running: Live, monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_much(*_: object) -> None:
        raise MemoryError

    with running.client() as client:
        with monkeypatch.context() as patched:
            patched.setattr("traceback.format_exception", too_much)
            patched.setattr(running.simulation, "step", too_much)
            with pytest.raises(RuntimeError, match="tick_cue is refused: the server's memory does not suffice"):
                client.call("tick_cue")
            patched.setattr(running.server._acceptor, "look", too_much)
            wait_until(lambda: client.call("version") == "0.9.16")
        assert client.call("tick_cue") == 1


def test_requests_for_streams_without_a_subscriber_hold_up_no_ticks_for_long(running: Live) -> None:
    with running.client() as rude, running.client() as polite:
        for number in range(2000):
            rude.call("get_sensor_token", 1000 + number)  # there are no such streams
            assert polite.call("tick_cue") == number + 1
        for number in range(20):
            rude.call("get_sensor_token", 2 + number)
            polite.call("tick_cue")


def test_a_tick_waits_for_an_expected_subscriber_for_a_limited_time(running: Live) -> None:
    with running.client() as client:
        client.call("get_sensor_token", 1)
        assert client.call("tick_cue") == 1


def test_in_asynchronous_mode_frames_come_by_themselves() -> None:
    with live(EpisodeSettings(fixed_delta_seconds=0.002)) as running, running.subscriber() as subscriber:
        first = subscriber.frame()
        assert [subscriber.frame() for _ in range(5)] == [first + i for i in range(1, 6)]
        assert set(running.simulation.steps_s) == {0.002}


def test_a_tick_is_granted_in_asynchronous_mode_too() -> None:
    with live(EpisodeSettings(fixed_delta_seconds=10.0)) as running, running.client() as client:
        assert client.call("tick_cue") == 1


def test_settings_take_effect_from_the_next_frame_and_name_the_present_one(running: Live) -> None:
    with running.client() as client:
        client.call("tick_cue")
        changed = [True, False, [True, 0.1], *ON_THE_WIRE[3:]]
        assert client.call("set_episode_settings", changed) == 1
        assert client.call("get_episode_settings") == changed
        client.call("tick_cue")
    assert running.simulation.steps_s == [0.05, 0.1]


def test_a_client_that_joins_between_two_ticks_sees_the_world(running: Live) -> None:
    with running.client() as client:
        client.call("tick_cue")
        with running.subscriber() as late:
            assert late.frame() == 1


def test_every_subscriber_has_its_own_copy() -> None:
    with (
        live(frames=FakeFrames(padding_rows=1000)) as running,
        running.client() as client,
        running.subscriber() as one,
        running.subscriber() as another,
    ):
        assert one.frame() == another.frame() == 0
        client.call("tick_cue")
        assert one.message() == another.message()


def test_a_sensor_is_sent_to_its_subscribers() -> None:
    with (
        live(frames=FakeFrames(sensor_bytes=300_000)) as running,
        running.client() as client,
        running.subscriber(1) as observer,
        running.subscriber(2) as listener,
    ):
        assert observer.frame() == 0
        wait_until(lambda: client.call("version") == "0.9.16" and 2 in running.server.context.streams.listened())
        client.call("tick_cue")
        assert len(listener.message()) == 300_000
        assert observer.frame() == 1


def test_a_subscriber_that_says_more_than_a_stream_id_is_closed(running: Live) -> None:
    with running.client() as client, running.subscriber() as subscriber:
        assert subscriber.frame() == 0
        subscriber.socket.sendall(b"more")
        with pytest.raises((EOFError, ConnectionError)):
            subscriber.message()
        assert client.call("tick_cue") == 1


def test_a_subscriber_that_never_reads_holds_up_the_frames_for_a_while_and_is_then_closed(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(subscribers, "QUEUED_BYTES", 1_000_000)
    monkeypatch.setattr(subscribers, "PATIENCE_S", 0.3)
    with live(frames=FakeFrames(padding_rows=2000)) as running, running.client() as client, running.client() as other:
        with running.subscriber() as deaf:
            assert deaf.frame() == 0
            frame = 0
            while "held up the frames" not in caplog.text:
                client.send("tick_cue")
                assert other.call("version") == "0.9.16"  # served meanwhile
                frame += 1
                assert client.answer() == [1, frame, None, [[1, frame]]]
        queued = frame * 2000 * 119
        assert queued < 64_000_000  # the system's own buffers took some too


def test_in_asynchronous_mode_a_subscriber_that_never_reads_misses_frames_and_stays(
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.INFO, "linden")
    settings = EpisodeSettings(fixed_delta_seconds=0.0005)
    with live(settings, FakeFrames(padding_rows=5000)) as running, running.subscriber() as deaf:
        assert deaf.frame() >= 0
        with running.client() as client:
            while "it misses some" not in caplog.text:
                client.call("version")
        frames = [deaf.frame() for _ in range(200)]
        assert frames == sorted(frames)
        assert any(late - early > 1 for early, late in pairwise(frames))


def test_a_client_that_never_reads_its_answers_is_not_listened_to_and_the_others_are(running: Live) -> None:
    running.simulation.opendrive_text = "<OpenDRIVE/>" + " " * 10_000_000
    with running.client() as deaf, running.client() as other:
        deaf.socket.sendall(b"".join(deaf.request("get_map_data") for _ in range(50)))
        assert other.call("tick_cue") == 1
        unsent_bytes = sum(peer.outgoing.waiting_bytes for peer in running.server._clients)
        assert unsent_bytes < 2 * 10_000_012  # what was begun, and not one answer more
        for _ in range(50):
            assert len(deaf.answer()[3][0][1]) == 10_000_012


def test_traffic_managers_go_with_the_client_that_ran_them(running: Live) -> None:
    with running.client() as witness:
        with running.client() as owner:
            assert owner.call("add_traffic_manager_running", ["127.0.0.1", 8000]) is True
            assert witness.call("add_traffic_manager_running", ["127.0.0.1", 8000]) is False
            assert witness.call("get_traffic_manager_running", 8000) == ["127.0.0.1", 8000]
        wait_until(lambda: witness.call("is_traffic_manager_running", 8000) is False)
        assert witness.call("get_traffic_manager_running", 8000) == ["", 0]


def test_a_new_episode_is_loaded_by_name_and_an_empty_name_is_the_present_map(running: Live) -> None:
    with running.client() as client:
        client.call("load_new_episode", "", *RESET_ALL_LAYERS)
        assert client.call("get_map_info")[0] == "Carla/Maps/Plain"
        assert client.call("get_episode_info")[0] == 2
        assert client.call("get_episode_settings")[0] is False
        with pytest.raises(RuntimeError, match="Map 'Atlantis' not found"):
            client.call("load_new_episode", "Atlantis", *RESET_ALL_LAYERS)
        assert client.call("get_episode_info")[0] == 2


def wait_until(condition: Callable[[], bool]) -> None:
    """Ask until it is so; every question is a turn of the server, and pytest's own limit ends it if it never is."""
    while not condition():
        pass


def test_half_received_calls_of_all_clients_together_have_a_limit(
    running: Live, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(loop, "HELD_BYTES_OF_ALL", 20_000_000)
    with running.client() as polite, contextlib.ExitStack() as stack:
        hoarders = [stack.enter_context(running.client()) for _ in range(4)]
        for hoarder in hoarders:
            with contextlib.suppress(ConnectionError):
                hoarder.socket.sendall(hoarder.request("get_sensor_token", bytes(15_000_000))[:-1_000_000])
        assert polite.call("tick_cue") == 1
        wait_until(lambda: polite.call("version") == "0.9.16" and "too much to receive more" in caplog.text)


def test_a_bug_in_greeting_a_subscriber_closes_it_alone(
    running: Live, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(_simulation: object) -> bytes:
        raise ZeroDivisionError("a row of no width")

    with running.client() as client:
        with monkeypatch.context() as patched:
            patched.setattr(running.server.context.frames, "world_payload", broken)
            with running.subscriber() as unlucky, pytest.raises((EOFError, ConnectionError)):
                unlucky.message()
        with running.subscriber() as subscriber:
            assert subscriber.frame() == 0
        assert client.call("tick_cue") == 1
    assert "a row of no width" in caplog.text


def test_a_tick_that_waits_for_a_subscriber_says_so_and_that_it_goes_on(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(subscribers, "QUEUED_BYTES", 1_000_000)
    monkeypatch.setattr(subscribers, "PATIENCE_S", 0.5)
    monkeypatch.setattr(waiting, "HELD_UP_S", 0.1)
    with (
        live(frames=FakeFrames(padding_rows=2000)) as running,
        running.client() as client,
        running.subscriber() as deaf,
    ):
        assert deaf.frame() == 0
        while "held up the frames" not in caplog.text:
            client.call("tick_cue")
        client.call("tick_cue")
    said = [message for message in caplog.messages if "tick" in message]
    assert len(said) == 2
    assert re.match(r"a tick waits for subscriber 2 at 127\.0\.0\.1:\d+ of stream 1, with 1\.\d MiB unread", said[0])
    assert re.match(r"ticks go on after 0\.\d s of waiting for subscribers", said[1])


def test_a_client_that_hangs_while_all_wait_for_its_tick_is_named(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(waiting, "NO_TICK_S", 0.1)
    with live() as running, running.client() as hanging, running.client() as other:
        hanging.call("tick_cue")
        address = f"client 1 at 127.0.0.1:{hanging.socket.getsockname()[1]}"
        wait_until(lambda: other.call("version") == "0.9.16" and "no tick" in caplog.text)
        assert f"after frame 1; waiting for {address}, which made that one" in caplog.text
        hanging.socket.close()
        other.call("tick_cue")
        wait_until(lambda: other.call("version") == "0.9.16" and "the wait for a tick is over after" in caplog.text)


def test_a_thousand_clients_and_subscribers_come_and_go_and_nothing_is_kept_of_them(running: Live) -> None:
    with running.client() as client:
        for _ in range(1000):
            with running.client() as passing:
                passing.call("version")
        for stream_id in range(2, 1002):
            running.subscriber(stream_id).socket.close()
        wait_until(lambda: client.call("version") == "0.9.16" and running.server._acceptor._count == 1)
        assert len(running.server._clients) == 1
        assert not running.server.context.streams.listened()
        assert not running.server._subscribers._by_stream
        assert not running.server._acceptor._silent[StreamPeer]


def test_ten_clients_that_tick_at_once_get_a_frame_each(running: Live) -> None:
    frames: list[list[int]] = [[] for _ in range(10)]

    def tick(mine: list[int]) -> None:
        with running.client() as client:
            mine += [client.call("tick_cue") for _ in range(100)]

    threads = [threading.Thread(target=tick, args=(mine,)) for mine in frames]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert sorted(frame for mine in frames for frame in mine) == list(range(1, 1001))
    assert all(mine == sorted(mine) for mine in frames)


def test_stopping_twice_or_too_late_is_no_error() -> None:
    with live() as running:
        running.server.stop()
        running.thread.join(10)
        running.server.stop()


def stops_after_s(running: Live) -> float:
    """Stop a server and return how long its thread takes to end."""
    began_s = time.monotonic()
    running.server.stop()
    running.thread.join(10)
    return time.monotonic() - began_s


def test_a_server_that_stops_answers_each_client_that_was_told_to_read_the_lamps() -> None:
    with live() as running, running.client() as ticking, running.client() as first, running.client() as second:
        subscribers = [running.subscriber(), running.subscriber()]
        for subscriber in subscribers:
            subscriber.message()
        running.simulation.tells_to_read_lamps = True
        ticking.call("tick_cue")
        running.server.stop()
        for subscriber in subscribers:
            subscriber.message()
        assert first.call("version") == second.call("version")
        assert isinstance(first.call("query_lights_state", ""), list)
        running.thread.join(0.05)
        assert running.thread.is_alive()
        assert isinstance(second.call("query_lights_state", ""), list)
        running.thread.join(0.5 * READING_S)
        assert not running.thread.is_alive()


def test_a_server_that_stops_waits_for_clients_that_read_no_lamps_for_a_limited_time() -> None:
    with live() as running, running.client() as client:
        subscriber = running.subscriber()
        subscriber.message()
        running.simulation.tells_to_read_lamps = True
        client.call("tick_cue")
        assert 0.5 * READING_S < stops_after_s(running) < GRACE_S


def test_a_server_that_stops_makes_no_frames_of_its_own_meanwhile() -> None:
    with live(SYNCHRONOUS._replace(synchronous_mode=False)) as running:
        running.simulation.tells_to_read_lamps = True
        subscriber = running.subscriber()
        subscriber.message()
        running.server.stop()
        running.simulation.tells_to_read_lamps = False
        time.sleep(0.1)
        frame = running.simulation.frame
        time.sleep(0.3)
        assert running.thread.is_alive()
        assert running.simulation.frame == frame


def test_a_server_stops_at_once_if_no_snapshot_told_to_read_the_lamps() -> None:
    with live() as running, running.client() as client:
        subscriber = running.subscriber()
        subscriber.message()
        client.call("tick_cue")
        assert stops_after_s(running) < 0.5 * READING_S


def test_a_server_stops_at_once_if_the_clients_that_were_told_to_read_the_lamps_have_left() -> None:
    with live() as running:
        running.simulation.tells_to_read_lamps = True
        subscriber = running.subscriber()
        subscriber.message()
        subscriber.socket.close()
        assert stops_after_s(running) < 0.5 * READING_S
