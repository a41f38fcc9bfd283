"""Synchronous ticks with living Traffic Managers, under more load than the machine has cores: how many hang.

    python benchmarks/hangs.py [--pairs 24] [--seconds 500] [--cars 1 3 20]

Each pair is a server and a client in processes of their own; the client ticks a world of a few cars on autopilot as
fast as it goes. A client from which no tick has come for ``HANGS_S`` hangs: it is counted, ended, and begun anew.
"""

import argparse
import collections
import os
import re
import selectors
import subprocess
import sys
import time
from typing import NamedTuple

import carla
from live import LINDEN, free_port, synchronous_world

HANGS_S = 40.0
"""A tick takes some ms; beside three times as many programs as cores some hundred."""
TOLD_EACH = 500
"""Ticks."""


def tick(port: int, cars: int) -> None:
    """Be a client: tick for ever, and write a line for every ``TOLD_EACH`` ticks."""
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(300.0)
    world = synchronous_world(client)
    manager = client.get_trafficmanager(free_port())
    manager.set_synchronous_mode(True)
    model, points = world.get_blueprint_library().find("vehicle.tesla.model3"), world.get_map().get_spawn_points()
    for point in points[:: max(1, len(points) // cars)][:cars]:
        world.spawn_actor(model, point).set_autopilot(True, manager.get_port())
    done = 0
    while True:
        world.tick()
        done += 1
        if done % TOLD_EACH == 0:
            print(done, flush=True)


class Pair(NamedTuple):
    """A server and its client."""

    cars: int
    server: subprocess.Popen[str]
    client: subprocess.Popen[str]


def begin(cars: int) -> Pair:
    server = subprocess.Popen([sys.executable, *LINDEN], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    ready = next(line for line in server.stdout if line.startswith("linden: ready"))
    port = re.search(r"rpc port (\d+)", ready)[1]
    client = subprocess.Popen(
        [sys.executable, __file__, "--tick", port, str(cars)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    return Pair(cars, server, client)


def end(pair: Pair) -> None:
    for process in (pair.client, pair.server):
        process.kill()
        process.wait()


class Watch:
    """All pairs, and what has come from them.

    Attributes:
        ticks: by the cars of a pair.
        hangs: likewise.
        ended: clients that ended themselves.
        load: the greatest of the machine.
    """

    def __init__(self) -> None:
        self._selector = selectors.DefaultSelector()
        self._heard_s: dict[Pair, float] = {}
        self.ticks: collections.Counter[int] = collections.Counter()
        self.hangs: collections.Counter[int] = collections.Counter()
        self.ended = 0
        self.load = 0.0

    def add(self, pair: Pair) -> None:
        self._selector.register(pair.client.stdout, selectors.EVENT_READ, pair)
        self._heard_s[pair] = time.monotonic()

    def look(self) -> None:
        """Wait a second for lines, count them, and begin those pairs anew that have ended or hang."""
        for key, _ in self._selector.select(1.0):
            if lines := os.read(key.fd, 4096).count(b"\n"):
                self.ticks[key.data.cars] += TOLD_EACH * lines
                self._heard_s[key.data] = time.monotonic()
            else:
                self.ended += 1
                print(f"a client with {key.data.cars} cars ended with {key.data.client.wait()}", flush=True)
                self._again(key.data)
        for pair in [pair for pair, last_s in self._heard_s.items() if time.monotonic() - last_s > HANGS_S]:
            self.hangs[pair.cars] += 1
            print(f"a client with {pair.cars} cars hangs", flush=True)
            self._again(pair)
        self.load = max(self.load, os.getloadavg()[0])

    def _again(self, pair: Pair) -> None:
        self._selector.unregister(pair.client.stdout)
        del self._heard_s[pair]
        end(pair)
        self.add(begin(pair.cars))

    def close(self) -> None:
        for pair in self._heard_s:
            end(pair)
        self._selector.close()


def main() -> None:
    if sys.argv[1:2] == ["--tick"]:
        tick(int(sys.argv[2]), int(sys.argv[3]))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=2 * (os.cpu_count() or 1))
    parser.add_argument("--seconds", type=float, default=500.0)
    parser.add_argument("--cars", type=int, nargs="+", default=[1, 3, 20], help="of the pairs, by turns")
    arguments = parser.parse_args()
    cars = [arguments.cars[number % len(arguments.cars)] for number in range(arguments.pairs)]
    watch = Watch()
    for count in cars:
        watch.add(begin(count))
    began_s = time.monotonic()
    while time.monotonic() - began_s < arguments.seconds:
        watch.look()
    watch.close()
    print("cars  pairs     ticks  hangs")
    for count in arguments.cars:
        print(f"{count:4}  {cars.count(count):5}  {watch.ticks[count]:8}  {watch.hangs[count]:5}")
    print(
        f"{watch.ticks.total()} ticks, {watch.hangs.total()} hangs, {watch.ended} clients that ended, in "
        f"{arguments.seconds:.0f} s on {os.cpu_count()} cores with a load of up to {watch.load:.0f}"
    )


if __name__ == "__main__":
    main()
