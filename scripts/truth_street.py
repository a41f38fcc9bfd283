"""Record a street with pedestrians for scripts/truth_pictures.py: `truth_street.py FOLDER`.

The shuttle drives at 3 m/s behind a car. Pedestrians walk on both pavements and over the street, and two cars come
towards it. All actors are put to their places in each frame, so the recording is the same in each run.
"""

import json
import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import carla

from basu.managers.recorded_conditions import Conditions, WeatherFrom, write_conditions
from basu.records.recording_files import LOG_FILE
from basu.routing.weather import WEATHER_FIELDS
from basu.simulator import OwnServer, connect

STEP_S, FRAMES, SPEED_MPS = 0.05, 120, 3.0
SEED = 7
CARS = (
    ("vehicle.audi.a2", 22.0, 0.0, SPEED_MPS),
    ("vehicle.mini.cooper_s", 60.0, -3.6, -6.0),
    ("vehicle.audi.etron", 85.0, -3.6, -6.0),
)
"""Blueprint, place ahead and to the right of the shuttle's start in m, speed along the street in m/s."""
PAVEMENTS_M, WALKERS, WALKING_MPS, ROOT_M = (-9.5, 4.0, 5.0), 24, 1.3, 0.93


class Moving(NamedTuple):
    """An actor with its place at the beginning, ahead and to the right of the shuttle's, and its speeds."""

    actor: carla.Actor
    ahead_m: float
    right_m: float
    along_mps: float
    across_mps: float


def main(folder: Path) -> None:
    """Record into a new folder."""
    folder.mkdir(parents=True)
    server = OwnServer(recordings=folder)
    try:
        client = connect("127.0.0.1", server.port, 60.0)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
        world.apply_settings(settings)
        start = world.get_map().get_spawn_points()[0]
        moving = [Moving(spawned(world, 0, "vehicle.easymile.ez10", role_name="hero"), 0.0, 0.0, SPEED_MPS, 0.0)]
        moving += [Moving(spawned(world, number, car[0]), *car[1:], 0.0) for number, car in enumerate(CARS, start=1)]
        moving += list(walkers(world, random.Random(SEED)))
        client.start_recorder(str(folder / LOG_FILE), True)
        for frame in range(FRAMES):
            place(client, start, moving, frame * STEP_S)
            world.tick()
        client.stop_recorder()
        weather = {name: float(getattr(carla.WeatherParameters.ClearNoon, name)) for name in WEATHER_FIELDS}
        write_conditions(folder, Conditions(moving[0][0].id, (), (WeatherFrom(1, weather),)))
        recording = {"recording": {"file": LOG_FILE, "where": "run folder"}}
        (folder / "config.json").write_text(json.dumps(recording))
    finally:
        server.end()


def spawned(world: carla.World, number: int, model: str, **attributes: str) -> carla.Actor:
    """Return an actor without physics, far above the street."""
    blueprint = world.get_blueprint_library().find(model)
    for name, value in attributes.items():
        blueprint.set_attribute(name, value)
    waiting = carla.Location(x=20.0 * number, z=900.0)  # a place of its own for each
    actor = world.spawn_actor(blueprint, carla.Transform(waiting))
    actor.set_simulate_physics(False)
    return actor


def walkers(world: carla.World, dice: random.Random) -> Iterator[Moving]:
    """Yield walkers on the pavements, and each sixth one on its way over the street."""
    for number in range(WALKERS):
        actor = spawned(world, 1 + len(CARS) + number, f"walker.pedestrian.{1 + dice.randrange(48):04d}")
        ahead = 8.0 + 52.0 * number / WALKERS + dice.uniform(-1.0, 1.0)
        if number % 6 == 3:
            yield Moving(actor, ahead, 4.0 - dice.uniform(0.0, 6.0), 0.0, -WALKING_MPS)
        else:
            right = dice.choice(PAVEMENTS_M) + dice.uniform(-0.5, 0.5)
            yield Moving(actor, ahead, right, dice.choice((-WALKING_MPS, WALKING_MPS)), 0.0)


def place(client: carla.Client, start: carla.Transform, moving: list[Moving], t_s: float) -> None:
    """Put all actors to their places at a time."""
    ahead, right = start.get_forward_vector(), start.get_right_vector()
    commands = []
    for actor, forward_m, right_m, along, across in moving:
        at = start.location + ahead * (forward_m + along * t_s) + right * (right_m + across * t_s)
        if actor.type_id.startswith("walker."):
            at.z += ROOT_M
        turned = math.degrees(math.atan2(across, along))
        pose = carla.Transform(at, carla.Rotation(pitch=start.rotation.pitch, yaw=start.rotation.yaw + turned))
        commands.append(carla.command.ApplyTransform(actor.id, pose))
    client.apply_batch_sync(commands, False)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
