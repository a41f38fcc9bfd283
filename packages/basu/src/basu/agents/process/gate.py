"""The benchmark's side of gates: opens one for a drive, says what its agent sees, and learns what was refused.

A server of our own has gates in itself. Before any other simulator stands a relay, the process ``linden gate``. Both
take the same orders, lines of JSON (docs/reference/gate.md).
"""

from __future__ import annotations

import contextlib
import json
import subprocess
from typing import TYPE_CHECKING, Any, Protocol

from basu.errors import SimulatorError
from basu.traffic_ports import TRAFFIC_PORTS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

HOST = "127.0.0.1"  # the agent's process is on this machine
END_LIMIT_S = 5.0
PORTS = 3  # of a simulator: calls, streams, and its secondary server


def closed_ports(host: str | None, port: int, *, is_open: bool) -> tuple[int, ...]:
    """Return the ports that the agent's process may neither connect to nor listen at.

    They are those of a simulator at ``host`` and those of the benchmark's Traffic Managers. A server of our own accepts
    its owner's connections only. With ``--open`` none are closed.
    """
    if is_open:
        return ()
    return (*(() if host is None else range(port, port + PORTS)), *TRAFFIC_PORTS)


class Keeper(Protocol):
    """The process that has the gates."""

    def send_order(self, line: str) -> None:
        """Send one line.

        Raises:
            OSError: it has ended.
        """

    def answer(self) -> str:
        """Return the next line of its answers; empty where it has ended."""


class Gates:
    """The gates before one simulator, one for each vehicle that an agent drives."""

    def __init__(self, keeper: Keeper) -> None:
        """``keeper`` has the gates."""
        self._keeper = keeper

    def open(self, track: str, vehicle_id: int, known: Iterable[int], agent: int | None = None) -> Gate:
        """Open a gate for the driver of a vehicle; one that is open for this vehicle is closed.

        ``known`` are actors that it sees in each frame in the track ``objects``. The gate lets in the process ``agent``
        and all that it started; None: all processes.

        Raises:
            SimulatorError: the process of the gates has ended.
        """
        ports = self.asked("open", vehicle_id, track=track, known=list(known), agent=agent)
        return Gate(self, vehicle_id, (HOST, int(ports["rpc"])))

    def asked(self, name: str, vehicle_id: int, **values: Any) -> dict[str, Any]:  # noqa: ANN401 - as JSON has it
        """Send an order about the gate of a vehicle, and return its answer.

        Raises:
            SimulatorError: the process of the gates has ended.
        """
        self.order(name, vehicle_id, **values)
        line = self._keeper.answer()
        if not line:
            raise SimulatorError("the gate between agent and simulator has ended")
        answer: dict[str, Any] = json.loads(line)["gate"]
        return answer

    def order(self, name: str, vehicle_id: int, **values: Any) -> None:  # noqa: ANN401 - as JSON has it
        """Send an order that has no answer.

        Raises:
            SimulatorError: the process of the gates has ended.
        """
        try:
            self._keeper.send_order(json.dumps({name: {"vehicle": vehicle_id, **values}}) + "\n")
        except OSError as error:
            raise SimulatorError(f"the gate between agent and simulator has ended: {error}") from error


class Gate:
    """The gate of one vehicle's driver. `Gates.open` makes one.

    Attributes:
        address: host and port that the agent's client connects to.
    """

    def __init__(self, gates: Gates, vehicle_id: int, address: tuple[str, int]) -> None:
        """Take up a gate that is open."""
        self._gates, self._vehicle_id, self.address = gates, vehicle_id, address

    def add_sensors(self, ids: Iterable[int]) -> None:
        """Let the agent hear sensors that were spawned for it.

        Raises:
            SimulatorError: the process of the gates has ended.
        """
        self._gates.asked("sensors", self._vehicle_id, ids=list(ids))

    def see(self, frame: int, ids: Iterable[int]) -> None:
        """Say which actors the agent sees in a frame, in the track ``objects``; the gate holds the frame until then.

        Raises:
            SimulatorError: the process of the gates has ended.
        """
        self._gates.order("see", self._vehicle_id, frame=frame, ids=list(ids))

    def close(self) -> dict[str, int]:
        """Close the gate with all connections of the agent; how often each function was refused."""
        try:
            return dict(self._gates.asked("close", self._vehicle_id)["refused"])
        except SimulatorError:  # it has ended, and with it all connections
            return {}


class Relay:
    """The process of the relay; it starts with the first order."""

    def __init__(self, command: Sequence[str]) -> None:
        """Name the command that serves gates."""
        self._command = tuple(command)
        self._process: subprocess.Popen[str] | None = None

    @property
    def pid(self) -> int | None:
        """The number of the process; None before the first order."""
        return None if self._process is None else self._process.pid

    def send_order(self, line: str) -> None:
        """Send one line.

        Raises:
            OSError: the process has ended.
        """
        if self._process is None:
            self._process = subprocess.Popen(  # noqa: S603 - our own command
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                start_new_session=True,  # Ctrl-C is for us; it ends with its stdin
            )
        assert self._process.stdin is not None, "it is a pipe"
        self._process.stdin.write(line)
        self._process.stdin.flush()

    def answer(self) -> str:
        """Return the next line of its answers; empty where it has ended."""
        assert self._process is not None, "an order has started it"
        assert self._process.stdout is not None, "it is a pipe"
        return self._process.stdout.readline()

    def end(self) -> None:
        """End the process."""
        if self._process is None:
            return
        assert self._process.stdin is not None, "it is a pipe"
        assert self._process.stdout is not None, "likewise"
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        try:
            self._process.wait(END_LIMIT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
        self._process = None
