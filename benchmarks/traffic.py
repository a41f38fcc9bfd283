"""How the official client's Traffic Manager fares on our streets: who gets stuck, who collides, who runs a light.

    python benchmarks/traffic.py [--map Linden] [--maps FOLDER] [--vehicles 250] [--minutes 10] [--hybrid off on]

Synchronous mode, 0.05 s a tick; one seed for everything that is random. What is said of the vehicles is judged from the
snapshots alone (traffic_watch.py); ticks/s counts the time within ``world.tick()``, the watching left out.
"""

import argparse
import random
import time
from typing import NamedTuple

import carla
import numpy as np
import psutil
from live import LINDEN, STEP_S, Live, Snapshots, cpu_s, free_port, server, synchronous_world
from traffic_watch import LIMITS_S, MOVED_M, Watch, fleet_of, stop_signs

OFF_ROAD_EVERY_TICKS = 100
SAFE = "car"


def populate(client: carla.Client, world: carla.World, count: int, seed: int) -> list[carla.Vehicle]:
    """Spawn cars as CARLA's generate_traffic.py does with --safe: at shuffled points, of models at random."""
    dice = random.Random(seed)
    models = sorted(world.get_blueprint_library().filter("vehicle.*"), key=lambda model: model.id)
    models = [model for model in models if model.get_attribute("base_type") == SAFE]
    points = world.get_map().get_spawn_points()
    dice.shuffle(points)
    commands = []
    for point in points[:count]:
        model = dice.choice(models)
        model.set_attribute("role_name", "hero" if not commands else "autopilot")
        commands.append(carla.command.SpawnActor(model, point))
    answers = client.apply_batch_sync(commands, True)
    ids = [answer.actor_id for answer in answers if not answer.has_error()]
    if len(ids) < count:
        print(f"{count - len(ids)} of {count} vehicles found no room ({len(points)} spawn points)")
    world.tick()
    return [world.get_actor(actor_id) for actor_id in ids]


def manager(client: carla.Client, port: int, *, hybrid: bool, seed: int) -> carla.TrafficManager:
    traffic_manager = client.get_trafficmanager(port)
    traffic_manager.set_synchronous_mode(True)
    traffic_manager.set_random_device_seed(seed)
    traffic_manager.set_global_distance_to_leading_vehicle(2.5)
    if hybrid:
        traffic_manager.set_hybrid_physics_mode(True)
        traffic_manager.set_hybrid_physics_radius(70.0)
    return traffic_manager


class Figures(NamedTuple):
    """One run's: what was seen, and what the time went into."""

    watch: Watch
    off_road: int
    ticks_per_s: float
    client_share: float
    """Of the processor's time of client and server together."""


def drive(options: argparse.Namespace, *, hybrid: bool) -> Figures:
    with server([*LINDEN, *(["--maps", options.maps] if options.maps else [])]) as live:
        client = carla.Client("127.0.0.1", live.port)
        client.set_timeout(120.0)
        if options.map != "Linden":
            client.load_world(options.map)
        world = synchronous_world(client)
        signs = stop_signs(world)
        vehicles = populate(client, world, options.vehicles, options.seed)
        traffic_manager = manager(client, free_port(), hybrid=hybrid, seed=options.seed)
        for vehicle in vehicles:
            vehicle.set_autopilot(True, traffic_manager.get_port())
        watch = Watch(fleet_of(vehicles), signs, STEP_S)
        figures = watched(live, world, watch, round(options.minutes * 60.0 / STEP_S))
        if options.verbose:
            tell_worst(world, watch)
        traffic_manager.shut_down()
        return figures


def watched(live: Live, world: carla.World, watch: Watch, ticks: int) -> Figures:
    snapshots, town, own = Snapshots(live), world.get_map(), psutil.Process()
    inside_s = client_s = server_s = 0.0
    strayed: set[int] = set()
    for tick in range(ticks):
        began_s, client_began_s, server_began_s = time.perf_counter(), cpu_s(own), cpu_s(live.process)
        frame = world.tick()
        inside_s += time.perf_counter() - began_s
        client_s, server_s = client_s + cpu_s(own) - client_began_s, server_s + cpu_s(live.process) - server_began_s
        watch.see(snapshots.rows_of(frame))
        if tick % OFF_ROAD_EVERY_TICKS == 0:
            strayed |= off_road(town, watch)
    snapshots.close()
    return Figures(watch, len(strayed), ticks / inside_s, client_s / (client_s + server_s))


def off_road(town: carla.Map, watch: Watch) -> set[int]:
    """Return the vehicles, by their place in the fleet, whose middle lies on nothing that is for driving."""
    here = [carla.Location(*map(float, place)) for place in watch.place]
    kinds = carla.LaneType.Driving | carla.LaneType.Parking | carla.LaneType.Shoulder | carla.LaneType.Bidirectional
    return {
        nth
        for nth, place in enumerate(here)
        if watch.present[nth] and town.get_waypoint(place, project_to_road=False, lane_type=kinds) is None
    }


def tell_worst(world: carla.World, watch: Watch) -> None:
    """Say of those who stood longest who and where they were."""
    town = world.get_map()
    for nth in np.argsort(-watch.longest_standing_s)[:15]:
        x, y = watch.worst_place[nth]
        found = town.get_waypoint(carla.Location(float(x), float(y), float(watch.place[nth, 2])))
        print(
            f"  actor {watch.ids[nth]}: stood {watch.longest_standing_s[nth]:.0f} s, {watch.longest_idle_s[nth]:.0f} s "
            f"without a reason, at ({x:.0f}, {y:.0f}), road {found.road_id} lane {found.lane_id} "
            f"junction {found.junction_id if found.is_junction else '-'}, drove {watch.driven_m[nth]:.0f} m, "
            f"{'present' if watch.present[nth] else 'destroyed'}"
        )


def tell(name: str, figures: Figures) -> None:
    watch = figures.watch
    count = len(watch.driven_m)
    stood = ", ".join(f"{int((watch.longest_standing_s > limit).sum())}" for limit in LIMITS_S)
    idle = ", ".join(f"{int((watch.longest_idle_s > limit).sum())}" for limit in LIMITS_S)
    limits = "/".join(f"{limit:.0f}" for limit in LIMITS_S)
    passes = watch.sign_passes
    print(f"{name}: {count} vehicles, {watch.time_s / 60.0:.1f} min")
    for label, value in {
        "drove more than 20 m": f"{int((watch.driven_m > MOVED_M).sum())}",
        f"stood longer than {limits} s": stood,
        "  with no light, sign or queue": idle,
        "pile-ups (touching longer than 10 s)": f"{watch.pile_ups}",
        "collisions (pairs that began to touch)": f"{watch.collisions}",
        "off the road, fallen over": f"{figures.off_road}, {int(watch.fallen.sum())}",
        "destroyed by the Traffic Manager": f"{int((~watch.present).sum())}",
        "mean speed": f"{watch.driven_m.sum() / count / watch.time_s * 3.6:.1f} km/h",
        "came to a red light: waited / ran it": f"{watch.red_waits} / {watch.red_runs}",
        "stop signs: stood / below 3 km/h / passed": f"{passes['stood']} / {passes['crept']} / {passes['passed']}",
        "ticks/s": f"{figures.ticks_per_s:.1f}",
        "client's share of the processor's time": f"{figures.client_share:.0%}",
    }.items():
        print(f"  {label:42}{value}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map", default="Linden")
    parser.add_argument("--maps", help="a folder of more maps for the server")
    parser.add_argument("--vehicles", type=int, default=250)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--hybrid", nargs="+", choices=["off", "on"], default=["off", "on"], help="hybrid physics")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--verbose", action="store_true", help="say who stood longest, and where")
    options = parser.parse_args()
    for hybrid in options.hybrid:
        tell(f"{options.map}, hybrid physics {hybrid}", drive(options, hybrid=hybrid == "on"))


if __name__ == "__main__":
    main()
