"""Where the time of one colour picture goes, stage by stage.

    python benchmarks/cameras.py [--rounds 15]

Medians of the rounds in this process, without wire and client; ``sensors.py`` has whole frames.
"""

import argparse
import statistics
import time
from collections.abc import Callable
from typing import TypeVar

from linden.maps.cache import MapCache
from linden.maps.library import MapLibrary
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Rotation, Transform
from linden.sensors.camera import labels
from linden.sensors.camera.picture import rgb
from linden.sensors.camera.picture.edges import edge_rays, finer
from linden.sensors.camera.picture.film import developed
from linden.sensors.camera.picture.sun_shadows import sunny, within
from linden.sensors.camera.pixel_rays import aim, directions
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.casting.caster import Hits, Rays
from linden.sensors.view import Seen
from linden.world import World

T = TypeVar("T")


def stage_by_stage(rounds: int) -> None:
    simulation = World(MapLibrary([], MapCache.of_user().read).load("Linden"))
    simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), simulation.spawn_points[3])
    simulation.step(0.05)
    seen = simulation.sensor_scene.look(simulation.episode, simulation.frame)
    place = simulation.spawn_points[0]
    pose = Transform(place.location._replace(z=place.location.z + 2.0), Rotation(0.0, place.rotation.yaw, 0.0))
    spec, film = CameraSpec(), Film()
    rgb.picture(spec, film, pose, *viewed(spec, pose, seen), seen)

    def took(name: str, work: Callable[[], T]) -> T:
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            answer = work()
            times.append(time.perf_counter() - begin)
        print(f"| {name} | {statistics.median(times) * 1000.0:.1f} |", flush=True)
        return answer

    print("| stage of an RGB picture, 800 x 600 | ms |\n|---|---|")
    rays = took("rays", lambda: aim(directions(spec), pose))
    hits = took("what they meet", lambda: seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True))
    lit = took("lamps and places", lambda: rgb.light_of(pose, seen, rgb.places_of(seen)))
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


def viewed(spec: CameraSpec, pose: Transform, seen: Seen) -> tuple[Rays, Hits]:
    rays = aim(directions(spec), pose)
    return rays, seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    stage_by_stage(parser.parse_args().rounds)
