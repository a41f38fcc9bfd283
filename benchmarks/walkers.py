"""A crowd led by the official client's own controllers: where it walks, where it should not, whether it does so again.

    python benchmarks/walkers.py [--walkers 200] [--minutes 10] [--cross-factor 0] [--runs 2] [--picture mesh.png]

Synchronous mode, 0.05 s a tick. Walkers are spawned at random places of the mesh and sent to random places, anew every
minute. Every half second each is looked up: on which area of the mesh its middle is, on which lane of the client's own
map, whether in a box of the scenery (``get_level_bbs``). Each run is a client and a server of their own, and ends with
a digest of where every walker was after every tick; runs with one seed should end alike.
"""

import argparse
import hashlib
import json
import math
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import carla
import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from naive.walking_mesh import CROSSWALK, ROAD, SIDEWALK, Locator, ReadMesh, read

DT_S = 0.05
LOOK_EVERY_TICKS = 10
ANEW_EVERY_TICKS = 1200
SEED = 7
STANDING = [carla.CityObjectLabel.Buildings, carla.CityObjectLabel.Poles, carla.CityObjectLabel.Walls,
            carla.CityObjectLabel.Fences, carla.CityObjectLabel.Vegetation]  # fmt: skip


class Boxes:
    """The upright boxes of the scenery, by cells of the plane."""

    def __init__(self, world: carla.World) -> None:
        self._cells: dict[tuple[int, int], list[tuple[float, ...]]] = {}
        self.count = 0
        for label in STANDING:
            for box in world.get_level_bbs(label):
                (x, y, z), half = (box.location.x, box.location.y, box.location.z), box.extent
                yaw = math.radians(box.rotation.yaw)
                entry = (x, y, z, half.x, half.y, half.z, math.cos(yaw), math.sin(yaw))
                reach = math.hypot(half.x, half.y)
                self.count += 1
                for column in range(int((x - reach) // 8), int((x + reach) // 8) + 1):
                    for row in range(int((y - reach) // 8), int((y + reach) // 8) + 1):
                        self._cells.setdefault((column, row), []).append(entry)

    def hold(self, x: float, y: float, z: float) -> bool:
        """Whether the middle of a body, its knees and its head's height included, is in a box."""
        for bx, by, bz, hx, hy, hz, cosine, sine in self._cells.get((int(x // 8), int(y // 8)), ()):
            along, across = cosine * (x - bx) + sine * (y - by), cosine * (y - by) - sine * (x - bx)
            if abs(along) < hx and abs(across) < hy and bz - hz < z + 0.8 and bz + hz > z - 0.6:
                return True
        return False


def spawn(client: carla.Client, world: carla.World, count: int) -> tuple[list[int], list[carla.Actor]]:
    blueprints = sorted(world.get_blueprint_library().filter("walker.pedestrian.*"), key=lambda b: b.id)
    ids: list[int] = []
    while len(ids) < count:  # where somebody stands already nobody else can
        wanted = [world.get_random_location_from_navigation() + carla.Location(z=1.0) for _ in range(count - len(ids))]
        answers = client.apply_batch_sync(
            [
                carla.command.SpawnActor(blueprints[n % len(blueprints)], carla.Transform(place))
                for n, place in enumerate(wanted)
            ],
            True,
        )
        ids += [answer.actor_id for answer in answers if not answer.has_error()]
    controller = world.get_blueprint_library().find("controller.ai.walker")
    answers = client.apply_batch_sync(
        [carla.command.SpawnActor(controller, carla.Transform(), walker) for walker in ids], True
    )
    world.tick()
    return ids, [world.get_actor(answer.actor_id) for answer in answers]


def run(port: int, arguments: argparse.Namespace) -> dict[str, object]:
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(60.0)
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, DT_S
    world.apply_settings(settings)
    world.set_pedestrians_seed(SEED)
    world.set_pedestrians_cross_factor(arguments.cross_factor)
    street, boxes = world.get_map(), Boxes(world)
    mesh = read_mesh(client)
    ids, controllers = spawn(client, world, arguments.walkers)
    for controller in controllers:
        controller.start()
    digest, seen = hashlib.sha256(), Counter()
    walked_m, before, was_on = np.zeros(len(ids)), None, [SIDEWALK] * len(ids)
    ticks, begin_s, looking_s = int(arguments.minutes * 60.0 / DT_S), time.perf_counter(), 0.0
    for tick in range(ticks):
        if tick % ANEW_EVERY_TICKS == 0:
            for controller in controllers:
                controller.go_to_location(world.get_random_location_from_navigation())
                controller.set_max_speed(1.4)
        world.tick()
        look_s = time.perf_counter()
        snapshot = world.get_snapshot()
        places = [snapshot.find(i).get_transform() for i in ids]
        at_m = np.array([(p.location.x, p.location.y, p.location.z, p.rotation.yaw) for p in places])
        digest.update(at_m.tobytes())
        if before is not None:
            walked_m += np.hypot(*(at_m[:, :2] - before[:, :2]).T)
        before = at_m
        if tick % LOOK_EVERY_TICKS == 0:
            look(street, boxes, mesh, places, was_on, seen)
        looking_s += time.perf_counter() - look_s
    spent_s = time.perf_counter() - begin_s
    for controller in controllers:
        controller.stop()
    world.tick()
    return {
        "walked at least 20 m": int((walked_m > 20.0).sum()),
        "mean distance m": round(float(walked_m.mean()), 1),
        "least distance m": round(float(walked_m.min()), 1),
        "looks": seen["looks"],
        "off the mesh": seen["off"],
        "in a scenery box": seen["boxed"],
        "on a driving lane outside a crosswalk": seen["road"],
        "crosswalks entered": seen["crossings"],
        "boxes looked at": boxes.count,
        "ticks/s": round(ticks / (spent_s - looking_s), 1),
        "digest": digest.hexdigest()[:16],
    }


def look(
    street: carla.Map, boxes: Boxes, mesh: Locator, places: list[carla.Transform], was_on: list[int], seen: Counter[str]
) -> None:
    for n, place in enumerate(places):
        x, y, z = place.location.x, place.location.y, place.location.z
        areas = {area for area, height in mesh.at(x, y) if abs(height - z) < 4.0}
        seen["looks"] += 1
        seen["off"] += not areas
        seen["boxed"] += boxes.hold(x, y, z)
        if CROSSWALK in areas and was_on[n] != CROSSWALK:
            seen["crossings"] += 1
        if CROSSWALK not in areas:
            waypoint = street.get_waypoint(place.location, project_to_road=False, lane_type=carla.LaneType.Driving)
            seen["road"] += waypoint is not None
        was_on[n] = CROSSWALK if CROSSWALK in areas else ROAD if ROAD in areas else SIDEWALK


def read_mesh(client: carla.Client) -> Locator:
    return Locator(mesh_of(client))


def mesh_of(client: carla.Client) -> ReadMesh:
    """Read what the client has fetched, from where it keeps it."""
    folder = Path.home() / "carlaCache"
    name = client.get_required_files("Nav")[0]
    return read(next(folder.glob(f"**/{name}")).read_bytes())


def draw(mesh: ReadMesh, file: str) -> None:
    import matplotlib as mpl  # noqa: PLC0415 - only a picture needs it

    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - as above
    from matplotlib.collections import PolyCollection  # noqa: PLC0415 - as above

    figure, axes = plt.subplots(figsize=(16, 16))
    for area, colour in ((ROAD, "#cccccc"), (SIDEWALK, "#e8559a"), (CROSSWALK, "#5599ff")):
        rings = [tile.vertices[c, :2] for tile in mesh.tiles for kind, c, _, _ in tile.polygons if kind == area]
        axes.add_collection(PolyCollection(rings, facecolor=colour, edgecolor="black", linewidth=0.05))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.invert_yaxis()
    figure.savefig(file, dpi=100, bbox_inches="tight")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--walkers", type=int, default=200)
    parser.add_argument("--minutes", type=float, default=10.0, help="of simulated time (default: %(default)s)")
    parser.add_argument("--cross-factor", type=float, default=0.0)
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--picture", help="draw the mesh into this file too")
    parser.add_argument("--port", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.port:
        print(json.dumps(run(arguments.port, arguments)), flush=True)
        return
    digests = []
    for number in range(1, arguments.runs + 1):
        figures = alone(arguments)
        print(
            f"run {number}: {arguments.walkers} walkers, {arguments.minutes:g} min, factor {arguments.cross_factor:g}"
        )
        for name, value in figures.items():
            print(f"  {name:40} {value}")
        digests.append(figures["digest"])
    if len(digests) > 1:
        print("the runs are", "equal, byte for byte" if len(set(digests)) == 1 else "NOT equal")


def alone(arguments: argparse.Namespace) -> dict[str, object]:
    """Carry out a run with a server and a client process of its own."""
    server = subprocess.Popen(
        [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--sync"], stdout=subprocess.PIPE, text=True
    )
    try:
        ready = next((line for line in server.stdout if line.startswith("linden: ready")), None)
        if ready is None:
            raise SystemExit("the server ended before it was ready")
        port = int(ready.split("rpc port ")[1].split(",")[0])
        options = [
            "--walkers",
            arguments.walkers,
            "--minutes",
            arguments.minutes,
            "--cross-factor",
            arguments.cross_factor,
        ]
        command = [sys.executable, __file__, "--port", port, *options]
        if arguments.picture:
            draw(mesh_of(carla.Client("127.0.0.1", port)), arguments.picture)
        return json.loads(subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE).stdout)
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main()
