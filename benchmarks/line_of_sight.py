"""What the line-of-sight filter costs a tick, by the number of others: in the middle of Linden, its real boxes.

    python benchmarks/line_of_sight.py

Prints the time of the filter alone (``Sight._visible``: rays, light, weather) for actors on the streets around a
vehicle, and what fetching the town's boxes takes once per process.
"""

from __future__ import annotations

import math
import random
import statistics
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import carla

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from basu.agents.sight import ActorKind, Other, Sight
from basu.agents.sight.occlusion import static_boxes
from servers import running_server

COUNTS = (10, 25, 50, 100, 200)
REACHES_M = (80.0, 350.0)
ROUNDS = 300


def others_around(waypoints: list[carla.Waypoint], at: carla.Location, count: int, reach_m: float) -> list[Other]:
    """Cars on lanes and walkers beside them, within reach."""
    chance = random.Random(1)
    near = [
        w.transform
        for w in waypoints
        if max(abs(w.transform.location.x - at.x), abs(w.transform.location.y - at.y)) < reach_m
    ]
    found = []
    for number, pose in enumerate(chance.choices(near, k=count)):
        walks = number % 4 == 0
        kind, half = (ActorKind.WALKER, (0.19, 0.19, 0.93)) if walks else (ActorKind.VEHICLE, (2.3, 0.95, 0.75))
        aside_m = 5.0 if walks else 0.0
        yaw_rad = math.radians(pose.rotation.yaw)
        x_m, y_m = pose.location.x - aside_m * math.sin(yaw_rad), pose.location.y + aside_m * math.cos(yaw_rad)
        found.append(
            Other(number, kind, x_m, y_m, yaw_rad, 1.0, 0.0, 0.0, half[0], half[1], pose.location.z + half[2], half[2])
        )
    return found


def main() -> None:
    """Print the table."""
    with running_server() as server:
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(60.0)
        world = client.get_world()
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        static_boxes(world)
        print(
            f"the town's boxes, once per process: {time.perf_counter() - began_s:.2f} s, "
            f"{time.process_time() - began_cpu_s:.2f} s of them here"
        )
        town = world.get_map()
        waypoints = town.generate_waypoints(5.0)
        vehicle = SimpleNamespace(
            id=0, bounding_box=carla.BoundingBox(carla.Location(0.0, 0.0, 1.435), carla.Vector3D(2.01, 1.0, 1.435))
        )
        start = min(waypoints, key=lambda w: w.transform.location.distance(carla.Location(80.0, 20.0, 248.0))).transform
        print("within m   others   seen   ms a tick: median, slowest of 20")
        for reach_m in REACHES_M:
            for count in COUNTS:
                sight = Sight(world, vehicle, reach_m)
                others = others_around(waypoints, start.location, count, reach_m)
                seen = sum(sight._visible(others, start))  # noqa: SLF001 - the part that is measured
                took_ms = []
                for _ in range(ROUNDS):
                    before_s = time.perf_counter()
                    sight._visible(others, start)  # noqa: SLF001
                    took_ms.append(1000.0 * (time.perf_counter() - before_s))
                slow = statistics.quantiles(took_ms, n=20)[-1]
                print(f"{reach_m:8.0f} {count:8} {seen:6} {statistics.median(took_ms):12.3f}, {slow:.3f}")


if __name__ == "__main__":
    main()
