"""Control of the gate by the benchmark: one JSON object a line, in on stdin, out on stdout.

::

    {"open": {"vehicle": 24, "track": "objects", "known": [3, 4], "agent": 71}}
                                                   {"gate": {"rpc": 40001, "streaming": 40002}}
    {"sensors": {"vehicle": 24, "ids": [25, 26]}}  {"gate": {}}
    {"see": {"vehicle": 24, "frame": 1200, "ids": [31, 32]}}
    {"close": {"vehicle": 24}}                     {"gate": {"refused": {"tick_cue": 1}}}

A gate is opened for one drive of one vehicle. Opening another for this vehicle closes the one before, with all its
connections. A gate closes connections of other processes than ``agent`` and all that it started. Without ``agent`` all
processes may connect.
"""

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, Protocol

from linden.errors import ProtocolError
from linden.gate.calls import Track

MOST_LINE_BYTES = 1 << 20
"""A line holds ids of actors only: those of a hundred thousand."""


class GatePorts(NamedTuple):
    """Where an agent's client finds its gate."""

    rpc: int
    streaming: int


class GateHost(Protocol):
    """What serves gates: the relay or the server itself."""

    def open_gate(self, track: Track, vehicle_id: int, known: Iterable[int], agent: int | None = None) -> GatePorts:
        """Listen for one agent; ``agent`` is its process."""

    def add_sensors(self, vehicle_id: int, ids: Iterable[int]) -> None:
        """Let the agent of a vehicle hear its sensors."""

    def see(self, vehicle_id: int, frame: int, ids: Iterable[int]) -> None:
        """Say what the agent of a vehicle sees of others in a frame."""

    def close_gate(self, vehicle_id: int) -> Mapping[str, int]:
        """Close the gate of a vehicle with its connections, and return how often each function was refused."""


class Control:
    """Reads the benchmark's lines and carries them out."""

    def __init__(self, host: GateHost, say: Callable[[str], None]) -> None:
        """``say`` prints a line at once."""
        self._host, self._say = host, say
        self._received = b""

    def receive(self, data: bytes) -> None:
        """Take what has come.

        Raises:
            ProtocolError: it is no line of the benchmark's.
        """
        *lines, self._received = (self._received + data).split(b"\n")
        if len(self._received) > MOST_LINE_BYTES:
            raise ProtocolError(f"a line of the gate's control is longer than {MOST_LINE_BYTES} bytes")
        for line in lines:
            try:
                answer = self._carry_out(json.loads(line))
            except (ValueError, LookupError, TypeError, AttributeError) as error:
                raise ProtocolError(f"the gate's control does not understand {line[:200]!r}: {error}") from error
            if answer is not None:
                self._say(json.dumps({"gate": answer}))

    def _carry_out(self, message: dict[str, Any]) -> Mapping[str, Any] | None:
        ((name, value),) = message.items()
        vehicle_id = int(value["vehicle"])
        if name == "see":
            self._host.see(vehicle_id, int(value["frame"]), map(int, value["ids"]))
            return None
        if name == "open":
            agent = value.get("agent")
            return self._host.open_gate(
                Track(value["track"]), vehicle_id, map(int, value["known"]), None if agent is None else int(agent)
            )._asdict()
        if name == "sensors":
            self._host.add_sensors(vehicle_id, map(int, value["ids"]))
            return {}
        if name == "close":
            return {"refused": dict(self._host.close_gate(vehicle_id))}
        raise ValueError(f"there is no order {name!r}")
