"""Claims about the order of answers round a load by a client that runs Traffic Managers."""

import select
import struct
import time
from collections import deque
from types import SimpleNamespace

from fakes.raw_client import RawClient, RawSubscriber
from linden.protocol.wire.commands import COMMANDS, ApplyLocation, DestroyActor
from linden.protocol.wire.rpc import Call
from linden.protocol.wire.stream import WORLD_OBSERVER_ID
from linden.server.load_answers import ASKING_S, GATHERING_S, SETTLING_S, LoadAnswers
from linden.server.peers import RpcPeer
from servers import RunningServer

LOAD = ("load_new_episode", "Linden", True, 0xFFFF)


class FakePeer(SimpleNamespace):
    """A client's calls without its connection."""

    bring_forward = RpcPeer.bring_forward


def _peer(*methods: str) -> FakePeer:
    return FakePeer(calls=deque(Call(n, name, [], False) for n, name in enumerate(methods)))


def test_a_load_waits_until_each_traffic_managers_thread_stands_in_a_call() -> None:
    answers = LoadAnswers(b"loaded", threads=2, until_s=GATHERING_S)
    assert answers.waits(_peer("load_new_episode"), 0.0)
    assert answers.waits(_peer("load_new_episode", "get_episode_settings"), 0.0)
    assert not answers.waits(_peer("load_new_episode", "get_episode_settings", "apply_batch"), 0.0)
    assert not answers.waits(_peer("load_new_episode"), GATHERING_S), "they sleep: synchronous mode"


def test_their_calls_wait_until_the_client_has_its_episode() -> None:
    answers = LoadAnswers(b"loaded", threads=1, until_s=GATHERING_S)
    assert answers.answered(1.0) == b"loaded"
    assert answers.waits(_peer("apply_batch"), 1.0)
    peer = _peer("apply_batch", "version")
    assert not answers.waits(peer, 1.0)
    assert answers.bring_forward(peer, 1.0)
    assert peer.calls[0].method == "version"
    peer = _peer("apply_batch", "get_episode_info")
    assert answers.bring_forward(peer, 1.5)
    assert answers.waits(_peer("apply_batch"), 1.5)
    assert not answers.waits(_peer("apply_batch"), 1.5 + SETTLING_S)


def test_a_client_that_never_asks_gets_its_other_answers() -> None:
    answers = LoadAnswers(b"loaded", threads=1, until_s=GATHERING_S)
    answers.answered(1.0)
    assert not answers.waits(_peer("apply_batch"), 1.0 + ASKING_S)


def test_the_order_of_answers_is_load_episode_and_then_the_threads_call(
    server: RunningServer, manager_port: int
) -> None:
    with RawClient(server.port) as client:
        assert client.call("add_traffic_manager_running", ["127.0.0.1", manager_port])
        before = client.call("get_episode_info")
        load, thread = client.send(*LOAD), client.send("get_weather_parameters")
        assert client.answer()[1] == load
        version, info = client.send("version"), client.send("get_episode_info")
        answers = [client.answer() for _ in range(3)]
        after = client.call("get_episode_info")
    assert [answer[1] for answer in answers] == [version, info, thread]
    assert answers[1][3][0][1][0] == before[0], "the new episode has begun already"
    assert after[0] != before[0]


def test_a_client_that_vanishes_in_a_load_leaves_a_new_episode(server: RunningServer, manager_port: int) -> None:
    with RawClient(server.port) as watcher:
        before = watcher.call("get_episode_info")[0]
        with RawClient(server.port) as client:
            assert client.call("add_traffic_manager_running", ["127.0.0.1", manager_port])
            client.send(*LOAD)
            client.send("get_weather_parameters")
            client.answer()
        deadline_s = time.monotonic() + 5.0
        while watcher.call("get_episode_info")[0] == before:
            assert time.monotonic() < deadline_s, "the load is lost"


def test_a_load_is_answered_where_no_thread_calls(server: RunningServer, manager_port: int) -> None:
    with RawClient(server.port) as client:
        assert client.call("add_traffic_manager_running", ["127.0.0.1", manager_port])
        client.call(*LOAD)
        assert client.call("get_weather_parameters")


def _episodes(watcher: RawSubscriber) -> list[int]:
    """Return the episode of each snapshot that has arrived; a frame's header takes 48 bytes before it."""
    found = []
    while select.select([watcher.socket], [], [], 0.0)[0]:
        found.append(struct.unpack_from("<Q", watcher.message(), 48)[0])
    return found


def test_the_client_that_loads_learns_of_the_new_episode_when_all_others_do(
    server: RunningServer, manager_port: int
) -> None:
    with (
        RawClient(server.port) as client,
        RawSubscriber(server.streaming_port, WORLD_OBSERVER_ID) as watcher,
    ):
        client.call("add_traffic_manager_running", ["127.0.0.1", manager_port])
        start = client.call("get_map_info")[1][0]
        car = client.call("spawn_actor", [0, "vehicle.tesla.model3", []], start)[0]
        client.call("apply_batch", [[[COMMANDS.index(ApplyLocation), [car, start[0]]]]], False)
        before = client.call("get_episode_info")[0]
        while before not in _episodes(watcher):  # the thread begins a step on this frame, and never ends it
            time.sleep(0.01)
        client.call("apply_batch", [[[COMMANDS.index(DestroyActor), [car]]]], False)
        client.call(*LOAD)
        client.call("version")
        assert client.call("get_episode_info")[0] == before
        client.call("get_episode_settings")
        after = client.call("get_episode_info")[0]
        seen = _episodes(watcher)
    assert after != before
    assert after in seen, "another client still has the old episode"
