"""Steps a second of the gymnasium environment, of several at once, and of the official client alone.

    python benchmarks/gym_steps.py [--steps 600] [--environments 1 2 4] [--worlds 1000] [--vehicles 0]
                                   [--peer-python PYTHON]

All rows drive the short route. The client alone gives a control and a tick of the same world, no observation and no
record. Processor time is that of this process and of all below it: simulators, workers and environments together.
MetaDrive drives an empty road of its own, 0.05 s a step, with its lidar, in the Python that ``--peer-python`` names.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import carla
import gymnasium
import numpy as np
from gymnasium.vector import VectorEnv

from basu.campaigns.cost import cost_of
from basu.gym import ShuttleEnv
from linden_gym import ID

ROUNDS = 5
CRUISE_MPS = 5.0
EMPTY_STEPS = 2_000_000  # the processor time has a grain of 10 ms
PEER = Path(__file__).with_name("peer_metadrive.py")


class Rate(NamedTuple):
    """Medians of ``ROUNDS``; a step of several environments at once counts once for each."""

    steps_per_s: float
    steps_per_cpu_s: float
    cpu_ms: float  # of this process a step


def following(seen: dict[str, Any]) -> np.ndarray:
    """Actions (..., 2) towards the route's point 10 m ahead, at 5 m/s; of one environment or of several."""
    x_m, y_m = seen["route"][..., 1, 0], seen["route"][..., 1, 1]
    pedals = 0.4 * (CRUISE_MPS - seen["ego"][..., 0])
    return np.stack([pedals, 1.2 * np.arctan2(y_m, x_m)], axis=-1).astype(np.float32).clip(-1.0, 1.0)


class Follower:
    """Steps an environment, or a vector of them, along its route by its observations alone."""

    def __init__(self, env: ShuttleEnv | VectorEnv[Any, Any, Any]) -> None:
        self._env = env

    def begin(self) -> None:
        self._seen, _ = self._env.reset(seed=1)

    def step(self) -> None:
        self._seen, _, terminated, truncated, _ = self._env.step(following(self._seen))
        if np.any(terminated) or np.any(truncated):
            raise SystemExit("the drive ended before the steps were made; ask for fewer")


def rate(step: Callable[[], None], begin: Callable[[], None], steps: int, environments: int = 1) -> Rate:
    """The rate of ``steps`` steps."""
    found = []
    for _ in range(ROUNDS):
        begin()
        wall_s, own_s, tree_s = time.perf_counter(), time.process_time(), cost_of().cpu_s
        for _ in range(steps):
            step()
        wall_s, own_s, tree_s = time.perf_counter() - wall_s, time.process_time() - own_s, cost_of().cpu_s - tree_s
        made = steps * environments
        found.append((made / wall_s, made / tree_s, 1000.0 * own_s / made))
    return Rate(*(statistics.median(column) for column in zip(*found, strict=True)))


def single(steps: int, vehicles: int) -> tuple[list[tuple[str, Rate]], float, float]:
    """Rows of one environment and of the client alone, and s of its first and its second reset."""
    env = ShuttleEnv(vehicles=vehicles)
    try:
        resets = []
        for _ in range(2):
            began_s = time.perf_counter()
            env.reset(seed=1)
            resets.append(time.perf_counter() - began_s)
        follower = Follower(env)
        rows = [("basu/Linden-v0", rate(follower.step, follower.begin, steps))]
        run = env.episode.vehicle.run
        control = carla.VehicleControl(throttle=0.25)

        def bare() -> None:
            run.vehicle.apply_control(control)
            run.world.tick()

        rows.append(("the client alone", rate(bare, lambda: None, steps)))
    finally:
        env.close()
    return rows, resets[0], resets[1]


def several(number: int, steps: int, vehicles: int) -> Rate:
    """The rate of a vector of environments."""
    env = gymnasium.make_vec("basu/Linden-v0", num_envs=number, vehicles=vehicles)
    try:
        follower = Follower(env)
        return rate(follower.step, follower.begin, steps, number)
    finally:
        env.close()


def on_worlds(number: int, steps: int) -> list[tuple[str, Rate]]:
    """Rows of a vector of environments on worlds in this process, of its physics alone, and of an empty loop."""
    env = gymnasium.make_vec(ID, num_envs=number)
    follower, worlds = Follower(env), env.unwrapped.worlds

    def bare() -> None:
        worlds.set_controls([0.25, 0.0, 0.0])
        worlds.step()

    return [
        (f"linden/Shuttle-v0, {number} worlds", rate(follower.step, follower.begin, steps, number)),
        ("its worlds alone", rate(bare, follower.begin, steps, number)),
        ("an empty loop", rate(lambda: None, lambda: None, EMPTY_STEPS)),
    ]


def show(name: str, found: Rate) -> None:
    """Print a row."""
    print(f"{name:<34}{found.steps_per_s:9.0f}{found.steps_per_cpu_s:22.0f}{found.cpu_ms:20.2f}", flush=True)


def peer(python: Path | None, steps: int) -> None:
    """Print MetaDrive's row, or why there is none."""
    if python is None:
        print("MetaDrive was not measured: name a Python that has it by --peer-python")
        return
    done = subprocess.run([str(python), str(PEER), str(steps), "alone"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"MetaDrive did not run: {done.stderr.strip().splitlines()[-1]}")
    name, seen, median_ms = done.stdout.strip().splitlines()[-1].split("|")
    print(f"{name + ', median step':<34}{1000.0 / float(median_ms):9.0f}   {seen}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--environments", type=int, nargs="*", default=[1, 2, 4], help="in each vector")
    parser.add_argument("--worlds", type=int, default=1000, help="in the vector without simulators")
    parser.add_argument("--vehicles", type=int, default=0)
    parser.add_argument("--peer-python", type=Path, help="a Python that has metadrive-simulator")
    given = parser.parse_args()
    print(f"{len(os.sched_getaffinity(0))} processors, load {os.getloadavg()[0]:.1f}")
    print(f"{'':<34}{'steps/s':>9}{'steps/processor-s':>22}{'ms of this process':>20}", flush=True)
    rows, first_s, again_s = single(given.steps, given.vehicles)
    for name, found in rows:
        show(name, found)
    for number in given.environments:
        show(f"a vector of {number}", several(number, given.steps, given.vehicles))
    for name, found in on_worlds(given.worlds, max(20, given.steps // 10)):
        show(name, found)
    peer(given.peer_python, given.steps)
    print(f"reset: the first {first_s:.2f} s, again {again_s:.2f} s")


if __name__ == "__main__":
    main()
