"""`Gates`: the gates of this server, with the connections of their agents."""

from collections.abc import Callable

from linden.gate.session import Gate
from linden.server.accept import Acceptor
from linden.server.gate_keeper import GateKeeper
from linden.server.peers import Peer, StreamPeer
from linden.server.ports import Ports
from linden.server.subscribers import Subscribers


class Gates(GateKeeper):
    """Opens gates for agents, and knows the agents' connections."""

    def __init__(
        self,
        acceptor: Acceptor,
        subscribers: Subscribers,
        clock: Callable[[], float],
        close: Callable[[Peer], None],
    ) -> None:
        """``close`` is called with a connection to close."""
        super().__init__()
        self._acceptor, self._subscribers, self._clock, self._close = acceptor, subscribers, clock, close
        self._peers: dict[Peer, None] = {}  # an ordered set

    def came(self, peer: Peer) -> None:
        """Note a new connection."""
        if peer.gate is not None:
            self._peers[peer] = None

    def left(self, peer: Peer) -> None:
        """Note that a connection is closed."""
        self._peers.pop(peer, None)

    def _listen(self, ports: Ports, gate: Gate) -> None:
        self._acceptor.listen(ports, gate)

    def _send_held(self, gate: Gate) -> None:
        for peer in tuple(self._peers):
            if isinstance(peer, StreamPeer) and peer.gate is gate and peer.held is not None:
                self._subscribers.send(peer, peer.held, self._clock(), may_drop=False)

    def _hang_up(self, gate: Gate, ports: Ports) -> None:
        self._acceptor.stop_listening(ports)
        for peer in tuple(self._peers):
            if peer.gate is gate:
                self._close(peer)
