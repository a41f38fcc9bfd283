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

    number: int
    cars: int
    server: subprocess.Popen[str]
    client: subprocess.Popen[str]


def begin(number: int, cars: int) -> Pair:
    server = subprocess.Popen([sys.executable, *LINDEN], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    ready = next(line for line in server.stdout if line.startswith("linden: ready"))
    port = re.search(r"rpc port (\d+)", ready)[1]
    client = subprocess.Popen(
        [sys.executable, __file__, "--tick", port, str(cars)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    return Pair(number, cars, server, client)


def end(pair: Pair) -> None:
    for process in (pair.client, pair.server):
        process.kill()
        process.wait()


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
    ticks: collections.Counter[int] = collections.Counter()
    hangs: collections.Counter[int] = collections.Counter()
    ended = 0
    with selectors.DefaultSelector() as selector:
        heard_s: dict[Pair, float] = {}

        def watch(pair: Pair) -> None:
            selector.register(pair.client.stdout, selectors.EVENT_READ, pair)
            heard_s[pair] = time.monotonic()

        def again(pair: Pair) -> None:
            selector.unregister(pair.client.stdout)
            del heard_s[pair]
            end(pair)
            watch(begin(pair.number, pair.cars))

        for number, count in enumerate(cars):
            watch(begin(number, count))
        began_s, load = time.monotonic(), os.getloadavg()[0]
        while time.monotonic() - began_s < arguments.seconds:
            for key, _ in selector.select(1.0):
                if lines := os.read(key.fd, 4096).count(b"\n"):
                    ticks[key.data.cars] += TOLD_EACH * lines
                    heard_s[key.data] = time.monotonic()
                else:  # the client has ended itself
                    ended += 1
                    print(f"a client with {key.data.cars} cars ended with {key.data.client.wait()}", flush=True)
                    again(key.data)
            load = max(load, os.getloadavg()[0])
            for pair in [pair for pair, last_s in heard_s.items() if time.monotonic() - last_s > HANGS_S]:
                hangs[pair.cars] += 1
                print(f"a client with {pair.cars} cars hangs", flush=True)
                again(pair)
        for pair in heard_s:
            end(pair)
    print("cars  pairs     ticks  hangs")
    for count in arguments.cars:
        print(f"{count:4}  {cars.count(count):5}  {ticks[count]:8}  {hangs[count]:5}")
    print(
        f"{ticks.total()} ticks, {hangs.total()} hangs, {ended} clients that ended, in {arguments.seconds:.0f} s on "
        f"{os.cpu_count()} cores with a load of up to {load:.0f}"
    )


if __name__ == "__main__":
    main()
