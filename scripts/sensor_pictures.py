"""Make the pictures of what sensors see from the shuttle, for docs/reference/cameras.md and docs/how-to/pointcloud.md.

    python scripts/sensor_pictures.py [--folder docs/images]

Starts a server, puts the shuttle at five places of the LEAP route among vehicles and people, and writes a sheet of
colour pictures (places by weathers), one of everything else that cameras can show, and a lidar's sweep from above.
"""

import argparse
import queue
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET

import carla
import matplotlib.image
import numpy as np
from numpy.typing import NDArray

ROUTE = Path("packages/basu/src/basu/routes/linden_leap.xml")
PLACES = (0.125, 0.375, 0.725, 0.775, 0.925)  # of the route's points: streets of both widths, a roundabout
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
WIDTH, HEIGHT = 480, 300
SWEEP_PIXELS, SWEEP_M = 1000, 55.0
ROOF = carla.Transform(carla.Location(x=0.0, z=3.7))  # high enough to look past the roof's edges
POINT = np.dtype([(name, "<f4") for name in ("x", "y", "z", "cos")] + [("object", "<u4"), ("tag", "<u4")])
BACKGROUND = np.array([14, 16, 20])
_TAGS = {  # of carla.CityObjectLabel, bright enough for a dark ground
    "Roads": (120, 90, 130), "Sidewalks": (225, 80, 190), "Buildings": (235, 150, 80), "Walls": (150, 150, 200),
    "Fences": (200, 150, 140), "Poles": (190, 190, 190), "TrafficLight": (255, 190, 40), "TrafficSigns": (250, 240, 60),
    "Vegetation": (90, 180, 60), "Terrain": (60, 120, 70), "Pedestrians": (255, 60, 90), "Car": (80, 150, 255),
    "Truck": (60, 110, 220), "Bus": (80, 200, 255), "RoadLines": (255, 255, 255),
}  # fmt: skip
COLOURS = np.full((32, 3), 150)
for _name, _colour in _TAGS.items():
    COLOURS[int(getattr(carla.CityObjectLabel, _name))] = _colour
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
    cars = painted([item for item in library.filter("vehicle.*") if item.id != ez10.id])
    people = library.filter("walker.pedestrian.*")
    batch = [carla.command.SpawnActor(next(cars), point) for point in points[5::9][:120]]
    for number, place in enumerate(poses(world.get_map())):  # company at each of them
        lane = world.get_map().get_waypoint(place.location)
        batch += [carla.command.SpawnActor(next(cars), pose) for pose in before(lane)]
        batch += [
            carla.command.SpawnActor(people[(7 * number + nth) % len(people)], pose)
            for nth, pose in enumerate(beside(lane))
        ]
    ids = [answer.actor_id for answer in client.apply_batch_sync(batch, True) if not answer.error]
    others = [actor for actor in world.get_actors(ids) if actor.type_id.startswith("vehicle.")]
    return Stage(world, shuttle, others)


def painted(cars: list[carla.ActorBlueprint]) -> Iterator[carla.ActorBlueprint]:
    """Give the blueprints in turn, for ever, each time in another of their colours."""
    for turn in count():
        for number, car in enumerate(cars):
            if car.has_attribute("color"):
                colours = car.get_attribute("color").recommended_values
                car.set_attribute("color", colours[(turn + number) % len(colours)])
            yield car


def before(lane: carla.Waypoint) -> list[carla.Transform]:
    """Return a place in the same lane ahead, and one in the opposite lane where there is one."""
    ahead = lane.next(22.0)[0]
    found = [ahead.transform]
    across = lane.next(13.0)[0].get_left_lane()
    if across is not None and across.lane_type == carla.LaneType.Driving:
        found.append(across.transform)
    for pose in found:
        pose.location.z += 0.3
    return found


def beside(lane: carla.Waypoint) -> list[carla.Transform]:
    """Return places on the pavements ahead, some looking this way and some the other."""
    found = []
    for number, ahead_m in enumerate((9.0, 12.0, 16.0, 24.0, 30.0)):
        side = lane.next(ahead_m)[0]
        while side is not None and side.lane_type != carla.LaneType.Sidewalk:
            side = side.get_right_lane() if number % 3 < 2 else _outwards(side, lane)
        if side is not None:
            pose = side.transform
            pose.rotation.yaw += 180.0 * (number % 2)
            pose.location.z += 1.0
            found.append(pose)
    return found


def _outwards(side: carla.Waypoint, lane: carla.Waypoint) -> carla.Waypoint | None:
    """Return the next lane to the left as who drives in ``lane`` sees it; lanes past the middle look the other way."""
    return side.get_left_lane() if side.lane_id * lane.lane_id > 0 else side.get_right_lane()


def picture(stage: Stage, kind: str) -> Picture:
    """Return one picture (height, width, 3) as people look at it."""
    size = {"image_size_x": str(WIDTH), "image_size_y": str(HEIGHT)}
    return measured(stage, f"sensor.camera.{kind}", size, lambda image: shown(kind, image))


def sweep(stage: Stage) -> Picture:
    """Return a whole turn of a lidar on the roof, from above: each point in the colour of what it is part of."""
    chosen = {"channels": 64, "range": 100, "rotation_frequency": 20, "points_per_second": 64 * 2000 * 20}
    angles = {"upper_fov": 10, "lower_fov": -25}
    attributes = {name: str(value) for name, value in {**chosen, **angles}.items()}
    return measured(stage, "sensor.lidar.ray_cast_semantic", attributes, from_above)


def from_above(points: carla.SemanticLidarMeasurement) -> Picture:
    """Return the points of a sweep, ahead being up."""
    columns = np.frombuffer(points.raw_data, POINT)
    place = np.stack([-columns["x"], columns["y"]], axis=1) * (SWEEP_PIXELS / (2.0 * SWEEP_M)) + SWEEP_PIXELS / 2.0
    inside = ((place >= 0.0) & (place < SWEEP_PIXELS)).all(axis=1)
    row, column = place[inside].astype(np.int64).T
    light = np.zeros((SWEEP_PIXELS, SWEEP_PIXELS, 3))
    order = np.argsort(columns["z"][inside], kind="stable")  # what is higher covers what is lower
    tint = COLOURS[np.minimum(columns["tag"][inside][order], len(COLOURS) - 1)]
    for down in (0, 1):  # two pixels wide and high, to be seen
        for right in (0, 1):
            at = np.minimum(row[order] + down, SWEEP_PIXELS - 1), np.minimum(column[order] + right, SWEEP_PIXELS - 1)
            light[at] = tint
    return np.where(light.any(axis=2, keepdims=True), light, BACKGROUND).astype(np.uint8)


def measured(
    stage: Stage, kind: str, attributes: dict[str, str], look: Callable[[carla.SensorData], Picture]
) -> Picture:
    """Return what a sensor on the shuttle measures, as a picture."""
    blueprint = stage.world.get_blueprint_library().find(kind)
    for name, value in attributes.items():
        blueprint.set_attribute(name, value)
    place = ROOF if "lidar" in kind else SEAT
    sensor = stage.world.spawn_actor(blueprint, place, attach_to=stage.shuttle)
    arrived: queue.Queue[Picture] = queue.Queue()
    sensor.listen(lambda data: arrived.put(look(data)))
    try:
        for turn in range(20):
            if kind.endswith("optical_flow"):  # drive, for there to be any
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
        raise SystemExit(f"nothing has come of {kind}")
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
            save(folder / "lidar-sweep.jpg", sweep(stage))
    save(folder / "cameras-weather.jpg", np.concatenate(rows))
    save(folder / "cameras-kinds.jpg", np.concatenate([np.concatenate(last[:3], 1), np.concatenate(last[3:], 1)]))


def save(path: Path, sheet: Picture) -> None:
    """Write a sheet, small enough for a repository."""
    matplotlib.image.imsave(path, sheet, pil_kwargs={"quality": 86, "optimize": True})
    print(f"{path}: {sheet.shape[1]} x {sheet.shape[0]}")


def main() -> None:
    """Start a server, make the sheets, end it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("docs/images"))
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
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
