"""Opening of the RPC and the stream listening socket, error messages for ports in use, and a check for loopback."""

import errno
import ipaddress
import socket
from typing import NamedTuple

from linden.errors import UserError

BACKLOG = 128
"""Connections waiting to be accepted; a client opens one per stream, all at once after a reload."""

LAST_PORT = 65535


class Ports(NamedTuple):
    """Where clients come in: RPC, and sensor streams."""

    rpc: socket.socket
    streaming: socket.socket

    def close(self) -> None:
        """Stop listening."""
        self.rpc.close()
        self.streaming.close()


def open_ports(host: str, port: int, streaming_port: int | None = None) -> Ports:
    """Listen on both ports.

    Args:
        host: address to bind to.
        port: of the RPC connections; 0 lets the system choose.
        streaming_port: None takes the one after ``port``, as CARLA does, or any where that is 0.

    Raises:
        UserError: a port is taken, not permitted or no port, or there is no such address.
    """
    if streaming_port is None:
        streaming_port = port + 1 if port else 0
    if port == streaming_port != 0:
        raise UserError(f"port {port} cannot be both --port and --streaming-port; name another for the second")
    rpc = _listen(host, port, "--port")
    try:
        return Ports(rpc, _listen(host, streaming_port, "--streaming-port"))
    except UserError:
        rpc.close()
        raise


def is_loopback(host: str) -> bool:
    """Return whether none but this machine reaches an address; a name that nothing is known about is none."""
    try:
        found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)
    except (socket.gaierror, UnicodeError):
        return False
    return all(ipaddress.ip_address(address[0]).is_loopback for *_, address in found)


def port_of(listener: socket.socket) -> int:
    """Return the port a socket listens on."""
    port: int = listener.getsockname()[1]
    return port


def _listen(host: str, port: int, option: str) -> socket.socket:
    if not 0 <= port <= LAST_PORT:
        raise UserError(
            f"cannot listen on port {port}: ports go from 0 to {LAST_PORT}, and --streaming-port is the one after "
            f"--port unless it is named; choose another with {option}"
        )
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
    except (socket.gaierror, UnicodeError) as error:
        raise UserError(f"cannot listen on {host!r}, port {port}: {error}; name an address of this machine") from error
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        raise UserError(_why(host, port, option, error)) from error
    listener.settimeout(0.0)
    return listener


def _why(host: str, port: int, option: str, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return (
            f"port {port} on {host} is in use, perhaps by another server; end that one, or choose with {option} "
            f"(0 lets the system choose)"
        )
    if error.errno == errno.EACCES:
        return f"port {port} may not be used by this user; choose one above 1023 with {option}"
    if error.errno == errno.EADDRNOTAVAIL:
        return f"cannot listen on {host}: this machine has no such address; name one of its own with --host"
    return f"cannot listen on {host}, port {port}: {error}; choose another with --host and {option}"
