"""Rows of sensors.py measured in the server itself: a step of the world and the messages of its sensors, no client.

Imports nothing of the official client, which not every Python has.
"""

import statistics
import time
from collections.abc import Iterator

from sensor_rows import CAR, OTHERS, THROTTLE, Figures, Row, Sensor

from linden.maps.cache import MapCache
from linden.maps.library import HOME_MAP, MapLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.map_mesh_cache import standing_of
from linden.sensors.casting.choose import check_device
from linden.server import frames
from linden.world import World

WARM_UP = 3


def town(device: str) -> World:
    """Return Linden, nobody in it, its sensors on a device."""
    check_device(device)
    cache = MapCache.of_user()
    simulation = World(MapLibrary((), cache.read).load(HOME_MAP), EpisodeSettings(True))
    simulation.sensor_scene.device = device
    simulation.sensor_scene.standing_on = lambda world_map, scene: standing_of(world_map, scene, cache)
    return simulation


def populate(simulation: World, row: Row, vehicles: int) -> set[int]:
    """Begin an episode with a car, others around it, all on their way; returns the streams of the car's sensors."""
    episode = simulation.episode
    simulation.load(episode.map, reset_settings=False)
    points = simulation.spawn_points
    car = simulation.spawn(ActorDescription(0, CAR), points[0])
    slots = [car.slot]
    for number in range(vehicles):
        model = ActorDescription(0, OTHERS[number % len(OTHERS)])
        slots.append(simulation.spawn(model, points[3 * number + 3]).slot)
    for slot in slots:
        simulation.episode.bodies.set_control(slot, VehicleControl(throttle=THROTTLE))
    return {attached(simulation, sensor, car.id) for sensor in row.sensors}


def attached(simulation: World, sensor: Sensor, car_id: int) -> int:
    """Attach a sensor to the car and return its stream."""
    types = {item.id: item.type for item in simulation.library.find(sensor.blueprint).definition.attributes}
    values = tuple(AttributeValue(key, types[key], value) for key, value in sensor.chosen.items())
    place = Transform(Vector3D(sensor.x_m, 0.0, sensor.z_m), Rotation(0.0, sensor.yaw_deg, 0.0))
    return simulation.spawn(ActorDescription(0, sensor.blueprint, values), place, parent_id=car_id).stream_id


def measured(device: str, rows: tuple[Row, ...], vehicles: int, frame_count: int) -> Iterator[tuple[Row, Figures]]:
    """Measure each row: medians over the frames."""
    simulation = town(device)
    for row in rows:
        listened = populate(simulation, row, vehicles)
        wall_ms, used_ms, sent = [], [], 0
        for number in range(WARM_UP + frame_count):
            wall_s, used_s = time.perf_counter(), time.process_time()
            simulation.step(row.step_s)
            sent = sum(len(payload) for _, payload in frames.sensor_payloads(simulation, simulation.measure(listened)))
            if number >= WARM_UP:
                wall_ms.append(1000.0 * (time.perf_counter() - wall_s))
                used_ms.append(1000.0 * (time.process_time() - used_s))
        yield row, Figures(statistics.median(wall_ms), statistics.median(used_ms), sent / 2**20)
