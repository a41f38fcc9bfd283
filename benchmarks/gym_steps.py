"""How many steps a second the gymnasium environment makes with one vehicle, the client's limit, and MetaDrive's steps.

    python benchmarks/gym_steps.py [--steps 1000] [--vehicles 0] [--peer-python PYTHON]

The limit is the official client alone: a control and a tick of the same world, no observation and no record. MetaDrive
drives an empty road of its own, 0.05 s a step, with its lidar, in the Python that ``--peer-python`` names.
"""

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import carla
import numpy as np

from basu.gym import ShuttleEnv

ROUNDS = 5
PEER = Path(__file__).with_name("peer_metadrive.py")


class Follower:
    """Steps an environment along its route at 5 m/s, by its observations alone."""

    def __init__(self, env: ShuttleEnv) -> None:
        self._env = env
        self.begin()

    def begin(self) -> None:
        self._seen, _ = self._env.reset(seed=1)

    def step(self) -> None:
        x_m, y_m = self._seen["route"][1]
        action = np.array([0.4 * (5.0 - self._seen["ego"][0]), 1.2 * np.arctan2(y_m, x_m)], np.float32)
        self._seen, _, terminated, truncated, _ = self._env.step(action.clip(-1.0, 1.0))
        if terminated or truncated:
            raise SystemExit("the drive ended before the steps were made; ask for fewer")


def rate(step: Callable[[], None], begin: Callable[[], None], steps: int) -> tuple[float, float]:
    """Median of steps a second over ``ROUNDS``, and ms of this process a step."""
    wall, cpu = [], []
    for _ in range(ROUNDS):
        begin()
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        for _ in range(steps):
            step()
        wall.append(steps / (time.perf_counter() - wall_s))
        cpu.append(1000.0 * (time.process_time() - cpu_s) / steps)
    return statistics.median(wall), statistics.median(cpu)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--vehicles", type=int, default=0)
    parser.add_argument("--peer-python", type=Path, help="a Python that has metadrive-simulator")
    given = parser.parse_args()
    env = ShuttleEnv(vehicles=given.vehicles)
    rows = []
    try:
        began_s = time.perf_counter()
        env.reset(seed=1)
        first_s, began_s = time.perf_counter() - began_s, time.perf_counter()
        env.reset(seed=1)
        again_s = time.perf_counter() - began_s
        follower = Follower(env)
        rows.append(("basu/Linden-v0", *rate(follower.step, follower.begin, given.steps)))
        run = env.episode.run
        control = carla.VehicleControl(throttle=0.25)

        def bare() -> None:
            run.vehicle.apply_control(control)
            run.world.tick()

        rows.append(("the client alone", *rate(bare, lambda: None, given.steps)))
    finally:
        env.close()
    print(f"{'':<34}{'steps/s':>9}{'ms of its process':>20}")
    for name, per_s, cpu_ms in rows:
        print(f"{name:<34}{per_s:9.0f}{cpu_ms:20.2f}")
    if given.peer_python is None:
        print("MetaDrive was not measured: name a Python that has it by --peer-python")
    else:
        command = [str(given.peer_python), str(PEER), str(given.steps), "alone"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"MetaDrive did not run: {done.stderr.strip().splitlines()[-1]}")
        name, seen, median_ms = done.stdout.strip().splitlines()[-1].split("|")
        print(f"{name + ', median step':<34}{1000.0 / float(median_ms):9.0f}   {seen}")
    print(f"reset: the first {first_s:.2f} s, again {again_s:.2f} s")


if __name__ == "__main__":
    main()
