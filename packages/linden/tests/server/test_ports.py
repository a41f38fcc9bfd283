"""Claims about the listening sockets."""

import socket

import pytest

from linden.errors import UserError
from linden.server.ports import is_loopback, open_ports, port_of


def test_port_0_lets_the_system_choose_both() -> None:
    ports = open_ports("127.0.0.1", 0)
    assert port_of(ports.rpc) != port_of(ports.streaming)
    assert ports.rpc.getsockname()[0] == "127.0.0.1"
    ports.close()


def test_a_port_in_use_is_a_sentence_and_leaves_nothing_open() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        with pytest.raises(UserError, match=r"port \d+ on 127.0.0.1 is in use.*--port"):
            open_ports("127.0.0.1", port_of(taken))
        free = open_ports("127.0.0.1", 0)
        rpc_port = port_of(free.rpc)
        free.close()
        with pytest.raises(UserError, match="in use"):
            open_ports("127.0.0.1", rpc_port, port_of(taken))
        open_ports("127.0.0.1", rpc_port, 0).close()


@pytest.mark.parametrize(("host", "port"), [("no.such.host.invalid", 0), ("127.0.0.1", 70_000), ("192.0.2.1", 0)])
def test_an_address_that_cannot_be_is_a_sentence(host: str, port: int) -> None:
    with pytest.raises(UserError, match="cannot listen on"):
        open_ports(host, port)


@pytest.mark.parametrize(
    ("host", "is_here"),
    [("127.0.0.1", True), ("127.5.0.1", True), ("::1", True), ("0.0.0.0", False), ("::", False), ("no.such", False)],
)
def test_only_a_loopback_address_is_out_of_reach_of_others(host: str, *, is_here: bool) -> None:
    assert is_loopback(host) is is_here
