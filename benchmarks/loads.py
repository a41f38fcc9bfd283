"""Loads of maps by clients whose Traffic Managers live on: crashes of the client, and cars off the new town's lanes.

    python benchmarks/loads.py [--loads 200] [--town small|Linden] [--clients 1 2] [--cars 6] [--ticks 40]

Four variants share the loads: Traffic Managers in synchronous and in asynchronous mode, one client and two. Each client
is a process of its own with one Traffic Manager, made before its first load. The town is loaded by turns as it is and
3 km to the east, so a car that is driven by the old town's lanes cannot be on the new one's. With two clients they load
by turns, and the other one's traffic is looked at too. The small town is a ring.
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import carla
from live import LINDEN, STEP_S, free_port, server

EAST_M = 3000.0
OFF_LANE_M = 3.0
"""Half a lane and a car that cuts a corner."""
VARIANTS = (("sync", 1), ("async", 1), ("sync", 2), ("async", 2))
TOWNS = ("Here", "East")
ROOT = Path(__file__).parent.parent


def towns(folder: Path, town: str) -> None:
    """Write the town into a folder twice, as it is and to the east."""
    if town == "small":
        sys.path.insert(0, str(ROOT / "tests"))
        from fakes.ring_map import ring  # noqa: PLC0415 - needs the path

        text = ring()
    else:
        text = (ROOT / "packages" / "linden" / "src" / "linden" / "data" / f"{town}.xodr").read_text("utf-8")
    (folder / f"{TOWNS[0]}.xodr").write_text(text, "utf-8")
    moved = re.sub(r'(<geometry [^>]*?\bx=")([^"]+)', lambda found: f"{found[1]}{float(found[2]) + EAST_M!r}", text)
    (folder / f"{TOWNS[1]}.xodr").write_text(moved, "utf-8")


class Driver:
    """One client with its Traffic Manager."""

    def __init__(self, port: int, mode: str) -> None:
        self.client = carla.Client("127.0.0.1", port)
        self.client.set_timeout(60.0)
        self.synchronous = mode == "sync"
        self.manager = self.client.get_trafficmanager(free_port())

    def load(self, town: str) -> None:
        """Load a town; the settings are the default ones afterwards."""
        self.client.load_world(town)

    def drive(self, cars: int, ticks: int) -> list[float]:
        """Let cars drive, take them away, and return how far each was from the nearest lane's middle, m."""
        world = self.client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = self.synchronous, STEP_S
        world.apply_settings(settings)
        self.manager.set_synchronous_mode(self.synchronous)
        model, points = world.get_blueprint_library().find("vehicle.tesla.model3"), world.get_map().get_spawn_points()
        spawned = [world.try_spawn_actor(model, at) for at in points[:: max(1, len(points) // cars)][:cars]]
        driven = [car for car in spawned if car is not None]
        for car in driven:
            car.set_autopilot(True, self.manager.get_port())
        for _ in range(ticks):
            if self.synchronous:
                world.tick()
            else:
                world.wait_for_tick(10.0)
        streets, off_m = world.get_map(), []
        for car in driven:
            at = car.get_location()
            off_m.append(streets.get_waypoint(at).transform.location.distance(at))
        self.client.apply_batch_sync([carla.command.DestroyActor(car) for car in driven], self.synchronous)
        return off_m


def obey(port: int, mode: str) -> None:
    """Carry out one order a line of the input, and answer each by one line."""
    driver = Driver(port, mode)
    for line in sys.stdin:
        name, *arguments = json.loads(line)
        print(json.dumps(getattr(driver, name)(*arguments)), flush=True)
    os._exit(0)  # the client's own end is not what is measured


class Process:
    """A client in a process of its own."""

    def __init__(self, port: int, mode: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, __file__, "--obey", str(port), mode],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=sys.stderr if os.environ.get("VERBOSE") else subprocess.DEVNULL,
            text=True,
        )

    def order(self, *words: object) -> list[float] | None:
        """Return what it answers.

        Raises:
            EOFError: the process has crashed.
        """
        try:
            self._process.stdin.write(json.dumps(words) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            raise EOFError(f"ended with {self._process.wait()}")
        return json.loads(line)

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()


def series(port: int, mode: str, count: int, loads: int, cars: int, ticks: int) -> collections.Counter[str]:
    """Load towns by turns and let cars drive after each; return the counts."""
    counts: collections.Counter[str] = collections.Counter()
    clients: list[Process] = []
    for number in range(loads):
        try:
            if not clients:
                clients = [Process(port, mode) for _ in range(count)]
                for client in clients:
                    client.order("drive", cars, ticks)
            clients[number % count].order("load", TOWNS[(number + 1) % 2])
            counts["loads"] += 1
            for client in clients:
                off_m = client.order("drive", cars, ticks)
                counts["cars"] += len(off_m)
                counts["off"] += sum(metres > OFF_LANE_M for metres in off_m)
        except EOFError as error:  # noqa: PERF203 - the next load has new clients
            counts["crashes"] += 1
            print(f"  load {number}: a client {error}", flush=True)
            for client in clients:
                client.end()
            clients = []
    for client in clients:
        client.end()
    return counts


def main() -> None:
    if sys.argv[1:2] == ["--obey"]:
        obey(int(sys.argv[2]), sys.argv[3])
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--loads", type=int, default=200, help="in all four variants (default: %(default)s)")
    parser.add_argument("--clients", type=int, nargs="+", default=[1, 2], help="variants with that many clients only")
    parser.add_argument("--town", default="small", choices=("small", "Linden"))
    parser.add_argument("--cars", type=int, default=6, help="of each client (default: %(default)s)")
    parser.add_argument("--ticks", type=int, default=40)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        towns(Path(folder), arguments.town)
        print("Traffic Manager  clients  loads  crashes  cars  off the lanes     s", flush=True)
        for mode, count in VARIANTS:
            if count not in arguments.clients:
                continue
            start = [*(word for word in LINDEN if word != "--sync"), "--map", TOWNS[0], "--maps", folder]
            with server(start) as live:
                began_s = time.perf_counter()
                found = series(live.port, mode, count, arguments.loads // 4, arguments.cars, arguments.ticks)
            print(
                f"{mode:>15}  {count:7}  {found['loads']:5}  {found['crashes']:7}  {found['cars']:4}  "
                f"{found['off']:13}  {time.perf_counter() - began_s:4.0f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
