"""Claims about slow readers, between two ends of a pair of sockets; the clock is a number."""

import socket
import struct
from collections.abc import Iterator

import pytest

from linden.protocol.wire.stream import StreamTable
from linden.server import subscribers
from linden.server.peers import StreamPeer
from linden.server.subscribers import PATIENCE_S, Subscribers

STREAM = 5
MESSAGE_BYTES = 200_000


class Listener:
    """A subscriber and the socket from which it reads, or does not."""

    def __init__(self, door: socket.socket, number: int) -> None:
        self.socket = socket.create_connection(door.getsockname(), 10.0)
        accepted, _ = door.accept()
        self.peer = StreamPeer(accepted, number)
        self.peer.subscription.receive(struct.pack("<I", STREAM))

    def next_payload(self) -> bytes:
        """Read one message, while the peer sends what it has."""
        (size,) = struct.unpack("<I", self._exactly(4))
        return self._exactly(size)

    def _exactly(self, size: int) -> bytes:
        data = b""
        self.socket.settimeout(0.0)
        while len(data) < size:
            self.peer.flush()
            try:
                data += self.socket.recv(size - len(data))
            except BlockingIOError:
                continue
        return data


class House:
    """Subscribers to one stream, and what they did to their peers."""

    def __init__(self, listeners: list[Listener]) -> None:
        self.table = StreamTable(2001)
        self.watched: list[StreamPeer] = []
        self.closed: list[StreamPeer] = []
        self.subscribers = Subscribers(self.table, self.watched.append, self.close)
        self.listeners = listeners
        for listener in listeners:
            self.subscribers.add(listener.peer, STREAM)

    def close(self, peer: StreamPeer) -> None:
        self.closed.append(peer)
        self.subscribers.remove(peer)

    def publish(self, mark: int, now_s: float, *, may_drop: bool) -> None:
        payload = bytes([mark]) * MESSAGE_BYTES
        self.subscribers.publish(STREAM, payload, now_s, may_drop=may_drop)


@pytest.fixture
def house() -> Iterator[House]:
    with socket.create_server(("127.0.0.1", 0)) as door:
        listeners = [Listener(door, number) for number in range(3)]
    yield House(listeners)
    for listener in listeners:
        listener.socket.close()
        listener.peer.socket.close()


def test_in_asynchronous_mode_the_newest_message_waits_for_a_slow_reader_and_those_between_are_left_out(
    house: House,
) -> None:
    slow = house.listeners[0]
    sent = 0
    while slow.peer.dropped < 5:
        sent += 1
        house.publish(sent % 251, 0.0, may_drop=True)
    got, newest = [], sent % 251
    while not got or got[-1] != newest:
        payload = slow.next_payload()
        assert payload == payload[:1] * MESSAGE_BYTES  # whole
        got.append(payload[0])
    assert len(got) == sent - slow.peer.dropped
    assert slow.peer.outgoing.waiting_bytes == 0
    assert not house.closed


def test_in_asynchronous_mode_little_waits_for_subscribers_that_never_read(house: House) -> None:
    for mark in range(200):
        house.publish(mark, 0.0, may_drop=True)
    assert all(listener.peer.outgoing.waiting_bytes <= 2 * MESSAGE_BYTES for listener in house.listeners)
    assert house.subscribers.patience_s(0.0) is None


def test_in_synchronous_mode_nothing_is_left_out_and_all_comes_in_its_order(house: House) -> None:
    house.publish(0, 0.0, may_drop=True)
    for mark in range(1, 100):
        house.publish(mark, 0.0, may_drop=mark < 50)  # the mode may change meanwhile
    got = []
    while not got or got[-1] != 99:
        got.append(house.listeners[0].next_payload()[0])
    assert got == sorted(got)
    assert got[-50:] == list(range(50, 100))


def congest(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subscribers, "QUEUED_BYTES", 1_000_000)
    mark = 0
    while len(house.subscribers.congested(10.0)) < 3:
        mark += 1
        house.publish(mark % 251, 10.0, may_drop=False)


def test_frames_wait_for_a_while_and_slow_subscribers_are_then_closed(
    house: House, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    congest(house, monkeypatch)
    assert house.subscribers.patience_s(10.5) == PATIENCE_S - 0.5
    assert house.subscribers.patience_s(10.0 + PATIENCE_S) is None
    assert house.closed == [listener.peer for listener in house.listeners]
    assert caplog.text.count("is closed: in synchronous mode it held up the frames for 4 s") == 3
    assert house.table.listened() == set()


def test_a_subscriber_that_catches_up_holds_up_no_other(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    congest(house, monkeypatch)
    for listener in house.listeners[1:]:
        house.close(listener.peer)
    reader = house.listeners[0]
    while house.subscribers.congested(11.0):
        reader.next_payload()
    assert house.subscribers.patience_s(1000.0) is None
    assert reader.peer not in house.closed


def test_many_slow_subscribers_share_the_limit_of_waiting_bytes(house: House, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subscribers, "QUEUED_BYTES_OF_ALL", 3_000_000)
    mark = 0
    while not house.subscribers.congested(0.0):
        mark += 1
        house.publish(mark % 251, 0.0, may_drop=False)
    waiting = sum(listener.peer.outgoing.waiting_bytes for listener in house.listeners)
    assert waiting <= 3_000_000 + 3 * MESSAGE_BYTES


def test_nothing_is_kept_of_subscribers_that_have_left(house: House) -> None:
    for mark in range(100):
        house.publish(mark, 0.0, may_drop=False)
    for listener in house.listeners:
        house.close(listener.peer)
    house.publish(0, 0.0, may_drop=False)
    assert house.table.listened() == set()
    assert house.subscribers._by_stream == {}
    assert house.subscribers._behind == {}


def test_subscribers_that_do_not_read_wait_together_once_though_their_shares_grow(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(subscribers, "QUEUED_BYTES_OF_ALL", 6_000_000)
    mark = 0
    while not house.subscribers.congested(10.0):
        mark += 1
        house.publish(mark % 251, 10.0, may_drop=False)
    assert house.subscribers.congested(10.0 + PATIENCE_S) == []
    assert len(house.closed) == 3
