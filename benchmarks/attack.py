"""Hostile packets against one live server: stops, what a well-behaved client waits for, memory, and bytes of log.

    python benchmarks/attack.py [--packets 100000] [--seed 1]

One packet in ``CRAFTED_EACH`` is a crafted map (``tests/fakes/crafted_maps.py``) or crafted settings. Its
connection stays open until the answer has come, because the server gives up work for a client that has gone.
Packets are noise, requests cut off or changed, right types with values that make no sense, and large ones: texts and
arrays that are announced and do not come, deep nesting, 250,000 empty arrays, pictures of a million pixels.
Meanwhile a client that behaves ticks a synchronous world with a car. Its wait is that for the server's main thread:
its work, and its wait for Python's lock. What other processes take is left out (``tests/lock_waits.py``), for the
clock of a busy machine says nothing.
"""

import argparse
import contextlib
import queue
import random
import struct
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import msgpack
import psutil

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from fakes.crafted_maps import KINDS, opendrive
from fakes.nonsense import connections
from fakes.raw_client import RawClient
from lock_waits import LockWatch, held_up_s
from servers import RunningServer, running_server

OPENING = b"\x94\x00\x01\xa7version\x92\x91\xc2"  # a request, up to where its argument begins
PIXELS = b"\x94\x00\x01\xbeapply_color_texture_to_objects\x94\x91\xc2\x91\xa1a\x00\x93\xcd\x04\x00\xcd\x04\x00\xdd"
LARGE_EACH = 250
"""Packets, of which one is large."""
CRAFTED_EACH = 2000
"""Packets, of which one is a crafted map or crafted settings."""
ENDLESS = [True, False, [True, 0.05], True, 1e-6, 10**6, 0.0, True, 3000.0, 2000.0, True]
MAP_PARAMETERS = [2.0, 50.0, 1.0, 0.6, True, True, True]
SETTINGS = [True, False, [True, 0.05], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
FIRST_MAP, ALL_LAYERS = "Carla/Maps/Linden", 0xFFFF
WARM_UP_TICKS = 100
"""Before the memory is read the first time."""
SETTLED_S = 3.0
"""For work in the background of maps that are gone to end."""
ANSWER_S = 120.0
"""How long a crafted packet waits for its answer."""
GONE = (EOFError, OSError, ValueError, RuntimeError, AssertionError)


def large(chance: random.Random) -> bytes:
    many = 250_000
    return chance.choice(
        [
            lambda: OPENING + b"\xdb\xff\xff\xff\xff" + bytes(100_000),
            lambda: OPENING + b"\xdd\xff\xff\xff\xff",
            lambda: OPENING + b"\x91" * 100_000,
            lambda: OPENING + b"\xdd" + struct.pack(">I", many) + b"\x90" * (many - 1),
            lambda: OPENING + b"\xdd" + struct.pack(">I", many) + b"\x90" * many,
            lambda: PIXELS + struct.pack(">I", 2**20) + b"\x94\x01\x02\x03\x04" * 2**20,
            lambda: b"\x94\x00\x01\xdb" + struct.pack(">I", 2_000_000) + b"\xff" * 2_000_000 + b"\x91\xc3",
        ]
    )()


def crafted(chance: random.Random) -> bytes:
    """Return a call that asks for far more work than its bytes are."""
    if chance.random() < 0.2:
        return msgpack.packb([0, 1, "set_episode_settings", [[False], ENDLESS]])
    text = opendrive(chance.choice(list(KINDS)), chance.choice([1000, 4000, 20_000, 100_000]))
    return msgpack.packb([0, 1, "copy_opendrive_to_file", [[False], text, MAP_PARAMETERS]])


class Crafted(list[bytes]):
    """A crafted packet, whose connection stays open until its answer."""


def packets(seed: int, count: int) -> Iterator[list[bytes]]:
    """Yield the packets of one connection after another, ``count`` in all."""
    chance, sent, since_large, since_crafted = random.Random(seed), 0, 0, 0
    for group in connections(seed, count):
        yield group
        sent, since_large = sent + len(group), since_large + len(group)
        since_crafted += len(group)
        if since_large >= LARGE_EACH:
            since_large = 0
            yield [large(chance)]
        if since_crafted >= CRAFTED_EACH:
            since_crafted = 0
            yield Crafted([crafted(chance)])


class Behaved(threading.Thread):
    """A client that ticks as long as it is let."""

    def __init__(self, server: RunningServer) -> None:
        super().__init__(daemon=True)
        self._server, self.ends, self.has_begun = server, threading.Event(), threading.Event()
        self.waits_s: list[float] = []
        self.refused = 0

    def run(self) -> None:
        clocks = LockWatch(self._server.process.pid)
        with RawClient(self._server.port, 300.0) as client:
            client.call("set_episode_settings", SETTINGS)
            client.call("spawn_actor", [0, "vehicle.tesla.model3", []], client.call("get_map_info")[1][0])
            while not self.ends.is_set():
                if len(self.waits_s) == WARM_UP_TICKS:
                    self.has_begun.set()
                before = clocks.read()
                try:
                    client.call("tick_cue")
                except RuntimeError:
                    self.refused += 1
                self.waits_s.append(held_up_s(before, clocks.read()))


def attack(port: int, group: list[bytes]) -> None:
    """Send the packets of one connection, read what has come, and vanish."""
    with contextlib.suppress(*GONE):
        client = RawClient(port, 10.0)
        with contextlib.suppress(*GONE):
            client.socket.sendall(b"".join(group))
            client.socket.settimeout(0.001)
            client.socket.recv(65536)
        client.reset()


class Held(threading.Thread):
    """A client that sends crafted packets one after the other, and waits for the answer to each."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self._port, self._waiting = port, queue.SimpleQueue[bytes | None]()
        self.answers, self.lost, self.longest_s = 0, 0, 0.0

    def send(self, packet: bytes | None) -> None:
        """Send a packet when the one before is answered; None ends the thread."""
        self._waiting.put(packet)

    def run(self) -> None:
        while (packet := self._waiting.get()) is not None:
            began_s = time.monotonic()
            try:
                client = RawClient(self._port, ANSWER_S)
                client.socket.sendall(packet)
                answered = bool(client.socket.recv(65536))
                client.reset()
            except GONE:
                answered = False
            self.answers, self.lost = self.answers + answered, self.lost + (not answered)
            self.longest_s = max(self.longest_s, time.monotonic() - began_s)


def resident_mib(process: psutil.Process) -> float:
    """Return the memory that a process holds."""
    return float(process.memory_info().rss / 2**20)


def restore(port: int) -> None:
    """Load the map of the start again and tick as the client that behaves did, for the memory to be compared."""
    with RawClient(port, 300.0) as client:
        client.call("load_new_episode", FIRST_MAP, True, ALL_LAYERS)
        time.sleep(SETTLED_S)
        client.call("set_episode_settings", SETTINGS)
        client.call("spawn_actor", [0, "vehicle.tesla.model3", []], client.call("get_map_info")[1][0])
        for _ in range(WARM_UP_TICKS):
            client.call("tick_cue")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--packets", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as home, running_server("--recordings", home) as server:
        process = psutil.Process(server.process.pid)
        behaved = Behaved(server)
        behaved.start()
        held = Held(server.port)
        held.start()
        behaved.has_begun.wait()
        before_mib, most_mib, sent, began_s = resident_mib(process), 0.0, 0, time.monotonic()
        for group in packets(arguments.seed, arguments.packets):
            if isinstance(group, Crafted):
                held.send(group[0])
            else:
                attack(server.port, group)
            sent += len(group)
            if server.process.poll() is not None:
                break
            if sent % 100 < len(group):
                most_mib = max(most_mib, resident_mib(process))
        held.send(None)
        held.join(ANSWER_S)
        behaved.ends.set()
        behaved.join(300)
        stopped = server.process.poll() is not None or behaved.is_alive()
        waits_ms = sorted(1000.0 * wait_s for wait_s in behaved.waits_s)
        log = server.log()
        print(f"packets        {sent} in {time.monotonic() - began_s:.0f} s")
        print(f"stops          {int(stopped)}; bugs in the log: {log.count('internal error')}")
        print(
            f"crafted        {held.answers} answered, {held.lost} without an answer, the longest after "
            f"{held.longest_s:.1f} s"
        )
        print(f"ticks          {len(waits_ms)} by the client that behaves, {behaved.refused} refused")
        print(
            f"its wait       median {waits_ms[len(waits_ms) // 2]:.1f} ms, 99.9 % below "
            f"{waits_ms[int(len(waits_ms) * 0.999)]:.0f} ms, worst {waits_ms[-1]:.0f} ms, other processes left out"
        )
        last_mib = resident_mib(process)
        restore(server.port)
        print(
            f"memory         {before_mib:.0f} MiB before, {most_mib:.0f} at most, {last_mib:.0f} on the last hostile "
            f"map, {resident_mib(process):.0f} on the first map again"
        )
        print(f"log            {len(log)} bytes in {log.count(chr(10))} lines")


if __name__ == "__main__":
    main()
