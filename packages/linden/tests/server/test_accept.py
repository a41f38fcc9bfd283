"""Claims about new connections: accepted up to the limit, and closed where they stay silent. The clock is a number."""

import errno
import selectors
import socket
from collections.abc import Iterator

import pytest

from linden.server import accept
from linden.server.accept import CLOSED_AT_ONCE, FULL_PAUSE_S, SILENT_SUBSCRIBER_S, Acceptor, most_connections
from linden.server.peers import Peer, RpcPeer, StreamPeer
from linden.server.ports import Ports, open_ports


class Listening:
    """An acceptor and the connections that it accepted."""

    def __init__(self, ports: Ports) -> None:
        self.ports = ports
        self.now_s = 100.0
        self.seconds_a_look = 0.0
        self.inside: list[Peer] = []
        self.outside: list[socket.socket] = []
        self.selector = selectors.DefaultSelector()
        self.acceptor = Acceptor(ports, self.selector, self.look, self.inside.append, self.close_peer)

    def look(self) -> float:
        """Return the time on the clock, which goes on by each look."""
        self.now_s += self.seconds_a_look
        return self.now_s

    def close_peer(self, peer: Peer) -> None:
        self.inside.remove(peer)
        self.acceptor.has_left(peer)
        peer.socket.close()

    def connect(self, listener: socket.socket, times: int = 1) -> None:
        self.outside += [socket.create_connection(listener.getsockname(), 10.0) for _ in range(times)]

    def turn(self, now_s: float | None = None) -> None:
        self.now_s = self.now_s if now_s is None else now_s
        for key, events in self.selector.select(0.0):
            key.data(events)
        self.acceptor.look(self.now_s)


@pytest.fixture
def server() -> Iterator[Listening]:
    ports = open_ports("127.0.0.1", 0)
    found = Listening(ports)
    yield found
    for each in (*found.outside, *(peer.socket for peer in found.inside), *ports):
        each.close()
    found.selector.close()


def test_a_crowd_is_accepted_at_once(server: Listening) -> None:
    server.connect(server.ports.rpc, 40)
    server.connect(server.ports.streaming, 20)
    server.turn()
    assert [sum(type(peer) is kind for peer in server.inside) for kind in (RpcPeer, StreamPeer)] == [40, 20]
    assert [peer.number for peer in server.inside] == list(range(1, 61))


def test_connected_clients_have_their_turn_where_each_connection_takes_long(server: Listening) -> None:
    server.connect(server.ports.rpc, 40)
    server.seconds_a_look = 0.001
    server.turn()
    assert 1 <= len(server.inside) <= 6
    for _ in range(40):
        server.turn()
    assert len(server.inside) == 40


def test_a_subscriber_that_says_nothing_is_closed_and_a_client_may_be_silent(server: Listening) -> None:
    server.connect(server.ports.rpc)
    server.connect(server.ports.streaming, 2)
    server.turn()
    server.acceptor.has_spoken(next(peer for peer in server.inside if isinstance(peer, StreamPeer)))
    assert server.acceptor.wait_s(101.0) == SILENT_SUBSCRIBER_S - 1.0
    server.turn(100.0 + SILENT_SUBSCRIBER_S)
    assert [type(peer) for peer in server.inside] == [RpcPeer, StreamPeer]
    server.turn(100_000.0)
    assert len(server.inside) == 2
    assert server.acceptor.wait_s(100_000.0) is None


def test_without_room_silent_connections_are_closed_and_others_stay(
    server: Listening, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(server.acceptor, "_most", 30)
    server.connect(server.ports.rpc, 30)
    server.turn()
    known = server.inside[:5]
    for peer in known:
        server.acceptor.has_spoken(peer)
    server.connect(server.ports.rpc)
    server.turn()
    assert len(server.inside) == 30 - CLOSED_AT_ONCE + 1
    assert server.inside[:5] == known
    assert "16 silent connections are closed to make room for others: 30 connections are open" in caplog.text


def test_where_no_connection_is_silent_none_is_accepted_for_a_while(
    server: Listening, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(server.acceptor, "_most", 3)
    server.connect(server.ports.rpc, 4)
    server.turn()
    for peer in server.inside:
        server.acceptor.has_spoken(peer)
    server.connect(server.ports.streaming)  # both doors are knocked at in the turn in which they close
    server.turn()
    assert len(server.inside) == 3
    assert "no more connections are accepted for 1 s" in caplog.text
    assert server.acceptor.wait_s(server.now_s) == FULL_PAUSE_S
    server.close_peer(server.inside[0])
    server.turn(server.now_s + FULL_PAUSE_S)
    server.turn()
    assert len(server.inside) == 3


class Failing:
    """A door at which the system fails once."""

    def __init__(self, listener: socket.socket, code: int) -> None:
        self.listener, self.code = listener, code

    def accept(self) -> tuple[socket.socket, object]:
        if self.code:
            code, self.code = self.code, 0
            raise OSError(code, "as the system says")
        return self.listener.accept()


@pytest.mark.parametrize("code", [errno.ECONNABORTED, errno.EPROTO, errno.EPERM])
def test_a_connection_closed_before_its_accept_keeps_no_other_out(server: Listening, code: int) -> None:
    server.connect(server.ports.rpc)
    server.acceptor._accept(Failing(server.ports.rpc, code), RpcPeer)
    assert len(server.inside) == 1


def test_a_system_without_files_stops_accepting_for_a_while(server: Listening) -> None:
    server.connect(server.ports.rpc)
    server.acceptor._accept(Failing(server.ports.rpc, errno.EMFILE), RpcPeer)
    assert not server.inside
    server.turn(server.now_s + FULL_PAUSE_S)
    server.turn()
    assert len(server.inside) == 1


def test_some_files_are_kept_for_what_is_no_connection() -> None:
    assert accept.RESERVED_FILES <= most_connections() <= accept.MOST_CONNECTIONS_ANYWHERE
