"""What benchmarks with a live server share: the server in a process of its own, its snapshots, a synchronous world."""

import re
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import carla
import numpy as np
import psutil
from numpy.typing import NDArray

from linden.protocol.values.snapshot import VEHICLE_ROW

LINDEN = ["-m", "linden.cli", "serve", "--port", "0", "--sync"]
HEADERS_BYTES = 48 + 36
WORLD_OBSERVER = 1
STEP_S = 0.05


class Live(NamedTuple):
    """A server that is ready."""

    process: psutil.Process
    port: int
    streaming_port: int
    start_s: float


@contextmanager
def server(arguments: list[str]) -> Iterator[Live]:
    """Start a server with these arguments of Python; end it at the end of the block."""
    begin = time.perf_counter()
    process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE, text=True)
    try:
        ready = next((line for line in process.stdout if line.startswith("linden: ready")), None)
        if ready is None:
            raise SystemExit("the server ended before it was ready")
        port, streaming_port = (int(number) for number in re.findall(r"port (\d+)", ready))
        yield Live(psutil.Process(process.pid), port, streaming_port, time.perf_counter() - begin)
    finally:
        process.terminate()
        process.wait()


def synchronous_world(client: carla.Client) -> carla.World:
    """Return the client's world in synchronous mode, in steps of ``STEP_S``."""
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    return world


class Snapshots:
    """The world's snapshots as they lie on the wire, read beside the official client."""

    def __init__(self, live: Live) -> None:
        self._socket = socket.create_connection(("127.0.0.1", live.streaming_port), timeout=60.0)
        self._socket.sendall(struct.pack("<I", WORLD_OBSERVER))
        self._file = self._socket.makefile("rb", buffering=1 << 20)

    def message(self) -> bytes:
        """Return the next snapshot, bytes as they came."""
        (size,) = struct.unpack("<I", self._file.read(4))
        return self._file.read(size)

    def until(self, frame: int) -> list[bytes]:
        """Return the snapshots up to that of a frame, bytes as they came."""
        found = [self.message()]
        while struct.unpack_from("<Q", found[-1], 8)[0] < frame:
            found.append(self.message())
        return found

    def rows_of(self, frame: int) -> NDArray[np.void]:
        """Return the actors of a frame, read as vehicles' rows; what came before it is passed over."""
        return np.frombuffer(self.until(frame)[-1], VEHICLE_ROW, offset=HEADERS_BYTES)

    def close(self) -> None:
        """Leave the stream."""
        self._file.close()
        self._socket.close()


def cpu_s(process: psutil.Process) -> float:
    """Return the processor's time that a process has used until now."""
    times = process.cpu_times()
    return times.user + times.system


def free_port() -> int:
    """Return a port that nobody listens on, for a Traffic Manager."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
