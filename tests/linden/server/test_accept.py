"""Claims about newcomers: let in while there is room, shown out where they say nothing. The clock is a number."""

import errno
import selectors
import socket
from collections.abc import Iterator

import pytest

from linden.server import accept
from linden.server.accept import FULL_PAUSE_S, SHOWN_OUT_AT_ONCE, SILENT_SUBSCRIBER_S, Acceptor, most_connections
from linden.server.peers import Peer, RpcPeer, StreamPeer
from linden.server.ports import Ports, open_ports


class House:
    """An acceptor and the connections that it accepted."""

    def __init__(self, ports: Ports) -> None:
        self.ports = ports
        self.now_s = 100.0
        self.inside: list[Peer] = []
        self.outside: list[socket.socket] = []
        self.selector = selectors.DefaultSelector()
        self.acceptor = Acceptor(ports, self.selector, lambda: self.now_s, self.inside.append, self.show_out)

    def show_out(self, peer: Peer) -> None:
        self.inside.remove(peer)
        self.acceptor.has_left(peer)
        peer.socket.close()

    def knock(self, door: socket.socket, times: int = 1) -> None:
        self.outside += [socket.create_connection(door.getsockname(), 10.0) for _ in range(times)]

    def turn(self, now_s: float | None = None) -> None:
        self.now_s = self.now_s if now_s is None else now_s
        for key, events in self.selector.select(0.0):
            key.data(events)
        self.acceptor.look(self.now_s)


@pytest.fixture
def house() -> Iterator[House]:
    ports = open_ports("127.0.0.1", 0)
    found = House(ports)
    yield found
    for each in (*found.outside, *(peer.socket for peer in found.inside), *ports):
        each.close()
    found.selector.close()


def test_a_crowd_is_let_in_at_once(house: House) -> None:
    house.knock(house.ports.rpc, 40)
    house.knock(house.ports.streaming, 20)
    house.turn()
    assert [sum(type(peer) is kind for peer in house.inside) for kind in (RpcPeer, StreamPeer)] == [40, 20]
    assert [peer.number for peer in house.inside] == list(range(1, 61))


def test_a_subscriber_that_says_nothing_is_shown_out_and_a_client_may_be_silent(house: House) -> None:
    house.knock(house.ports.rpc)
    house.knock(house.ports.streaming, 2)
    house.turn()
    house.acceptor.has_spoken(next(peer for peer in house.inside if isinstance(peer, StreamPeer)))
    assert house.acceptor.wait_s(101.0) == SILENT_SUBSCRIBER_S - 1.0
    house.turn(100.0 + SILENT_SUBSCRIBER_S)
    assert [type(peer) for peer in house.inside] == [RpcPeer, StreamPeer]
    house.turn(100_000.0)
    assert len(house.inside) == 2
    assert house.acceptor.wait_s(100_000.0) is None


def test_without_room_silent_connections_are_closed_and_others_stay(
    house: House, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(house.acceptor, "_most", 30)
    house.knock(house.ports.rpc, 30)
    house.turn()
    known = house.inside[:5]
    for peer in known:
        house.acceptor.has_spoken(peer)
    house.knock(house.ports.rpc)
    house.turn()
    assert len(house.inside) == 30 - SHOWN_OUT_AT_ONCE + 1
    assert house.inside[:5] == known
    assert "16 silent connections are closed to make room for others: 30 connections are open" in caplog.text


def test_where_all_have_spoken_the_doors_close_for_a_while(
    house: House, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(house.acceptor, "_most", 3)
    house.knock(house.ports.rpc, 4)
    house.turn()
    for peer in house.inside:
        house.acceptor.has_spoken(peer)
    house.knock(house.ports.streaming)  # both doors are knocked at in the turn in which they close
    house.turn()
    assert len(house.inside) == 3
    assert "no more connections are accepted for 1 s" in caplog.text
    assert house.acceptor.wait_s(house.now_s) == FULL_PAUSE_S
    house.show_out(house.inside[0])
    house.turn(house.now_s + FULL_PAUSE_S)
    house.turn()
    assert len(house.inside) == 3


class Failing:
    """A door at which the system fails once."""

    def __init__(self, door: socket.socket, code: int) -> None:
        self.door, self.code = door, code

    def accept(self) -> tuple[socket.socket, object]:
        if self.code:
            code, self.code = self.code, 0
            raise OSError(code, "as the system says")
        return self.door.accept()


@pytest.mark.parametrize("code", [errno.ECONNABORTED, errno.EPROTO, errno.EPERM])
def test_a_connection_closed_before_its_accept_keeps_no_other_out(house: House, code: int) -> None:
    house.knock(house.ports.rpc)
    house.acceptor._let_in(Failing(house.ports.rpc, code), RpcPeer)
    assert len(house.inside) == 1


def test_a_system_without_files_closes_the_doors(house: House) -> None:
    house.knock(house.ports.rpc)
    house.acceptor._let_in(Failing(house.ports.rpc, errno.EMFILE), RpcPeer)
    assert not house.inside
    house.turn(house.now_s + FULL_PAUSE_S)
    house.turn()
    assert len(house.inside) == 1


def test_some_files_are_kept_for_what_is_no_connection() -> None:
    assert accept.RESERVED_FILES <= most_connections() <= accept.MOST_CONNECTIONS_ANYWHERE
