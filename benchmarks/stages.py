"""Where a tick's time goes inside the server: each stage of it, timed by itself in this process.

    python benchmarks/stages.py [--vehicles 1 10 50 100 250] [--ticks 400]

The stages are those of docs/architecture.md. Times are medians over the ticks, in ms; the server's event loop and the
client's own time are not in them (see ticks.py for the whole).
"""

import argparse
import statistics
import time
from collections.abc import Callable

import msgpack

from linden.maps.library import HOME_MAP, MapLibrary
from linden.physics.step import advance
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.wire.answers import REQUEST
from linden.protocol.wire.commands import COMMANDS, ApplyVehicleControl
from linden.protocol.wire.rpc import RpcConnection
from linden.protocol.wire.stream import StreamTable
from linden.server import frames
from linden.server.rpc import registry
from linden.server.rpc.context import Context
from linden.world import World

SETTINGS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05)
SUBSTEPS = 5


def stages(maps: MapLibrary, count: int) -> dict[str, Callable[[], object]]:
    """Return the stages of a tick with that many vehicles, to be called in this order."""
    simulation = World(maps.load(HOME_MAP), SETTINGS)
    points = simulation.spawn_points
    model = ActorDescription(0, "vehicle.tesla.model3")
    ids = [simulation.spawn(model, point).id for point in points[:: len(points) // count][:count]]
    context = Context(simulation, maps, frames, StreamTable(0), lambda: 0.05)
    connection, episode = RpcConnection(), simulation.episode
    kind = COMMANDS.index(ApplyVehicleControl)
    control = VehicleControl(throttle=0.4, steer=0.1)
    request = msgpack.packb([REQUEST, 1, "apply_batch", [[False], [[[kind, [i, control]]] for i in ids], False]])

    def physics() -> None:
        episode.contacts = advance(episode.bodies, episode.map.ground, episode.statics, 0.05, SUBSTEPS)

    return {
        "batch": lambda: registry.dispatch(context, connection.receive(request)[0]),
        "lights": lambda: episode.traffic.step(0.05),
        "friction": lambda: episode.friction.update(episode),
        "physics": physics,
        "walkers": lambda: episode.walkers.step(episode, 0.05),
        "rows": episode.observe,
        "snapshot": lambda: frames.world_payload(simulation),
        "sensors": lambda: frames.sensor_payloads(simulation, simulation.measure(set())),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[1, 10, 50, 100, 250])
    parser.add_argument("--ticks", type=int, default=400)
    arguments = parser.parse_args()
    registry.load_handlers()
    maps = MapLibrary()
    for number, count in enumerate(arguments.vehicles):
        made = stages(maps, count)
        times: dict[str, list[float]] = {name: [] for name in made}
        for _ in range(arguments.ticks):
            for name, run in made.items():
                begin = time.perf_counter()
                run()
                times[name].append((time.perf_counter() - begin) * 1000.0)
        if not number:
            print("vehicles  " + "".join(f"{name:>10}" for name in made) + f"{'sum':>10}  us/vehicle")
        medians = [statistics.median(values) for values in times.values()]
        each_us = (sum(medians)) / count * 1000.0
        print(
            f"{count:8}  " + "".join(f"{value:10.3f}" for value in medians) + f"{sum(medians):10.3f}  {each_us:10.1f}"
        )


if __name__ == "__main__":
    main()
