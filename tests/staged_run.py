"""A recorded run with few actors at known places: the vehicle under test, two cars in a row, a walker, a cone."""

import json
from pathlib import Path

import carla

from basu.agents.sensor_file import parse_sensors
from basu.managers.recorded_conditions import Conditions, WeatherFrom, write_conditions
from basu.records.recording_files import LOG_FILE
from basu.routing.weather import WEATHER_FIELDS
from basu.simulator import OwnServer, connect

STEP_S, FRAMES = 0.05, 4
AHEAD_M = {"near": 14.0, "far": 24.0}
CAMERA = {"type": "sensor.camera.rgb", "id": "FRONT", "x": 2.5, "z": 2.0, "width": 320, "height": 200, "fov": 90}
LIDAR = {
    "type": "sensor.lidar.ray_cast",
    "id": "TOP",
    "z": 3.0,
    "channels": 32,
    "range": 60,
    "rotation_frequency": 20,
    "points_per_second": 320000,
    "upper_fov": 5,
    "lower_fov": -25,
}
WALKING_MPS = 1.5


def stage(folder: Path) -> None:
    """Record the run into a folder that is there."""
    server = OwnServer(recordings=folder)
    try:
        client = connect("127.0.0.1", server.port, 60.0)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
        world.apply_settings(settings)
        place = world.get_map().get_spawn_points()[0]
        ahead, right = place.get_forward_vector(), place.get_right_vector()
        hero = _spawn(world, "vehicle.easymile.ez10", place, 0.0, 0.0, role_name="hero")
        _spawn(world, "vehicle.audi.a2", place, AHEAD_M["near"], 0.0)
        _spawn(world, "vehicle.audi.a2", place, AHEAD_M["far"], 0.8)
        walker = _spawn(world, "walker.pedestrian.0004", place, 10.0, 4.0)
        _spawn(world, "static.prop.trafficcone01", place, 9.0, -2.5)
        client.start_recorder(str(folder / LOG_FILE), True)
        for step in range(FRAMES):
            at = place.location + right * 3.0 + ahead * (10.0 + WALKING_MPS * STEP_S * step)
            walker.set_transform(carla.Transform(at + carla.Location(z=0.93), place.rotation))
            world.tick()
        client.stop_recorder()
        weather = carla.WeatherParameters.HardRainNoon
        values = {name: float(getattr(weather, name)) for name in WEATHER_FIELDS}
        clear = {name: float(getattr(carla.WeatherParameters.ClearNoon, name)) for name in WEATHER_FIELDS}
        marks = WeatherFrom(1, clear), WeatherFrom(3, values)
        write_conditions(folder, Conditions(hero.id, parse_sensors([CAMERA, LIDAR], "test"), marks))
        (folder / "config.json").write_text(json.dumps({"recording": {"file": LOG_FILE, "where": "run folder"}}))
    finally:
        server.end()


def _spawn(
    world: carla.World, model: str, place: carla.Transform, ahead_m: float, right_m: float, **attributes: str
) -> carla.Actor:
    """Spawn an actor without physics at a place before and beside another one."""
    blueprint = world.get_blueprint_library().find(model)
    for name, value in attributes.items():
        blueprint.set_attribute(name, value)
    at = place.location + place.get_forward_vector() * ahead_m + place.get_right_vector() * right_m
    if model.startswith("walker."):
        at.z += 0.93
    actor = world.spawn_actor(blueprint, carla.Transform(at + carla.Location(z=50.0), place.rotation))
    if not model.startswith("static."):
        actor.set_simulate_physics(False)
    actor.set_transform(carla.Transform(at, place.rotation))
    return actor
