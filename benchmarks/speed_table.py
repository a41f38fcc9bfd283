"""The table that CARLA publishes of its speed, made on our server: vehicles, physics and Traffic Manager off and on.

    python benchmarks/speed_table.py [--vehicles 0 1 10 ...] [--ticks 200]
    python benchmarks/speed_table.py --split --vehicles 50 100 250     # what a tick consists of, from send to return

A client in synchronous mode ticks a world of N vehicles and no sensor. Physics off is ``set_simulate_physics(False)``,
and hybrid mode without a hero where the Traffic Manager drives, for else it turns physics on. CARLA's figures are those
of its documentation ("Benchmarking Performance": 29 January 2021, Xeon E5-1620 v3, GTX 1080 Ti); they were not measured
here, and CARLA draws pictures all the while. So they say what users are used to, not who is faster at the same work.

The limit is what the client alone needs of the processor for a tick, the Traffic Manager in it: no server, however
fast, could give more ticks, for client and server take turns.
"""

import argparse
import json
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import carla
import psutil
from live import LINDEN, Live, cpu_s, free_port, server, synchronous_world

CARLA_FPS = {
    0: (1220, 1102, 702, 729),
    1: (805, 579, 564, 422),
    10: (473, 223, 119, 98),
    50: (179, 64, 37, 26),
    100: (92, 34, 22, 15),
    150: (62, 21, 17, 10),
    200: (47, 15, 14, 7),
    250: (37, 11, 12, 6),
}
"""Vehicles -> frames/s, in the order of ``COLUMNS``."""
COLUMNS = ((False, False), (True, False), (False, True), (True, True))
"""(physics, Traffic Manager)"""
ROUNDS = 5
WARM_UP_TICKS = 100
MODEL = "vehicle.audi.a2"


class Figures(NamedTuple):
    ticks_per_s: float
    client_ms: float
    server_ms: float


def measure(live: Live, count: int, ticks: int, *, physics: bool, managed: bool) -> Figures:
    """Return the figures of one cell; the world is begun anew before."""
    client = carla.Client("127.0.0.1", live.port)
    client.set_timeout(120.0)
    client.reload_world()
    world = synchronous_world(client)
    vehicles = spawn(client, world, count)
    traffic_manager = None
    if managed:
        traffic_manager = client.get_trafficmanager(free_port())
        traffic_manager.set_synchronous_mode(True)
        traffic_manager.set_random_device_seed(1)
        traffic_manager.set_hybrid_physics_mode(not physics)
        for vehicle in vehicles:
            vehicle.set_autopilot(True, traffic_manager.get_port())
    elif not physics:
        for vehicle in vehicles:
            vehicle.set_simulate_physics(False)
    for _ in range(WARM_UP_TICKS):
        world.tick()
    figures = timed(live, world, ticks)
    if traffic_manager is not None:
        traffic_manager.shut_down()
    return figures


def spawn(client: carla.Client, world: carla.World, count: int) -> list[carla.Vehicle]:
    if not count:
        return []
    model, points = world.get_blueprint_library().find(MODEL), world.get_map().get_spawn_points()
    commands = [carla.command.SpawnActor(model, point) for point in points[:: len(points) // count][:count]]
    answers = client.apply_batch_sync(commands, True)
    refused = [answer.error for answer in answers if answer.has_error()]
    if refused:
        raise SystemExit(f"{len(refused)} of {count} vehicles were refused: {refused[0]}")
    return [world.get_actor(answer.actor_id) for answer in answers]


def timed(live: Live, world: carla.World, ticks: int) -> Figures:
    own, rates = psutil.Process(), []
    client_s, server_s = cpu_s(own), cpu_s(live.process)
    for _ in range(ROUNDS):
        began_s = time.perf_counter()
        for _ in range(ticks):
            world.tick()
        rates.append(ticks / (time.perf_counter() - began_s))
    each_ms = 1000.0 / (ROUNDS * ticks)
    return Figures(
        statistics.median(rates), (cpu_s(own) - client_s) * each_ms, (cpu_s(live.process) - server_s) * each_ms
    )


def split(count: int, ticks: int) -> str:
    """Return the row of a tick's parts in ms, with physics and Traffic Manager."""
    with tempfile.TemporaryDirectory() as folder:
        sums = Path(folder) / "sums.json"
        watched = [str(Path(__file__).with_name("split_server.py")), str(sums), "--port", "0", "--sync"]
        with server(watched) as live:
            found = measure(live, count, ticks, physics=True, managed=True)
            per_tick = json.loads(sums.read_text("utf-8"))
    each_ms = 1000.0 / per_tick["frames"]
    frame_ms, sensors_ms, cue_ms = (per_tick[name] * each_ms for name in ("frame_s", "sensors_s", "cue_s"))
    tick_ms = 1000.0 / found.ticks_per_s
    rest_ms = max(0.0, tick_ms - found.server_ms - cue_ms)
    return (
        f"{count:8}  {found.ticks_per_s:7.0f}  {tick_ms:6.2f}  {frame_ms - sensors_ms:6.2f}  {sensors_ms:7.2f}  "
        f"{max(0.0, found.server_ms - frame_ms):11.2f}  {cue_ms:5.2f}  {rest_ms:13.2f}  "
        f"{1000.0 / found.client_ms:7.0f}  {found.ticks_per_s * found.client_ms / 1000.0:8.0%}"
    )


def machine() -> str:
    """Name the processor."""
    lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "unknown processor")
    return f"{model}, {os.cpu_count()} cores, {psutil.virtual_memory().total / 2**30:.0f} GiB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, nargs="+", default=list(CARLA_FPS))
    parser.add_argument("--ticks", type=int, default=100, help=f"in each of {ROUNDS} rounds (default: %(default)s)")
    parser.add_argument("--split", action="store_true", help="print what a tick consists of, Traffic Manager on")
    arguments = parser.parse_args()
    print(f"{machine()}; other load of the last minute: {os.getloadavg()[0]:.1f}")
    if arguments.split:
        print("                    ms a tick")
        print("vehicles  ticks/s  whole   frame  sensors  other calls    cue  client, socket  limit/s  of limit")
        for count in arguments.vehicles:
            print(split(count, arguments.ticks), flush=True)
        return
    print("                                          ms of processor a tick    us of server")
    print("vehicles  physics   TM  ticks/s  CARLA  times  client  server   limit/s  a vehicle")
    for physics, managed in COLUMNS:
        column = COLUMNS.index((physics, managed))
        for count in arguments.vehicles:
            with server(LINDEN) as live:
                found = measure(live, count, arguments.ticks, physics=physics, managed=managed)
            theirs = CARLA_FPS.get(count, (0, 0, 0, 0))[column]
            print(
                f"{count:8}  {'on' if physics else 'off':>7}  {'on' if managed else 'off':>3}  "
                f"{found.ticks_per_s:7.0f}  {theirs or '-':>5}  "
                f"{found.ticks_per_s / theirs if theirs else 0:5.1f}  {found.client_ms:6.2f}  {found.server_ms:6.2f}  "
                f"{1000.0 / max(found.client_ms, 1e-3):8.0f}  {found.server_ms / max(count, 1) * 1000.0:9.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
