"""`GateKeeper`: opens and closes gates, one a vehicle, each on two ports; server and relay serve the connections."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from linden.gate.calls import Track
from linden.gate.control import GatePorts
from linden.gate.session import Gate
from linden.server.ports import Ports, open_ports, port_of

GATE_HOST = "127.0.0.1"
"""An agent's process runs beside its benchmark, which holds the other end of stdin."""


class _Open(NamedTuple):
    """A gate with the ports that it listens on."""

    gate: Gate
    ports: Ports


class GateKeeper(ABC):
    """A :class:`linden.gate.control.GateHost`."""

    def __init__(self) -> None:
        """No gate is open at first."""
        self._gates: dict[int, _Open] = {}  # by the vehicle that its agent drives

    def open_gate(self, track: Track, vehicle_id: int, known: Iterable[int], agent: int | None = None) -> GatePorts:
        """Close the vehicle's old gate, and listen for one agent on two free ports.

        Connections are those of the process ``agent`` and all that it started; None: of all processes.
        """
        self.close_gate(vehicle_id)
        ports = open_ports(GATE_HOST, 0)
        opened = GatePorts(port_of(ports.rpc), port_of(ports.streaming))
        gate = Gate(track, vehicle_id, opened.streaming, known=known, agent=agent)
        self._gates[vehicle_id] = _Open(gate, ports)
        self._listen(ports, gate)
        return opened

    def add_sensors(self, vehicle_id: int, ids: Iterable[int]) -> None:
        """Let the agent of a vehicle hear its sensors."""
        if vehicle_id in self._gates:
            self._gates[vehicle_id].gate.add_sensors(ids)

    def see(self, vehicle_id: int, frame: int, ids: Iterable[int]) -> None:
        """Say what the agent of a vehicle sees of others in a frame, and send the frame if it waited for that."""
        if vehicle_id in self._gates:
            gate = self._gates[vehicle_id].gate
            gate.see(frame, ids)
            self._send_held(gate)

    def close_gate(self, vehicle_id: int) -> Mapping[str, int]:
        """Close the gate of a vehicle with its connections, and return how often each function was refused."""
        closed = self._gates.pop(vehicle_id, None)
        if closed is None:
            return {}
        self._hang_up(closed.gate, closed.ports)
        return dict(closed.gate.refused)

    def close_all(self) -> None:
        """Close every gate."""
        for vehicle_id in tuple(self._gates):
            self.close_gate(vehicle_id)

    @abstractmethod
    def _listen(self, ports: Ports, gate: Gate) -> None:
        """Accept connections of the gate's agent."""

    @abstractmethod
    def _send_held(self, gate: Gate) -> None:
        """Send the frames that waited for the benchmark's word on what the gate's agent sees."""

    @abstractmethod
    def _hang_up(self, gate: Gate, ports: Ports) -> None:
        """Accept no more connections of a gate's agent, and close the present ones and the ports."""
