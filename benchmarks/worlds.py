"""Vehicle-steps a second of many worlds in one process, beside the server's tick and a server for each environment.

    python benchmarks/worlds.py [--worlds 1 10 100 1000] [--vehicles 1 10] [--device cpu] [--alone]

A vehicle-step is one vehicle for one frame of 0.05 s, of 5 substeps, contacts included. Every vehicle has random pedals
and a random steer, new ones every 20 steps. Crashes are part of it, and every world is reset after 10 s. The limit is
the physics alone of 100 vehicles in one world, on one core times the cores. With ``--alone`` the server is left out,
which needs the official client. With ``--device cuda`` the same worlds run on both devices, and the last columns are
the greatest and the median distance between the two after 1 s.
"""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from linden.physics.step import advance_worlds
from linden.sensors.casting.thread_pool import processors
from linden.worlds import Worlds

CAR = "vehicle.tesla.model3"
HELD_STEPS = 20
RESET_STEPS = 200
"""An episode of 10 s: vehicles that drive at random for longer lie in ditches and stand at walls."""
SPACING = 11
"""Spawn points between two vehicles of a world."""


def made(count: int, vehicles: int, device: str = "cpu") -> Worlds:
    """Return worlds with that many vehicles each."""
    worlds = Worlds(count=count, device=device)
    for number in range(vehicles):
        worlds.spawn(CAR, number * SPACING)
    return worlds


def drive(worlds: Worlds, vehicles: int, steps: int, seed: int = 1) -> float:
    """Step under random controls and return the seconds that it took."""
    dice = np.random.default_rng(seed)
    worlds.wait()
    begin = time.perf_counter()
    for step in range(steps):
        if step and step % RESET_STEPS == 0:
            worlds.reset()
        if step % HELD_STEPS == 0:
            for slot in range(vehicles):
                wanted = np.zeros((worlds.count, 3))
                wanted[:, 0], wanted[:, 1] = dice.uniform(0.2, 0.9, worlds.count), dice.uniform(-0.4, 0.4, worlds.count)
                worlds.set_controls(wanted, slot)
        worlds.step()
    worlds.wait()
    return time.perf_counter() - begin


def rate(count: int, vehicles: int, device: str, seconds: float) -> tuple[float, float]:
    """Return vehicle-steps a second, and bytes a world."""
    worlds = made(count, vehicles, device)
    drive(worlds, vehicles, 2)
    once = drive(worlds, vehicles, HELD_STEPS) / HELD_STEPS
    steps = max(HELD_STEPS, int(seconds / once))
    return count * vehicles * steps / drive(worlds, vehicles, steps), worlds.nbytes / count


def apart(count: int, vehicles: int, seconds: float = 1.0) -> tuple[float, float]:
    """Return the greatest and the median distance in m between the devices after a time."""
    found = []
    for device in ("cpu", "cuda"):
        worlds = made(count, vehicles, device)
        drive(worlds, vehicles, round(seconds / worlds.dt_s))
        found.append(worlds.state["position"].copy())
    distance_m = np.linalg.norm(found[0] - found[1], axis=-1)
    return float(distance_m.max()), float(np.median(distance_m))


def crowd_limit(vehicles: int) -> float:
    """Return the vehicle-steps a second of the physics alone, all vehicles in one world, on all cores."""
    worlds = made(1, vehicles)
    bodies, statics = worlds.bodies(0), worlds.statics
    for slot in range(vehicles):
        worlds.set_controls([0.5, 0.1, 0.0], slot)
    steps = 200
    advance_worlds(bodies.table, bodies.worlds, worlds.map.ground, statics, 0.05, 5)
    begin = time.perf_counter()
    for _ in range(steps):
        advance_worlds(bodies.table, bodies.worlds, worlds.map.ground, statics, 0.05, 5)
    return vehicles * steps * processors() / (time.perf_counter() - begin)


def server_ticks(ticks: int) -> float:
    """Return the ticks a second that the official client gets of a server of its own, with one vehicle."""
    from ticks import LINDEN, measure  # noqa: PLC0415 - needs the official client

    return measure(LINDEN, 1, ticks).ticks_per_s


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 10, 100, 1000])
    parser.add_argument("--vehicles", type=int, nargs="+", default=[1, 10])
    parser.add_argument("--device", choices=("cpu", "cuda"), default="cpu")
    parser.add_argument("--seconds", type=float, default=3.0, help="of each row (default: %(default)s)")
    parser.add_argument("--ticks", type=int, default=300)
    parser.add_argument("--alone", action="store_true", help="leave the server out")
    options = parser.parse_args()
    if not options.alone:
        print(f"server, 1 vehicle: {server_ticks(options.ticks):.0f} vehicle-steps/s")
        with ProcessPoolExecutor(processors()) as pool:
            rates = list(pool.map(server_ticks, [options.ticks] * processors()))
        print(f"{processors()} servers with a client each: {sum(rates):.0f} vehicle-steps/s")
    print(f"limit, physics of 100 vehicles in one world, times {processors()} cores: {crowd_limit(100):.3g}")
    print("device  worlds  vehicles  vehicle-steps/s  bytes/world")
    for vehicles in options.vehicles:
        for count in options.worlds:
            found, size = rate(count, vehicles, options.device, options.seconds)
            beside = ""
            if options.device == "cuda":
                farthest, median = apart(min(count, 1000), vehicles)
                beside = f"  apart after 1 s: at most {farthest:.2g} m, median {median:.2g} m"
            print(f"{options.device:6}  {count:6}  {vehicles:8}  {found:15.3g}  {size:11.0f}{beside}", flush=True)


if __name__ == "__main__":
    main()
