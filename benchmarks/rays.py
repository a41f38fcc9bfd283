"""What the caster takes beside raw Embree on the same rays, and what lidars and radar take with all that is theirs.

    python benchmarks/rays.py [--vehicles 50] [--rounds 15]

Linden with vehicles on its spawn points; rays from one of them. "raw" is Embree's own packet call on packets that lie
ready in memory, by as many threads and in packets as wide: nothing is filled in, read out or allocated. "caster" is
``closest`` or ``blocked``, arrays in and arrays out; "embreex" its own call. Times are the best of
all rounds in ms: what the machine does beside is not in them.
"""

import argparse
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Transform, Vector3D
from linden.scenery.map_mesh_cache import standing_of
from linden.sensors.casting.caster import Rays
from linden.sensors.casting.embree import EmbreeCaster, arguments
from linden.sensors.casting.embreex_caster import EmbreexCaster
from linden.sensors.casting.packets import RayPacket, intersect, new_packet, occlude, put_rays
from linden.sensors.casting.thread_pool import in_stretches, processors
from linden.sensors.devices.lidar.firing_pattern import Fan, aim, fire
from linden.sensors.runtime.looking_sensors import SensorFrame
from linden.world import World

FAR_M = 200.0
COLUMNS = 22  # of a packet with its mask
STEP_S = 0.05


class RaySet(NamedTuple):
    rays: Rays
    coherent: bool
    shadow: bool = False


@unlocked
def fill(packets: NDArray[np.float32], width: int, origin: NDArray[np.float32], direction: NDArray[np.float32]) -> None:
    for first in range(0, len(origin), width):
        packet = new_packet(width)
        put_rays(packet, width, origin, direction, first, min(width, len(origin) - first), FAR_M)
        packets[first // width] = packet.floats


@unlocked
def send(
    packets: NDArray[np.float32],
    ints: NDArray[np.int32],
    width: int,
    scene: int,
    flags: int,
    shadow: bool,  # noqa: FBT001 - numba knows no keywords
    start: int,
    stop: int,
) -> None:
    for row in range(start, stop):
        at = packets[row].ctypes.data
        packet = RayPacket(packets[row], ints[row], ints[row], at, at + (COLUMNS - 1) * width * 4)
        if shadow:
            occlude(packet, width, scene, flags)
        else:
            intersect(packet, width, scene, flags)


def raw(caster: EmbreeCaster, case: RaySet) -> tuple[Callable[[], None], Callable[[], None]]:
    """Return what makes the packets ready and what sends them."""
    width, rays = caster.width, case.rays
    rows = -(-len(rays.origin_m) // width)
    memory = np.zeros(rows * COLUMNS * width + 16, np.float32)
    skip = (-memory.ctypes.data % 64) // 4
    packets = memory[skip : skip + rows * COLUMNS * width].reshape(rows, COLUMNS * width)
    fill(packets, width, *rays)
    ready, ints = packets.copy(), packets.view(np.int32)

    def prepare() -> None:
        packets[:] = ready

    def work(start: int, stop: int) -> None:
        send(packets, ints, width, caster.scene, arguments(coherent=case.coherent), case.shadow, start, stop)

    return prepare, lambda: in_stretches(rows, work, multiple=64)


def directions_of_camera(width_px: int, height_px: int) -> NDArray[np.float32]:
    """Return (N, 3) of a camera with 90 degrees across, in tiles of 4 x 4 pixels."""
    down, across, row, column = np.meshgrid(
        np.arange(height_px // 4), np.arange(width_px // 4), np.arange(4), np.arange(4), indexing="ij"
    )
    x = (across * 4 + column).ravel() + 0.5 - width_px / 2
    y = (down * 4 + row).ravel() + 0.5 - height_px / 2
    vectors = np.column_stack([np.full(x.shape, width_px / 2), x, -y])
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)


def ray_sets(caster: EmbreeCaster, pose: Transform, dice: np.random.Generator) -> dict[str, RaySet]:
    place = np.array(pose.location, np.float32)
    ahead = directions_of_camera(800, 600)
    camera = Rays(np.tile(place, (len(ahead), 1)), ahead)
    seen = caster.closest(camera, FAR_M, coherent=True)
    met = np.isfinite(seen.distance_m)
    ground = camera.origin_m[met] + ahead[met] * seen.distance_m[met, None] + 1e-3 * seen.normal[met]
    sun = np.tile(np.float32([0.45, 0.35, 0.82]), (len(ground), 1))
    anywhere = dice.normal(size=(len(ground), 3)).astype(np.float32)
    anywhere /= np.linalg.norm(anywhere, axis=1, keepdims=True)
    sets = {"camera 800 x 600": RaySet(camera, coherent=True)}
    for channels, points_per_s in ((32, 560_000), (64, 1_300_000)):
        fan = Fan(channels, 10.0, -30.0, 360.0, 10.0, points_per_s, 100.0)
        fired = fire(fan, 0.0, 0.1)
        sets[f"lidar {channels} channels, a turn"] = RaySet(
            aim(fired, np.arange(fired.rays, dtype=np.int32), pose), coherent=True
        )
    sets["shadows of the camera's"] = RaySet(Rays(ground, sun), coherent=True, shadow=True)
    sets["incoherent, from there"] = RaySet(Rays(ground, anywhere), coherent=False)
    return sets


def timed(work: Callable[[], object], rounds: int, before: Callable[[], object] = lambda: None) -> float:
    taken = []
    for _ in range(rounds):
        before()
        began = time.perf_counter()
        work()
        taken.append(time.perf_counter() - began)
    return 1000.0 * min(taken)


def town(vehicles: int) -> World:
    cache = MapCache.of_user()
    simulation = World(MapLibrary((), cache.read).load(HOME_MAP), EpisodeSettings())
    simulation.sensor_scene.standing_on = lambda world_map, scene: standing_of(world_map, scene, cache)
    points = simulation.spawn_points
    for point in points[:: max(1, len(points) // vehicles)][:vehicles]:
        simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), point)
    simulation.step(STEP_S)
    return simulation


SENSORS = {
    "sensor.lidar.ray_cast, 32 channels": {"channels": "32", "points_per_second": "560000", "range": "100.0"},
    "sensor.lidar.ray_cast, 64 channels": {"channels": "64", "points_per_second": "1300000", "range": "100.0"},
    "sensor.lidar.ray_cast_semantic, 64 channels": {
        "channels": "64",
        "points_per_second": "1300000",
        "range": "100.0",
    },
    "sensor.other.radar": {"range": "100.0"},
    "sensor.other.obstacle": {"distance": "20.0"},
}


def sensor_ms(simulation: World, name: str, chosen: dict[str, str], rounds: int) -> float:
    """Return what one measurement of 0.1 s takes in the simulation, bodies gathered and posed in it."""
    blueprint = simulation.library.find(name.split(",", maxsplit=1)[0])
    types = {item.id: item.type for item in blueprint.definition.attributes}
    values = tuple(AttributeValue(key, types[key], value) for key, value in chosen.items())
    carrier = next(record.id for record in simulation.episode.actors if record.description.id.startswith("vehicle."))
    description = ActorDescription(0, blueprint.definition.id, values)
    sensor = simulation.spawn(description, Transform(Vector3D(0.0, 0.0, 2.4)), parent_id=carrier)
    simulation.measure({sensor.stream_id})
    taken = timed(lambda: simulation.measure({sensor.stream_id}), rounds, before=lambda: simulation.step(0.1))
    simulation.destroy(sensor.id)
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, default=50)
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    simulation = town(options.vehicles)
    began = time.perf_counter()
    now = SensorFrame(simulation.sensor_scene, simulation.frame, STEP_S)
    seen = now.sensor_scene.look(simulation.episode, now.frame)
    print(f"the first look took {time.perf_counter() - began:.2f} s: bodies, trees")
    caster = seen.caster
    assert isinstance(caster, EmbreeCaster)
    slow = EmbreexCaster(seen.standing, list(seen.bodies))
    slow.pose(seen.instances)
    print(
        f"{len(seen.standing.triangles):,} triangles stand, {len(seen.instances.mesh)} bodies move; "
        f"{processors()} threads, packets of {caster.width}\n"
    )
    print(f"{'rays':<28}{'number':>9}{'raw':>9}{'caster':>9}{'share':>8}{'embreex':>9}{'Mrays/s':>9}")
    car = next(record for record in simulation.episode.actors if record.description.id.startswith("vehicle."))
    place = simulation.episode.transform(car.id)
    above = place._replace(location=place.location._replace(z=place.location.z + 2.4))
    for name, case in ray_sets(caster, above, np.random.default_rng(1)).items():
        ask = caster.blocked if case.shadow else caster.closest
        ask_slow = slow.blocked if case.shadow else slow.closest
        ask(case.rays, FAR_M, coherent=case.coherent)
        prepare, go = raw(caster, case)
        raw_ms, ours_ms, count = timed(go, options.rounds, prepare), 0.0, len(case.rays.origin_m)
        ours_ms = timed(lambda: ask(case.rays, FAR_M, coherent=case.coherent), options.rounds)  # noqa: B023 - at once
        slow_ms = timed(lambda: ask_slow(case.rays, FAR_M), 3)  # noqa: B023 - at once
        print(
            f"{name:<28}{count:>9,}{raw_ms:>9.2f}{ours_ms:>9.2f}{raw_ms / ours_ms:>8.0%}{slow_ms:>9.1f}"
            f"{count / ours_ms / 1000.0:>9.1f}"
        )
    print("\nsensor, 0.1 s of it                              ms")
    for name, chosen in SENSORS.items():
        print(f"{name:<46}{sensor_ms(simulation, name, chosen, options.rounds):>6.2f}")


if __name__ == "__main__":
    main()
