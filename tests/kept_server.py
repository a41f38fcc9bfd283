"""One server for all runs of a process that would start one of their own, as if all were runs of one command.

A start takes 1.2 s of processor time, and the maps that a new client reads 0.6 s. From its second run on, a command
begins the world of its server anew; so does each run here.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import carla
import pytest

from basu import simulator
from basu.conditions import SimulatorSpec
from basu.simulator import OwnServer
from shared_client import Connect, SharedClient
from tracing import untraced

Start = Callable[[SimulatorSpec], OwnServer]
TIMEOUT_S = 20.0


class KeptServer:
    """Starts a server at the first request and lends it to all later ones. Options of servers get one of their own."""

    def __init__(self, start: Start) -> None:
        """``start`` is the benchmark's own function."""
        self._start = start
        self._server: OwnServer | None = None
        self._clients: SharedClient | None = None  # of the server's port
        self.elsewhere: Connect = simulator.connect  # what connects to other servers

    def own_server(self, spec: SimulatorSpec) -> "OwnServer | Lent":
        """Return a server for one command, as ``basu.simulator.own_server`` does."""
        if spec.recordings is not None or spec.maps:
            return self._start(spec)
        if self._server is None or self._server.ended():
            with untraced():
                self._server = self._start(spec)
                self._server.await_ready()
            self._clients = SharedClient(self._server.port, self.elsewhere)
        else:
            self.connect("127.0.0.1", self._server.port, TIMEOUT_S).reload_world(reset_settings=False)
        return Lent(self._server)

    def connect(self, host: str, port: int, timeout_s: float) -> carla.Client:
        """Return the shared client at the server's port, and what ``elsewhere`` gives at others."""
        if self._server is None or self._clients is None or port != self._server.port:
            return self.elsewhere(host, port, timeout_s)
        return self._clients.connect(host, port, timeout_s)

    def end(self) -> None:
        """End the server."""
        if self._server is not None:
            self._server.end()


class Lent:
    """A server that stays when its command ends."""

    def __init__(self, server: OwnServer) -> None:
        """Lend ``server``."""
        self.port, self.gone, self.ended = server.port, server.gone, server.ended
        self.send_order, self.answer = server.send_order, server.answer

    def await_ready(self) -> None:
        """It is ready."""

    def end(self) -> None:
        """It stays."""


_kept: list[KeptServer] = []


@contextmanager
def kept_server() -> Iterator[None]:
    """Have each command of this process that would start a server take the one that is kept; it starts at the first."""
    if not _kept:
        _kept.append(KeptServer(simulator.own_server))
    _kept[0].elsewhere = simulator.connect
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator, "own_server", _kept[0].own_server)
        patch.setattr(simulator, "connect", _kept[0].connect)
        yield


def end_kept_server() -> None:
    """End the server that was kept, if there is one."""
    while _kept:
        _kept.pop().end()
