"""How fast SUMO's vehicles go on beside a world: real-time factors, with libsumo alone as the limit in the same run.

CPU times a tick stand beside them: on a busy machine they say more.

    python benchmarks/sumo.py --folder net/ --vehicles 100 300 --seconds 20 [--picture OUT.png] [--peer DIR]

``net/`` comes from `linden map sumo Linden -o net/`. The server is one of our own. DIR is CARLA's folder
``Co-Simulation/Sumo``: its script runs on the same server as a peer, without its sleep (``sumo_peer.py``).
"""

from __future__ import annotations

import argparse
import json
import queue
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import carla
import psutil
from live import STEP_S, synchronous_world

from basu.simulator import OwnServer, connect
from basu_sumo.bridge import Bridge
from basu_sumo.link import in_process
from basu_sumo.random_trips import RandomTrips
from basu_sumo.scenario import config_in

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_sumo.link import Link

SETTLE_TICKS = 40  # until all are spawned


def limit(folder: Path, vehicles: int, ticks: int) -> SimpleNamespace:
    """What libsumo alone takes, its vehicles' states read."""
    link = in_process(config_in(folder, is_random=True), step_s=STEP_S, seed=1)
    trips = RandomTrips(link, vehicles, 1)
    for _ in range(SETTLE_TICKS):
        step_alone(link, trips)
    began_s, cpu_s = time.perf_counter(), time.process_time()
    for _ in range(ticks):
        step_alone(link, trips)
    took_s, cpu_s = time.perf_counter() - began_s, time.process_time() - cpu_s
    link.close()
    return SimpleNamespace(took_s=took_s, cpu_s=cpu_s)


def step_alone(link: Link, trips: RandomTrips) -> None:
    trips.fill()
    link.step()
    for name in link.api.simulation.getDepartedIDList():
        link.api.vehicle.subscribe(name, (0x39, 0x43, 0x36, 0x5B))
    link.api.vehicle.getAllSubscriptionResults()


def beside(
    client: carla.Client, server: psutil.Process, folder: Path, vehicles: int, ticks: int, picture: Path | None = None
) -> SimpleNamespace:
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
    began_s, client_s, server_s = time.perf_counter(), time.process_time(), sum(server.cpu_times()[:2])
    for _ in range(ticks):
        tick()
    took_s = time.perf_counter() - began_s
    client_s, server_s = time.process_time() - client_s, sum(server.cpu_times()[:2]) - server_s
    shown = len(bridge.actor_ids)
    if picture is not None:
        look(world, bridge, picture, tick)
    bridge.close()
    return SimpleNamespace(took_s=took_s, client_s=client_s, server_s=server_s, shown=shown)


def peer(port: int, server: psutil.Process, folder: Path, scripts: Path, vehicles: int, ticks: int) -> SimpleNamespace:
    """The same by CARLA's own script, in a process of its own."""
    program = Path(__file__).with_name("sumo_peer.py")
    config = config_in(folder, is_random=True)
    numbers = (str(port), str(vehicles), str(ticks))
    server_s = sum(server.cpu_times()[:2])
    ended = subprocess.run(
        [sys.executable, str(program), str(scripts), str(config), *numbers],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    (found,) = [line for line in ended.stdout.splitlines() if line.startswith("{")]  # SUMO prints lines of its own
    server_s = (sum(server.cpu_times()[:2]) - server_s) * ticks / (ticks + SETTLE_TICKS)
    return SimpleNamespace(server_s=server_s, **json.loads(found))


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
    pictures.get(timeout=400.0).save_to_disk(str(path))
    camera.destroy()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--vehicles", type=int, nargs="+", default=[100, 300])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--peer", type=Path, metavar="DIR")
    arguments = parser.parse_args()
    ticks = round(arguments.seconds / STEP_S)
    server = OwnServer()
    try:
        client = connect("127.0.0.1", server.port, 600.0)
        synchronous_world(client)
        process = psutil.Process(server._process.pid)  # noqa: SLF001 - it has no other name for it
        heads = ("vehicles", "program", "shown", "real time", "CPU ms: client and SUMO", "server")
        print("  ".join(heads))
        for vehicles in arguments.vehicles:
            alone = limit(arguments.folder, vehicles, ticks)
            rows = {
                "libsumo": SimpleNamespace(took_s=alone.took_s, client_s=alone.cpu_s, server_s=0.0, shown=0),
                "basu": beside(client, process, arguments.folder, vehicles, ticks),
            }
            if arguments.peer is not None:
                rows["CARLA"] = peer(server.port, process, arguments.folder, arguments.peer, vehicles, ticks)
                synchronous_world(client)  # CARLA's script leaves asynchronous mode behind
            for name, found in rows.items():
                costs = [f"{1000.0 * each / ticks:.2f}" for each in (found.client_s, found.server_s)]
                row = (str(vehicles), name, str(found.shown), f"{arguments.seconds / found.took_s:.1f}x", *costs)
                print("  ".join(each.rjust(len(head)) for each, head in zip(row, heads, strict=True)), flush=True)
        if arguments.picture is not None:
            beside(client, process, arguments.folder, arguments.vehicles[-1], 1, arguments.picture)
    finally:
        server.end()


if __name__ == "__main__":
    main()
