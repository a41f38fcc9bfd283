"""Acceptor of RPC and stream connections: a limit on their number, and a timeout for stream peers that send nothing.

A subscriber names its stream at once, so a silent one is closed after a while. A client may be silent for as long as it
likes, because a user may think at a prompt. It is closed only where the process has no files left for others.
"""

import errno
import logging
import selectors
import socket
from collections.abc import Callable
from itertools import chain, islice

from linden.gate.session import Gate
from linden.server.owner import admits, belongs_to
from linden.server.peers import Peer, RpcPeer, StreamPeer
from linden.server.ports import Ports

log = logging.getLogger("linden")

FULL_PAUSE_S = 1.0
"""How long no connection is accepted after the limit was reached."""
SILENT_SUBSCRIBER_S = 10.0
"""How long a stream connection may take to say its four bytes; the official client sends them on connecting."""
ACCEPTED_AT_ONCE = 64
"""Connections accepted on a port before the connected clients have their turn."""
ACCEPT_S = 0.005
"""For how long connections are accepted on a port before the connected clients have their turn.

Each takes some calls of the system, which give Python's lock away. While a thread works in the background, each call
waits up to a millisecond to have it back, and 64 connections take 0.3 s."""
CLOSED_AT_ONCE = 16
"""Silent connections that are closed together when the limit is reached."""
RESERVED_FILES = 64
"""Files of the process that are no connections: its own, those of libraries, maps and recordings."""
MOST_CONNECTIONS_ANYWHERE = 16384
"""Where the system sets no limit: a thousand clients of sixteen streams."""

_NO_ROOM = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)
_OUR_FAULT = (errno.EBADF, errno.EINVAL, errno.ENOTSOCK, errno.EOPNOTSUPP)


def most_connections() -> int:
    """Return how many connections this process may hold: its limit of open files, less what it needs itself."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return MOST_CONNECTIONS_ANYWHERE
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return MOST_CONNECTIONS_ANYWHERE
    return max(RESERVED_FILES, min(soft - RESERVED_FILES, MOST_CONNECTIONS_ANYWHERE))


class Acceptor:
    """Listens on both ports, and knows the connections that have not sent anything yet."""

    def __init__(
        self,
        ports: Ports,
        selector: selectors.BaseSelector,
        clock: Callable[[], float],
        accepted: Callable[[Peer], None],
        close: Callable[[Peer], None],
    ) -> None:
        """``accepted`` is called with a new connection, ``close`` with one to close."""
        self._ports = ports
        self._selector = selector
        self._accepted = accepted
        self._close = close
        self._most = most_connections()
        self._numbered = 0
        self._count = 0
        self._silent: dict[type[Peer], dict[Peer, float]] = {RpcPeer: {}, StreamPeer: {}}  # when each came, in order
        self._closed_until_s: float | None = None
        self._clock = clock
        self.owner: int | None = None
        """The one process with connections that pass no gate; None: all processes."""
        self._open()

    def look(self, now_s: float) -> None:
        """Run timers: listen again after a lack of files, and close connections of silent subscribers."""
        if self._closed_until_s is not None and now_s >= self._closed_until_s:
            self._closed_until_s = None
            self._open()
        while (peer := next(iter(self._silent[StreamPeer]), None)) is not None:
            if now_s - self._silent[StreamPeer][peer] < SILENT_SUBSCRIBER_S:
                break
            log.info("%s is closed: it has not said within %.0f s what it listens to", peer, SILENT_SUBSCRIBER_S)
            self._close(peer)

    def wait_s(self, now_s: float) -> float | None:
        """Return the time until the next timer in s, None where there is none."""
        if self._closed_until_s is None and not self._silent[StreamPeer]:
            return None
        due = [] if self._closed_until_s is None else [self._closed_until_s]
        due += (came_s + SILENT_SUBSCRIBER_S for came_s in islice(self._silent[StreamPeer].values(), 1))
        return max(0.0, min(due) - now_s) if due else None

    def has_spoken(self, peer: Peer) -> None:
        """Note that a connection has sent something."""
        self._silent[type(peer)].pop(peer, None)

    def has_left(self, peer: Peer) -> None:
        """Note that a connection is closed."""
        self._count -= 1
        self._silent[type(peer)].pop(peer, None)

    def listen(self, ports: Ports, gate: Gate) -> None:
        """Accept connections of an agent as well, on ports of its own."""
        for listener, kind in ((ports.rpc, RpcPeer), (ports.streaming, StreamPeer)):
            self._selector.register(
                listener,
                selectors.EVENT_READ,
                lambda _, socket_=listener, kind=kind: self._accept(socket_, kind, gate),
            )

    def stop_listening(self, ports: Ports) -> None:
        """Accept no more connections of an agent, and close its ports."""
        self._selector.unregister(ports.rpc)
        self._selector.unregister(ports.streaming)
        ports.close()

    def _open(self) -> None:
        for listener, kind in ((self._ports.rpc, RpcPeer), (self._ports.streaming, StreamPeer)):
            self._selector.register(
                listener, selectors.EVENT_READ, lambda _, socket_=listener, kind=kind: self._accept(socket_, kind)
            )

    def _accept(self, listener: socket.socket, kind: type[Peer], gate: Gate | None = None) -> None:
        if self._count >= self._most and self._closed_until_s is None:
            self._close_silent(f"{self._count} connections are open")
        until_s = self._clock() + ACCEPT_S
        for _ in range(ACCEPTED_AT_ONCE):
            if self._count >= self._most or self._closed_until_s is not None or self._clock() > until_s:
                return
            try:
                sock, _ = listener.accept()
            except (BlockingIOError, InterruptedError):
                return
            except OSError as error:
                if error.errno in _OUR_FAULT:
                    raise
                if error.errno in _NO_ROOM:
                    self._close_silent(str(error))
                continue  # else it was gone before it was accepted
            if gate is None and self.owner is not None and not belongs_to(sock, self.owner):
                log.info("a connection that is not of process %d is closed: agents use their gate", self.owner)
                sock.close()
                continue
            if gate is not None and not admits(gate.agent, sock):
                sock.close()
                continue
            self._add(sock, kind, gate)

    def _add(self, sock: socket.socket, kind: type[Peer], gate: Gate | None) -> None:
        self._numbered += 1
        try:
            peer = kind(sock, self._numbered)
        except OSError:  # already gone
            sock.close()
            return
        peer.gate = gate
        log.debug("%s has connected", peer)
        self._count += 1
        self._silent[kind][peer] = self._clock()
        self._accepted(peer)

    def _close_silent(self, why: str) -> None:
        """Close the oldest silent connections; where there are none, accept no connection for a while."""
        leaving = tuple(islice(chain(self._silent[StreamPeer], self._silent[RpcPeer]), CLOSED_AT_ONCE))
        for peer in leaving:
            self._close(peer)
        if leaving:
            log.warning("%d silent connections are closed to make room for others: %s", len(leaving), why)
            return
        log.warning("no more connections are accepted for %.0f s: %s", FULL_PAUSE_S, why)
        self._selector.unregister(self._ports.rpc)
        self._selector.unregister(self._ports.streaming)
        self._closed_until_s = self._clock() + FULL_PAUSE_S
