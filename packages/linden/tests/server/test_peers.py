"""Claims about what a connection holds of what it has received."""

import socket
from collections.abc import Iterator

import msgpack
import pytest

from linden.server.peers import RpcPeer


@pytest.fixture
def peer() -> Iterator[RpcPeer]:
    """A client's connection without any traffic."""
    with socket.create_server(("127.0.0.1", 0)) as listener, socket.create_connection(listener.getsockname()) as client:
        accepted, _ = listener.accept()
        with accepted:
            yield RpcPeer(accepted, 1)
        assert client.fileno() >= 0


def call(arrays: int) -> bytes:
    packed: bytes = msgpack.packb([0, 1, "version", [[False], [[]] * arrays]])
    return packed


def test_calls_that_wait_are_held_as_half_received_ones_are(peer: RpcPeer) -> None:
    whole, half = call(1000), call(3000)[:2000]
    peer.receive(whole)
    assert peer.held()[0] == len(whole)
    assert 1000 <= peer.held()[1] < 1010
    peer.receive(whole + half)
    assert peer.held()[0] == 2 * len(whole) + len(half)
    assert 3900 < peer.held()[1] < 4010
    peer.calls.popleft()
    assert peer.held()[0] == 2 * len(whole) + len(half)  # the two came together with the first
    peer.calls.clear()
    assert peer.held()[0] == len(half)


def test_nothing_is_held_of_calls_that_are_carried_out(peer: RpcPeer) -> None:
    for _ in range(5):
        peer.receive(call(100))
        assert peer.held()[0] == len(call(100))
        peer.calls.clear()
        assert peer.held() == (0, 0)
