"""`OneGate`: opens and closes gates on two ports, one gate at a time; server and relay serve its connections."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping

from linden.gate.calls import Track
from linden.gate.control import GatePorts
from linden.gate.session import Gate
from linden.server.ports import Ports, open_ports, port_of

GATE_HOST = "127.0.0.1"
"""An agent's process runs beside its benchmark, which holds the other end of stdin."""


class OneGate(ABC):
    """A :class:`linden.gate.control.GateHost`."""

    def __init__(self) -> None:
        """No gate is open at first."""
        self._gate: Gate | None = None

    def open_gate(self, track: Track, vehicle_id: int, known: Iterable[int], agent: int | None = None) -> GatePorts:
        """Listen for one agent on two ports of the system's choice.

        Connections are those of the process ``agent`` and all that it started; None: of all processes.
        """
        self.close_gate()
        ports = open_ports(GATE_HOST, 0)
        opened = GatePorts(port_of(ports.rpc), port_of(ports.streaming))
        self._gate = Gate(track, vehicle_id, opened.streaming, known=known, agent=agent)
        self._listen(ports, self._gate)
        return opened

    def add_sensors(self, ids: Iterable[int]) -> None:
        """Let the agent hear its sensors."""
        if self._gate is not None:
            self._gate.add_sensors(ids)

    def see(self, frame: int, ids: Iterable[int]) -> None:
        """Say what the agent sees of others in a frame, and send the frame if it waited for that."""
        if self._gate is not None:
            self._gate.see(frame, ids)
            self._send_held()

    def close_gate(self) -> Mapping[str, int]:
        """Close the gate with its connections, and return how often each function was refused."""
        self._hang_up()
        refused = {} if self._gate is None else dict(self._gate.refused)
        self._gate = None
        return refused

    @abstractmethod
    def _listen(self, ports: Ports, gate: Gate) -> None:
        """Accept connections of the gate's agent."""

    @abstractmethod
    def _send_held(self) -> None:
        """Send the frames that waited for the benchmark's word on what the agent sees."""

    @abstractmethod
    def _hang_up(self) -> None:
        """Accept no more connections, and close the present ones."""
