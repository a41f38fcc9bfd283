"""`Gates`: the gate sessions of this server, a :class:`linden.gate.control.GateHost`; one is open at a time."""

from collections.abc import Callable, Iterable, Mapping

from linden.gate.calls import Track
from linden.gate.control import GatePorts
from linden.gate.session import Gate
from linden.server.accept import Acceptor
from linden.server.peers import Peer, StreamPeer
from linden.server.ports import open_ports, port_of
from linden.server.subscribers import Subscribers

GATE_HOST = "127.0.0.1"
"""An agent's process runs beside its benchmark, which holds the other end of stdin."""


class Gates:
    """Opens a gate for one agent after the other, and knows the agent's connections."""

    def __init__(
        self,
        acceptor: Acceptor,
        subscribers: Subscribers,
        clock: Callable[[], float],
        close: Callable[[Peer], None],
    ) -> None:
        """``close`` is called with a connection to close."""
        self._acceptor, self._subscribers, self._clock, self._close = acceptor, subscribers, clock, close
        self._gate: Gate | None = None
        self._peers: dict[Peer, None] = {}  # an ordered set

    def came(self, peer: Peer) -> None:
        """Note a new connection."""
        if peer.gate is not None:
            self._peers[peer] = None

    def left(self, peer: Peer) -> None:
        """Note that a connection is closed."""
        self._peers.pop(peer, None)

    def open_gate(self, track: Track, vehicle_id: int, known: Iterable[int]) -> GatePorts:
        """Listen for one agent on two ports of the system's choice."""
        self.close_gate()
        ports = open_ports(GATE_HOST, 0)
        opened = GatePorts(port_of(ports.rpc), port_of(ports.streaming))
        self._gate = Gate(track, vehicle_id, opened.streaming, known=known)
        self._acceptor.listen(ports, self._gate)
        return opened

    def add_sensors(self, ids: Iterable[int]) -> None:
        """Let the agent hear its sensors."""
        if self._gate is not None:
            self._gate.add_sensors(ids)

    def see(self, frame: int, ids: Iterable[int]) -> None:
        """Say what the agent sees of others in a frame, and send the frame where it waited for that."""
        if self._gate is None:
            return
        self._gate.see(frame, ids)
        for peer in tuple(self._peers):
            if isinstance(peer, StreamPeer) and peer.held is not None:
                self._subscribers.send(peer, peer.held, self._clock(), may_drop=False)

    def close_gate(self) -> Mapping[str, int]:
        """Close the gate with its connections, and return how often each function was refused."""
        self._acceptor.stop_listening()
        for peer in tuple(self._peers):
            self._close(peer)
        refused = {} if self._gate is None else dict(self._gate.refused)
        self._gate = None
        return refused
