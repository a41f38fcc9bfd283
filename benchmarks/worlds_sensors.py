"""Lidar rays and pictures a second of many worlds in one process, beside raw Embree and beside sensors one by one.

    python benchmarks/worlds_sensors.py [--worlds 1 16 256] [--device cpu] [--rounds 5]

Each world has two cars and a walker. A lidar has 16 channels of 64 rays, pictures have 64 x 64 pixels. Times are the
best of all rounds. The last column counts the seconds of all processors that this process took, in place of time: what
the machine does beside is not in it.

The limit is "raw" of ``rays.py``: Embree's own call on packets that lie ready in memory, with the rays of a lidar and
of a camera in one of these worlds. The peer is a sensor of the server: the same car, one measurement after the other.
With ``--device cuda`` NVIDIA Warp casts the rays, and the first two worlds are compared with those of the processor.
Rows "stays" leave the measurements on the device (``on_device=True``). It needs ``pip install 'linden[gpu]'``.
"""

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rays import RaySet, directions_of_camera, raw, timed

from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.sensors.casting.caster import Rays
from linden.sensors.casting.embree import EmbreeCaster
from linden.sensors.casting.thread_pool import processors
from linden.sensors.devices.lidar.firing_pattern import Fan, aim, fire
from linden.world import World
from linden.worlds import Worlds

CHANNELS, STEPS, SIDE_PX, FAR_M = 16, 64, 64, 100.0
LIDAR: dict[str, Any] = {
    "channels": CHANNELS,
    "points_per_second": CHANNELS * STEPS * 20,
    "range": FAR_M,
    "dropoff_general_rate": 0.0,
    "dropoff_zero_intensity": 0.0,
}
ON_ROOF = [0.0, 0.0, 2.4, 0.0, 0.0, 0.0]
KINDS = ("lidar", "depth", "semantic", "rgb")
RAYS = {"lidar": CHANNELS * STEPS, "depth": SIDE_PX**2, "semantic": SIDE_PX**2, "rgb": SIDE_PX**2}
CAR, WALKER = "vehicle.tesla.model3", "walker.pedestrian.0003"


def made(count: int, device: str) -> Worlds:
    """Return worlds that have driven for half a second."""
    worlds = Worlds(count=count, device=device)
    for blueprint, point in ((CAR, 30), (CAR, 10), (WALKER, 3)):
        worlds.spawn(blueprint, point)
    worlds.set_controls(np.random.default_rng(1).uniform([0.2, -0.3, 0.0], [0.9, 0.3, 0.0], (count, 3)))
    for _ in range(10):
        worlds.step()
    return worlds


def measure(worlds: Worlds, kind: str, *, stays: bool = False) -> NDArray[Any]:
    """Return what is measured on the host, or on the device if it ``stays`` there, when it is done."""
    if kind == "lidar":
        found: NDArray[Any] = worlds.lidar(ON_ROOF, on_device=stays, **LIDAR).points
    else:
        found = worlds.pictures(kind, ON_ROOF, size=(SIDE_PX, SIDE_PX), on_device=stays)
    if stays:
        worlds.wait()
    return found


def busy_s(work: Callable[[], object], rounds: int) -> float:
    """Return the seconds of all processors that a call takes, the least of all rounds."""
    taken = []
    for _ in range(rounds):
        began = time.process_time()
        work()
        taken.append(time.process_time() - began)
    return min(taken)


def limits(caster: EmbreeCaster, rounds: int) -> dict[str, float]:
    """Return the rays a second of raw Embree for the rays of a lidar and of a camera, 64 times each."""
    (x_m, y_m, z_m), turned = made(1, "cpu").map.spawn_points[30]
    pose = Transform(Vector3D(x_m, y_m, z_m + 2.4), turned)
    fired = fire(Fan(CHANNELS, 10.0, -30.0, 360.0, 20.0, CHANNELS * STEPS * 20, FAR_M), 0.0, 0.05)
    lidar = aim(fired, np.arange(fired.rays, dtype=np.int32), pose)
    ahead = directions_of_camera(SIDE_PX, SIDE_PX)
    camera = Rays(np.tile(np.array(pose.location, np.float32), (len(ahead), 1)), ahead)
    found = {}
    for name, rays in (("lidar", lidar), ("camera", camera)):
        many = Rays(*(np.tile(column, (64, 1)) for column in rays))
        prepare, go = raw(caster, RaySet(many, coherent=True))
        found[name] = 1000.0 * len(many.origin_m) / timed(go, rounds, prepare)
    return found


def server(rounds: int) -> tuple[dict[str, float], EmbreeCaster]:
    """Return measurements a second of sensors of the server, one after the other, and its caster."""
    world = World(made(1, "cpu").map, EpisodeSettings())
    car = world.spawn(ActorDescription(0, CAR), world.spawn_points[30])
    size = {"image_size_x": SIDE_PX, "image_size_y": SIDE_PX}
    asked: dict[str, tuple[str, dict[str, Any]]] = {
        "lidar": ("sensor.lidar.ray_cast", LIDAR | {"rotation_frequency": 20.0}),
        "depth": ("sensor.camera.depth", size),
        "semantic": ("sensor.camera.semantic_segmentation", size),
        "rgb": ("sensor.camera.rgb", size),
    }
    found = {}
    for kind, (blueprint, chosen) in asked.items():
        given = tuple(AttributeValue(name, AttributeType.STRING, str(value)) for name, value in chosen.items())
        place = Transform(Vector3D(*ON_ROOF[:3]), Rotation(*ON_ROOF[3:]))
        sensor = world.spawn(ActorDescription(0, blueprint, given), place, parent_id=car.id)

        def one(stream_id: int = sensor.stream_id) -> None:
            world.step(0.05)
            world.measure({stream_id})

        one()
        found[kind] = 1000.0 / timed(one, 10 * rounds)
        world.destroy(sensor.id)
    caster = world.sensor_scene.look(world.episode, world.frame).caster
    assert isinstance(caster, EmbreeCaster), "the limit needs Embree"
    return found, caster


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, nargs="+", default=[1, 16, 256])
    parser.add_argument("--device", choices=("cpu", "cuda"), default="cpu")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    one_by_one, caster = server(options.rounds)
    limit = limits(caster, options.rounds)
    print(f"raw Embree on {processors()} processors: lidar {limit['lidar']:.3g}, camera {limit['camera']:.3g} rays/s")
    print("server, one by one: " + ", ".join(f"{kind} {rate:.0f}/s" for kind, rate in one_by_one.items()))
    print("device  kind      worlds  measurements/s       rays/s  of limit  of one by one  rays per processor's second")
    for kind in KINDS:
        for count in options.worlds:
            worlds = made(count, options.device)
            for stays in (False, True) if options.device == "cuda" and kind != "rgb" else (False,):
                print(row(worlds, kind, options, limit, one_by_one, stays=stays), flush=True)


def row(
    worlds: Worlds,
    kind: str,
    options: argparse.Namespace,
    limit: dict[str, float],
    one_by_one: dict[str, float],
    *,
    stays: bool,
) -> str:
    """Return a row of the table."""

    def work() -> object:
        return measure(worlds, kind, stays=stays)

    work()
    wall_s = timed(work, options.rounds) / 1000.0
    rays = worlds.count * RAYS[kind]
    share = rays / wall_s / limit["lidar" if kind == "lidar" else "camera"]
    each = rays / busy_s(work, options.rounds)
    beside = ""
    if stays:
        beside = "  stays"
    elif options.device == "cuda":
        few = min(worlds.count, 2)
        ours, theirs = (measure(made(few, device), kind)[:few].astype(np.float64) for device in ("cpu", options.device))
        beside = f"  {np.isclose(theirs, ours, atol=1e-3).mean():.3%} of the values as on the processor"
    times = worlds.count / wall_s / one_by_one[kind]
    start = f"{options.device:6}  {kind:8}  {worlds.count:6}  {worlds.count / wall_s:14.0f}  {rays / wall_s:11.3g}"
    return f"{start}  {share:8.0%}  {times:13.1f}  {each:27.3g}{beside}"


if __name__ == "__main__":
    main()
