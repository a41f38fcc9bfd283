"""How many pictures a second the official client gets, and where their time goes in the server.

    python benchmarks/cameras.py [--frames 60] [--vehicles 50] [--weather noon|night|rain]

Linden in synchronous mode, a car among others, one camera on its roof; a frame is done when its picture is in the
client's hands. The second table is one RGB picture stage by stage, in this process, without wire and client.
"""

import argparse
import queue
import statistics
import time
from collections.abc import Callable

import carla
from live import server, synchronous_world

from linden.sensors.camera import labels
from linden.sensors.camera.picture import rgb
from linden.sensors.camera.picture.develop import developed
from linden.sensors.camera.picture.edges import edge_rays, finer
from linden.sensors.camera.picture.shadows import sunny, within
from linden.sensors.camera.rays import aim, directions
from linden.sensors.camera.spec import CameraSpec, Film
from linden.simulation import Simulation
from linden.values.actors import ActorDescription
from linden.values.space import Rotation, Transform
from linden.world.map_cache import MapCache
from linden.world.maps import MapLibrary

LINDEN = ["-m", "linden.cli", "serve", "--port", "0", "--sync"]
KINDS = ("depth", "semantic_segmentation", "rgb")
SIZES = ((800, 600), (1280, 720))
WEATHERS = {
    "noon": carla.WeatherParameters.ClearNoon,
    "night": carla.WeatherParameters.ClearNight,
    "rain": carla.WeatherParameters.HardRainNoon,
}
ROOF = carla.Transform(carla.Location(x=0.5, z=2.0))
WARM_UP = 5


def through_the_client(frames: int, vehicles: int, weather: str) -> None:
    with server(LINDEN) as live:
        client = carla.Client("127.0.0.1", live.port)
        client.set_timeout(120.0)
        world = synchronous_world(client)
        world.set_weather(WEATHERS[weather])
        library = world.get_blueprint_library()
        points = world.get_map().get_spawn_points()
        car = world.spawn_actor(library.find("vehicle.tesla.model3"), points[0])
        others = [item for item in library.filter("vehicle.*") if item.get_attribute("base_type") == "car"]
        client.apply_batch_sync(
            [carla.command.SpawnActor(others[n % len(others)], points[3 * n + 3]) for n in range(vehicles)], True
        )
        for _ in range(20):
            world.tick()
        print("| camera | size | ms a frame | frames/s | server's processor, ms |\n|---|---|---|---|---|")
        for kind in KINDS:
            for width, height in SIZES:
                blueprint = library.find(f"sensor.camera.{kind}")
                blueprint.set_attribute("image_size_x", str(width))
                blueprint.set_attribute("image_size_y", str(height))
                sensor = world.spawn_actor(blueprint, ROOF, attach_to=car)
                arrived: queue.Queue[int] = queue.Queue()
                sensor.listen(lambda image, arrived=arrived: arrived.put(image.frame))
                first(world, arrived)
                times, before = [], cpu_s(live)
                for _ in range(frames):
                    begin = time.perf_counter()
                    frame = world.tick()
                    while arrived.get(timeout=60.0) < frame:
                        continue
                    times.append(time.perf_counter() - begin)
                used_ms = (cpu_s(live) - before) / frames * 1000.0
                ms = statistics.median(times) * 1000.0
                print(f"| {kind} | {width} x {height} | {ms:.1f} | {1000.0 / ms:.1f} | {used_ms:.0f} |", flush=True)
                sensor.stop()
                for _ in range(3):
                    world.tick()
                sensor.destroy()


def first(world: carla.World, arrived: "queue.Queue[int]") -> None:
    """Tick until pictures come, and a few more."""
    for _ in range(100):
        world.tick()
        try:
            arrived.get(timeout=1.0)
            break
        except queue.Empty:
            continue
    for _ in range(WARM_UP):
        frame = world.tick()
        while arrived.get(timeout=60.0) < frame:
            continue


def cpu_s(live: object) -> float:
    used = live.process.cpu_times()
    return used.user + used.system


def stage_by_stage(rounds: int) -> None:
    simulation = Simulation(MapLibrary([], MapCache.of_user().facts_of).load("Linden"))
    simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), simulation.spawn_points[3])
    simulation.step(0.05)
    seen = simulation.seeing.look(simulation.episode, simulation.frame)
    place = simulation.spawn_points[0]
    pose = Transform(place.location._replace(z=place.location.z + 2.0), Rotation(0.0, place.rotation.yaw, 0.0))
    spec, film = CameraSpec(), Film()
    rgb.picture(spec, film, pose, *viewed(spec, pose, seen), seen)

    def took(name: str, work: Callable[[], object]) -> object:
        times, answer = [], None
        for _ in range(rounds):
            begin = time.perf_counter()
            answer = work()
            times.append(time.perf_counter() - begin)
        print(f"| {name} | {statistics.median(times) * 1000.0:.1f} |", flush=True)
        return answer

    print("\n| stage of an RGB picture, 800 x 600 | ms |\n|---|---|")
    rays = took("rays", lambda: aim(directions(spec), pose))
    hits = took("what they meet", lambda: seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True))
    lit = took("lamps and places", lambda: rgb.light_of(pose, seen))
    sun = took("shadows", lambda: sunny(seen.caster, rays, hits, lit.air))
    light = took("shading", lambda: rgb.shone(rays, hits, sun, 1.0 / spec.focal_px, lit, seen))
    rows = took("edges", lambda: edge_rays(spec, hits, light))
    fine = finer(spec, rows, pose)
    met = took(
        f"four rays for each of {len(rows)} pixels",
        lambda: seen.caster.closest(fine, labels.FAR_M, coherent=True, outer=True),
    )
    fine_sun = took("their shadows", lambda: sunny(seen.caster, fine, met, lit.air, within(spec, rows, sun)))
    took("their shading", lambda: rgb.shone(fine, met, fine_sun, 0.5 / spec.focal_px, lit, seen))
    took("film", lambda: developed(spec, film, light, lit.air))
    took("all of it", lambda: rgb.picture(spec, film, pose, *viewed(spec, pose, seen), seen))


def viewed(spec: CameraSpec, pose: Transform, seen: object) -> tuple[object, object]:
    rays = aim(directions(spec), pose)
    return rays, seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--vehicles", type=int, default=50)
    parser.add_argument("--weather", choices=WEATHERS, default="noon")
    given = parser.parse_args()
    through_the_client(given.frames, given.vehicles, given.weather)
    stage_by_stage(max(5, given.frames // 4))
