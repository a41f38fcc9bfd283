"""Makes the pictures of docs/sensors.md: what cameras see from the shuttle's seat, through the official client.

    python scripts/sensor_pictures.py [--folder docs/images]

Starts a server, puts the shuttle at five places of the LEAP route among parked and moving vehicles and people, and
writes one sheet of colour pictures (places by weathers) and one of everything else that cameras can show.
"""

import argparse
import queue
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET

import carla
import matplotlib.image
import numpy as np
from numpy.typing import NDArray

ROUTE = Path("src/basu/routes/linden_leap.xml")
PLACES = (0.02, 0.2, 0.42, 0.63, 0.85)  # of the route's points
SEAT = carla.Transform(carla.Location(x=1.5, z=1.9), carla.Rotation(pitch=-4.0))
WEATHERS = {
    "clear noon": carla.WeatherParameters.ClearNoon,
    "clear sunset": carla.WeatherParameters.ClearSunset,
    "rain": carla.WeatherParameters.HardRainNoon,
    "fog": carla.WeatherParameters(cloudiness=60.0, sun_altitude_angle=40.0, fog_density=55.0, fog_falloff=0.1),
    "night": carla.WeatherParameters.ClearNight,
}
OTHERS = ("depth", "semantic_segmentation", "instance_segmentation", "normals", "optical_flow")
LIT = carla.VehicleLightState(carla.VehicleLightState.Position | carla.VehicleLightState.LowBeam)
WIDTH, HEIGHT = 400, 300
Picture = NDArray[np.uint8]


class Stage(NamedTuple):
    """A world with the shuttle and others in it."""

    world: carla.World
    shuttle: carla.Vehicle
    others: list[carla.Vehicle]


def poses(town: carla.Map) -> list[carla.Transform]:
    """Return the five places on the route, in their lanes."""
    points = [point.attrib for point in ET.parse(ROUTE).iter("position")]
    found = []
    for share in PLACES:
        at = points[int(share * len(points))]
        lane = town.get_waypoint(carla.Location(*(float(at[axis]) for axis in "xyz")))
        found.append(lane.transform)
    return found


def furnish(world: carla.World, client: carla.Client) -> Stage:
    """Spawn the shuttle, vehicles and people, the same ones every time."""
    library = world.get_blueprint_library()
    points = world.get_map().get_spawn_points()
    ez10 = library.find("vehicle.easymile.ez10")
    shuttle = world.spawn_actor(ez10, points[0])
    shuttle.set_simulate_physics(False)
    cars = [item for item in library.filter("vehicle.*") if item.id != ez10.id]
    batch = [
        carla.command.SpawnActor(cars[number % len(cars)], point) for number, point in enumerate(points[5::9][:120])
    ]
    for place in poses(world.get_map()):  # somebody ahead at each of them
        ahead = world.get_map().get_waypoint(place.location).next(18.0)[0].transform
        ahead.location.z += 0.3
        batch.append(carla.command.SpawnActor(cars[len(batch) % len(cars)], ahead))
    people = library.filter("walker.pedestrian.*")
    for number in range(80):
        place = world.get_random_location_from_navigation()
        if place is not None:
            place.z += 1.0
            batch.append(carla.command.SpawnActor(people[number % len(people)], carla.Transform(place)))
    ids = [answer.actor_id for answer in client.apply_batch_sync(batch, True) if not answer.error]
    others = [actor for actor in world.get_actors(ids) if actor.type_id.startswith("vehicle.")]
    return Stage(world, shuttle, others)


def picture(stage: Stage, kind: str) -> Picture:
    """Return one picture (height, width, 3) as people look at it."""
    blueprint = stage.world.get_blueprint_library().find(f"sensor.camera.{kind}")
    for name, value in (("image_size_x", WIDTH), ("image_size_y", HEIGHT)):
        blueprint.set_attribute(name, str(value))
    sensor = stage.world.spawn_actor(blueprint, SEAT, attach_to=stage.shuttle)
    arrived: queue.Queue[Picture] = queue.Queue()
    sensor.listen(lambda image: arrived.put(shown(kind, image)))
    try:
        for turn in range(20):
            if kind == "optical_flow":  # drive, for there to be any
                pose = stage.shuttle.get_transform()
                pose.location += 0.4 * pose.get_forward_vector()
                stage.shuttle.set_transform(pose)
            stage.world.tick()
            try:
                found = arrived.get(timeout=1.0)
                if turn:  # in a camera's first frame nothing has moved yet
                    return found
            except queue.Empty:
                continue
        raise SystemExit(f"no picture of {kind} has come")
    finally:
        sensor.stop()
        for _ in range(3):
            stage.world.tick()
        sensor.destroy()


def shown(kind: str, image: carla.SensorData) -> Picture:
    """Return an image in the colours that people look at."""
    if kind == "depth":
        image.convert(carla.ColorConverter.LogarithmicDepth)
    if kind == "semantic_segmentation":
        image.convert(carla.ColorConverter.CityScapesPalette)
    if kind == "optical_flow":
        image = image.get_color_coded_flow()
    pixels = np.frombuffer(image.raw_data, np.uint8).reshape(HEIGHT, WIDTH, 4)[:, :, 2::-1]
    if kind == "instance_segmentation":  # each id a colour of its own
        number = pixels.astype(np.int64) @ (65536, 1, 256)  # the tag is red
        return np.stack([(number * step) % 251 for step in (97, 57, 143)], axis=2).astype(np.uint8)
    return pixels.copy()


def make(stage: Stage, folder: Path) -> None:
    """Write both sheets."""
    rows, last = [], []
    for place in poses(stage.world.get_map()):
        stage.shuttle.set_transform(place)
        row = []
        for weather in WEATHERS.values():
            stage.world.set_weather(weather)
            dark = weather.sun_altitude_angle < 0.0
            for car in (stage.shuttle, *stage.others):
                car.set_light_state(LIT if dark else carla.VehicleLightState.NONE)
            row.append(picture(stage, "rgb"))
        rows.append(np.concatenate(row, axis=1))
        if not last:
            stage.world.set_weather(carla.WeatherParameters.ClearNoon)
            last = [row[0], *(picture(stage, kind) for kind in OTHERS)]
    save(folder / "cameras-weather.jpg", np.concatenate(rows))
    save(folder / "cameras-kinds.jpg", np.concatenate([np.concatenate(last[:3], 1), np.concatenate(last[3:], 1)]))


def save(path: Path, sheet: Picture) -> None:
    """Write a sheet, small enough for a repository."""
    matplotlib.image.imsave(path, sheet, pil_kwargs={"quality": 88})
    print(f"{path}: {sheet.shape[1]} x {sheet.shape[0]}")


def main() -> None:
    """Start a server, make the sheets, end it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("docs/images"))
    folder = parser.parse_args().folder
    server = subprocess.Popen(
        [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--sync"], stdout=subprocess.PIPE, text=True
    )
    try:
        ready = next((line for line in server.stdout or () if line.startswith("linden: ready")), None)
        if ready is None:
            raise SystemExit("the server ended before it was ready")
        client = carla.Client("127.0.0.1", int(re.findall(r"port (\d+)", ready)[0]))
        client.set_timeout(120.0)
        make(furnish(client.get_world(), client), folder)
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    main()
