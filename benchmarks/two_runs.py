"""Whether two runs with one seed are equal, byte for byte: traffic and a crowd, each led by the official client.

    python benchmarks/two_runs.py [--vehicles 250] [--walkers 200] [--ticks 2000] [--seed 1] [--hybrid]

Each run is a server and a client in processes of their own. The digest is of every snapshot, as its bytes came over
the wire. A third run with another seed shows that the digest would tell a difference.
"""

import argparse
import hashlib
import random
import subprocess
import sys

import carla
from live import LINDEN, Snapshots, free_port, server, synchronous_world
from traffic import manager, populate

EVERY_TICKS = 100
"""How often a run says what the digest has come to, so that it can be told from where on two differ."""


def crowd(client: carla.Client, world: carla.World, count: int, seed: int) -> list[carla.Actor]:
    """Spawn walkers at random places of the pavements, each led by a controller that sends it to another place."""
    world.set_pedestrians_seed(seed)
    dice = random.Random(seed)
    models = sorted(world.get_blueprint_library().filter("walker.pedestrian.*"), key=lambda model: model.id)
    walkers: list[int] = []
    while len(walkers) < count:  # where somebody stands already nobody else can
        places = [world.get_random_location_from_navigation() for _ in range(count - len(walkers))]
        commands = [
            carla.command.SpawnActor(dice.choice(models), carla.Transform(place + carla.Location(z=1.0)))
            for place in places
        ]
        walkers += [answer.actor_id for answer in client.apply_batch_sync(commands, True) if not answer.has_error()]
    leader = world.get_blueprint_library().find("controller.ai.walker")
    commands = [carla.command.SpawnActor(leader, carla.Transform(), walker) for walker in walkers]
    leaders = [answer.actor_id for answer in client.apply_batch_sync(commands, True)]
    world.tick()
    return [world.get_actor(leader) for leader in leaders]


def run_alone(options: argparse.Namespace) -> None:
    """Make one run and print its digest every ``EVERY_TICKS``."""
    digest = hashlib.sha256()
    with server(LINDEN) as live:
        client = carla.Client("127.0.0.1", live.port)
        client.set_timeout(120.0)
        world = synchronous_world(client)
        snapshots = Snapshots(live)
        vehicles = populate(client, world, options.vehicles, options.seed)
        traffic_manager = manager(client, free_port(), hybrid=options.hybrid, seed=options.seed)
        world.tick()  # ends the Traffic Manager's asynchronous step
        for vehicle in vehicles:
            vehicle.set_autopilot(True, traffic_manager.get_port())
        leaders = crowd(client, world, options.walkers, options.seed)
        for leader in leaders:
            leader.start()
            leader.go_to_location(world.get_random_location_from_navigation())
            leader.set_max_speed(1.4)
        world.set_pedestrians_cross_factor(0.1)
        for tick in range(options.ticks):
            frame = world.tick()
            for message in snapshots.until(frame):
                digest.update(message)
            if (tick + 1) % EVERY_TICKS == 0 or tick + 1 == options.ticks:
                print(tick + 1, frame, digest.hexdigest(), flush=True)
        snapshots.close()
        for leader in leaders:
            leader.stop()
        traffic_manager.shut_down()


def told(options: argparse.Namespace, seed: int) -> list[tuple[int, int, str]]:
    """Return ticks, frame and digest that a run in a process of its own has printed."""
    command = [sys.executable, __file__, "--alone", "--seed", str(seed)]
    for name in ("vehicles", "walkers", "ticks"):
        command += [f"--{name}", str(getattr(options, name))]
    command += ["--hybrid"] if options.hybrid else []
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lines = [line.split() for line in output.splitlines() if len(line.split()) == 3 and line[0].isdigit()]
    return [(int(ticks), int(frame), digest) for ticks, frame, digest in lines]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, default=250)
    parser.add_argument("--walkers", type=int, default=200)
    parser.add_argument("--ticks", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--hybrid", action="store_true", help="the Traffic Manager in hybrid physics mode")
    parser.add_argument("--alone", action="store_true", help="make one run only, and say what its digest comes to")
    options = parser.parse_args()
    if options.alone:
        run_alone(options)
        return
    first, second, other = (told(options, seed) for seed in (options.seed, options.seed, options.seed + 1))
    for name, run in {"first": first, "second": second, "another seed": other}.items():
        ticks, frame, digest = run[-1]
        print(
            f"{name:13} {options.vehicles} vehicles, {options.walkers} walkers, {ticks} ticks: frame {frame}, {digest}"
        )
    if first == second:
        print("the two runs are equal, byte for byte;", end=" ")
    else:
        differing = next((one[0] for one, two in zip(first, second, strict=False) if one != two), "the last")
        print(
            f"the two runs are NOT equal: they differ from within the {EVERY_TICKS} ticks before {differing};", end=" "
        )
    print("another seed gives", "other bytes" if other[-1] != first[-1] else "THE SAME bytes")
    if first != second or other[-1] == first[-1]:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
