"""What recording costs a frame, and replaying: a tick of the server without and with it, in ms of this process's CPU.

    python benchmarks/recorder.py [--vehicles 1 10 50 100 250] [--frames 200]

Vehicles are spread over the map and roll freely, so that the tick itself is the same in all columns. Medians. "off" is
before anything was ever recorded; "more" is with additional data; "replay" is the same recording played again.
"""

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Transform
from linden.replay.file.read import Recording
from linden.replay.file.track import track_of
from linden.replay.replayer import ReplayPlan
from linden.world import World

SETTINGS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
STEP_S = 0.05


def cpu_ms(work: Callable[[], object], frames: int) -> float:
    """Return the median CPU time of a call, ms."""
    times_s = []
    for _ in range(frames):
        began_s = time.process_time()
        work()
        times_s.append(time.process_time() - began_s)
    return 1e3 * statistics.median(times_s)


def row(maps: MapLibrary, count: int, frames: int, folder: Path) -> tuple[float, ...]:
    """Return tick off, plain, more, replay in ms, and bytes of a frame plain and more."""
    simulation = World(maps.load(HOME_MAP), SETTINGS)
    points = simulation.spawn_points
    for point in points[:: len(points) // count][:count]:
        simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), point)

    def tick() -> None:
        simulation.step(STEP_S)

    cpu_ms(tick, frames)  # they come to rest
    found, sizes = [cpu_ms(tick, frames)], []
    for additional_data in (False, True):
        path = folder / f"{additional_data}.log"
        simulation.recorder.start(path, simulation.episode, "Linden", time.time, additional_data=additional_data)
        tick()
        begin = path.stat().st_size
        found.append(cpu_ms(tick, frames))
        simulation.recorder.stop()
        sizes.append((path.stat().st_size - begin) / frames)
    simulation.replayer.start(
        simulation, track_of(Recording(path)), ReplayPlan(0.0, 0.0, 0, Transform(), replay_sensors=False)
    )
    found.append(cpu_ms(tick, frames))
    return (*found, *sizes)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[1, 10, 50, 100, 250])
    parser.add_argument("--frames", type=int, default=200)
    arguments = parser.parse_args()
    maps = MapLibrary([], MapCache.of_user().read)
    print(f"{'vehicles':>8} {'off':>8} {'plain':>8} {'more':>8} {'replay':>8} {'bytes':>8} {'more':>8}")
    with tempfile.TemporaryDirectory() as folder:
        for count in arguments.vehicles:
            *times_ms, plain, more = row(maps, count, arguments.frames, Path(folder))
            print(f"{count:8} " + " ".join(f"{ms:8.3f}" for ms in times_ms) + f" {plain:8.0f} {more:8.0f}", flush=True)


if __name__ == "__main__":
    main()
