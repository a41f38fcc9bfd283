"""How long a server takes until it is ready, what it holds when idle, and how far that is from the limit.

    python benchmarks/start_up.py [--runs 5]
    python benchmarks/start_up.py --first

``--first`` times one first start from a checkout: nothing is compiled and nothing is kept of the map. It prints the
seconds from the command to each event: ready, first tick, first tick with a vehicle, first measurement of a lidar and
of a camera.

Without it every figure is a median over the runs. The limits are processes that simulate nothing: one that only imports
numpy and numba, and one in which numba is ready for its first kernel as well. The kernels' own cache is filled
beforehand; cold and warm speak of what is kept of the map. A reload is timed where the client waits for it, ten times a
run.
"""

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import carla
import psutil

import linden

PACKAGE = Path(linden.__file__).parent
IMPORTS = "import numpy, numba\n"
KERNELS = """from numba.core.registry import cpu_target
cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()
"""
SAYS_READY = "print('ready', flush=True)\ninput()"
SERVE = ["-m", "linden.cli", "serve", "--sync", "--port", "0"]


class Figures(NamedTuple):
    wall_s: float
    cpu_s: float
    memory_mib: float


@contextmanager
def started(arguments: list[str], cache: Path, **environment: str) -> Iterator[tuple[psutil.Process, str, Figures]]:
    """Yield a Python process that has said that it is ready, its line, and what it took until then."""
    begin = time.perf_counter()
    with subprocess.Popen(
        [sys.executable, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_CACHE_HOME": str(cache), **environment},
    ) as child:
        try:
            line = next((line for line in child.stdout if "ready" in line), None)
            wall_s = time.perf_counter() - begin
            if line is None:
                raise SystemExit("the process ended before it was ready")
            process = psutil.Process(child.pid)
            times = process.cpu_times()
            yield process, line, Figures(wall_s, times.user + times.system, process.memory_info().rss / 2**20)
        finally:  # whatever went wrong out there: Popen would wait for a server that nobody has told to end
            child.terminate()


def start(arguments: list[str], cache: Path) -> Figures:
    with started(arguments, cache) as (_, _, figures):
        return figures


def reloads(cache: Path, runs: int) -> list[Figures]:
    """Load the same map again and again."""
    with started(SERVE, cache) as (process, line, _):
        client = carla.Client("127.0.0.1", int(line.split("rpc port ")[1].split(",")[0]))
        client.set_timeout(20.0)
        client.get_world()
        walls_s, before = [], sum(process.cpu_times()[:2])
        for _ in range(runs):
            begin = time.perf_counter()
            client.reload_world(reset_settings=False)
            walls_s.append(time.perf_counter() - begin)
        cpu_s = (sum(process.cpu_times()[:2]) - before) / runs  # of all, for the system counts in steps of 0.01 s
        return [Figures(wall_s, cpu_s, process.memory_info().rss / 2**20) for wall_s in walls_s]


def cold_start() -> Figures:
    with tempfile.TemporaryDirectory() as folder:
        return start(SERVE, Path(folder))


def first_start() -> None:
    """Print when a first start reaches what its clients wait for."""
    with tempfile.TemporaryDirectory() as folder:
        sources = Path(folder) / "src"  # a copy, for kernels beside the sources are found as well
        shutil.copytree(PACKAGE, sources / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
        begin = time.perf_counter()

        def reached(event: str) -> None:
            print(f"{event:32}{time.perf_counter() - begin:8.1f} s", flush=True)

        with started(SERVE, Path(folder), PYTHONPATH=str(sources)) as (_, line, _):
            reached("ready")
            follow(line, reached)


def follow(line: str, reached: Callable[[str], None]) -> None:
    """Drive the server that printed ``line`` to the events after its start."""
    client = carla.Client("127.0.0.1", int(line.split("rpc port ")[1].split(",", maxsplit=1)[0]))
    client.set_timeout(600.0)
    world = client.get_world()
    world.tick()
    reached("first tick")
    blueprints, place = world.get_blueprint_library(), world.get_map().get_spawn_points()[0]
    car = world.spawn_actor(blueprints.find("vehicle.tesla.model3"), place)
    world.tick()
    reached("first tick with a vehicle")
    for kind in ("sensor.lidar.ray_cast", "sensor.camera.rgb"):
        measured = threading.Event()
        sensor = world.spawn_actor(blueprints.find(kind), carla.Transform(carla.Location(z=2.5)), attach_to=car)
        sensor.listen(lambda _, measured=measured: measured.set())
        while not measured.is_set():
            world.tick(600.0)
        sensor.stop()
        reached(kind)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--first", action="store_true", help="time one first start instead")
    arguments = parser.parse_args()
    if arguments.first:
        first_start()
        return
    runs = range(arguments.runs)
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        start(SERVE, cache)  # fills the map's cache, and the kernels' where it is empty
        rows = {
            "limit: numpy, numba": [start(["-c", IMPORTS + SAYS_READY], cache) for _ in runs],
            "limit: ready for kernels": [start(["-c", IMPORTS + KERNELS + SAYS_READY], cache) for _ in runs],
            "start, map cold": [cold_start() for _ in runs],
            "start, map warm": [start(SERVE, cache) for _ in runs],
            "reload_world": reloads(cache, 10 * len(runs)),
        }
    print(f"{'':26}wall s   CPU s  resident MiB")
    for name, figures in rows.items():
        wall_s, cpu_s, memory_mib = map(statistics.median, zip(*figures, strict=True))
        print(f"{name:26}{wall_s:6.3f}  {cpu_s:6.3f}  {memory_mib:12.0f}")


if __name__ == "__main__":
    main()
