"""How many ticks a second the official client gets, what the server spends on them, and how far that is from the limit.

    python benchmarks/ticks.py [--vehicles 1 10 50 100 250] [--ticks 300]

Synchronous mode, 0.05 s a tick, physics on, a throttle and a steer for every vehicle by one batch each tick. The limit
is the same client against canned_server.py, which simulates nothing, measured in the same run. What CARLA publishes
(GTX 1080 Ti machine, physics and Traffic Manager on) stands in the last column; it was not measured here.
"""

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import carla
import psutil

CARLA_PUBLISHED_FPS = {1: 422, 10: 98, 50: 26, 100: 15, 200: 7, 250: 6}
ROUNDS = 5
WARM_UP_TICKS = 50
LIMIT = [str(Path(__file__).with_name("canned_server.py"))]
LINDEN = ["-m", "linden.cli", "serve", "--port", "0"]


class Figures(NamedTuple):
    ticks_per_s: float
    server_ms: float
    memory_mib: float
    start_s: float


@contextmanager
def server(arguments: list[str]) -> Iterator[tuple[psutil.Process, int, float]]:
    """Yield process, RPC port and start-up time of a server."""
    begin = time.perf_counter()
    process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE, text=True)
    try:
        ready = next((line for line in process.stdout if line.startswith("linden: ready")), None)
        if ready is None:
            raise SystemExit("the server ended before it was ready")
        start_s = time.perf_counter() - begin
        yield psutil.Process(process.pid), int(ready.split("rpc port ")[1].split(",")[0]), start_s
    finally:
        process.terminate()
        process.wait()


def measure(arguments: list[str], count: int, ticks: int) -> Figures:
    with server(arguments) as (process, port, start_s):
        client = carla.Client("127.0.0.1", port)
        client.set_timeout(60.0)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
        world.apply_settings(settings)
        ids = spawn(client, world, count)
        for _ in range(WARM_UP_TICKS):
            world.tick()
        before = process.cpu_times()
        rate = statistics.median(drive(client, world, ids, ticks, turn) for turn in range(ROUNDS))
        after = process.cpu_times()
        cpu_s = after.user + after.system - before.user - before.system
        return Figures(rate, cpu_s / (ROUNDS * ticks) * 1000.0, process.memory_info().rss / 2**20, start_s)


def spawn(client: carla.Client, world: carla.World, count: int) -> list[int]:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    points = world.get_map().get_spawn_points()
    commands = [carla.command.SpawnActor(blueprint, point) for point in points[:: len(points) // count][:count]]
    answers = client.apply_batch_sync(commands, True)
    refused = [answer.error for answer in answers if answer.has_error()]
    if refused:
        raise SystemExit(f"{len(refused)} of {count} vehicles were refused: {refused[0]}")
    return [answer.actor_id for answer in answers]


def drive(client: carla.Client, world: carla.World, ids: list[int], ticks: int, turn: int) -> float:
    """Return the ticks a second of one round."""
    begin = time.perf_counter()
    for tick in range(ticks):
        control = carla.VehicleControl(throttle=0.4, steer=0.1 if (tick // 20 + turn) % 2 else -0.1)
        client.apply_batch([carla.command.ApplyVehicleControl(actor_id, control) for actor_id in ids])
        world.tick()
    return ticks / (time.perf_counter() - begin)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[1, 10, 50, 100, 250])
    parser.add_argument("--ticks", type=int, default=300, help=f"in each of {ROUNDS} rounds (default: %(default)s)")
    arguments = parser.parse_args()
    print("vehicles  ticks/s  server ms/tick  limit/s  of limit  MiB  start s  CARLA's FPS")
    for count in arguments.vehicles:
        limit = measure(LIMIT, count, arguments.ticks)
        ours = measure(LINDEN, count, arguments.ticks)
        print(
            f"{count:8}  {ours.ticks_per_s:7.0f}  {ours.server_ms:14.3f}  {limit.ticks_per_s:7.0f}  "
            f"{ours.ticks_per_s / limit.ticks_per_s:8.0%}  {ours.memory_mib:3.0f}  {ours.start_s:7.2f}  "
            f"{CARLA_PUBLISHED_FPS.get(count, '-'):>11}",
            flush=True,
        )


if __name__ == "__main__":
    main()
