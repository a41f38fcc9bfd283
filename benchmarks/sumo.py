"""How fast SUMO's vehicles go on beside a world: real-time factors, with libsumo alone as the limit in the same run.

    python benchmarks/sumo.py --folder net/ --vehicles 100 300 --seconds 20 [--picture OUT.png]

``net/`` comes from `linden map sumo Linden -o net/`. The server is one of our own.
"""

from __future__ import annotations

import argparse
import queue
import time
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import carla

from basu.simulator import OwnServer, connect
from basu.sumo.bridge import Bridge
from basu.sumo.link import in_process
from basu.sumo.random_trips import RandomTrips
from basu.sumo.scenario import config_in

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.sumo.link import Link

STEP_S = 0.05
SETTLE_TICKS = 40  # until all are spawned


def limit(folder: Path, vehicles: int, ticks: int) -> float:
    """Seconds that libsumo alone takes, its vehicles' states read."""
    link = in_process(config_in(folder, is_random=True), step_s=STEP_S, seed=1)
    trips = RandomTrips(link, vehicles, 1)
    for _ in range(SETTLE_TICKS):
        step_alone(link, trips)
    began_s = time.perf_counter()
    for _ in range(ticks):
        step_alone(link, trips)
    took_s = time.perf_counter() - began_s
    link.close()
    return took_s


def step_alone(link: Link, trips: RandomTrips) -> None:
    trips.fill()
    link.step()
    for name in link.api.simulation.getDepartedIDList():
        link.api.vehicle.subscribe(name, (0x39, 0x43, 0x36, 0x5B))
    link.api.vehicle.getAllSubscriptionResults()


def beside(client: carla.Client, folder: Path, vehicles: int, ticks: int, picture: Path | None) -> SimpleNamespace:
    """The same through the official client, all vehicles shown."""
    world = client.get_world()
    link = in_process(config_in(folder, is_random=True), step_s=STEP_S, seed=1)
    bridge = Bridge(link, client, world, world.get_map())
    trips = RandomTrips(link, vehicles, 1)

    def tick() -> None:
        trips.fill()
        bridge.step(world.get_snapshot())
        world.tick()

    for _ in range(SETTLE_TICKS):
        tick()
    began_s = time.perf_counter()
    for _ in range(ticks):
        tick()
    took_s = time.perf_counter() - began_s
    if picture is not None:
        look(world, bridge, picture, tick)
    shown = len(bridge.actor_ids)
    bridge.close()
    return SimpleNamespace(took_s=took_s, shown=shown, waiting=bridge.counts.waiting)


def look(world: carla.World, bridge: Bridge, path: Path, tick: Callable[[], None]) -> None:
    """A picture of where most vehicles are, from above and behind one of them."""
    places = {name: world.get_actor(actor_id).get_transform() for name, actor_id in bridge.actor_ids.items()}

    def near(name: str) -> int:
        return sum(places[name].location.distance(other.location) < 60.0 for other in places.values())

    middle = places[max(sorted(places), key=near)]
    back = middle.get_forward_vector()
    at = carla.Location(middle.location.x - 25 * back.x, middle.location.y - 25 * back.y, middle.location.z + 14)
    blueprint = world.get_blueprint_library().find("sensor.camera.rgb")
    for name, value in (("image_size_x", "1280"), ("image_size_y", "720")):
        blueprint.set_attribute(name, value)
    camera = world.spawn_actor(blueprint, carla.Transform(at, carla.Rotation(-25.0, middle.rotation.yaw, 0.0)))
    pictures: queue.Queue[carla.Image] = queue.Queue()
    camera.listen(pictures.put)
    tick()
    pictures.get(timeout=120.0).save_to_disk(str(path))
    camera.destroy()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[100, 300])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    ticks = round(arguments.seconds / STEP_S)
    server = OwnServer()
    try:
        client = connect("127.0.0.1", server.port, 120.0)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
        world.apply_settings(settings)
        print(f"{'vehicles':>8} {'shown':>6} {'libsumo alone':>14} {'beside Linden':>14} {'ms a tick':>10}")
        for vehicles in arguments.vehicles:
            alone_s = limit(arguments.folder, vehicles, ticks)
            found = beside(client, arguments.folder, vehicles, ticks, arguments.picture)
            alone, ours = (arguments.seconds / each for each in (alone_s, found.took_s))
            cost_ms = 1000.0 * found.took_s / ticks
            print(f"{vehicles:8} {found.shown:6} {alone:13.1f}x {ours:13.1f}x {cost_ms:10.2f}", flush=True)
    finally:
        server.end()


if __name__ == "__main__":
    main()
