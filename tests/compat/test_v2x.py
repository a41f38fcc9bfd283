"""Messages between vehicles through the official client, which judges their bytes."""

import queue
from typing import Any

import carla

from spawn_points import spawn_point


def radio(world: carla.World, car: carla.Actor, name: str = "v2x", **attributes: str) -> "tuple[Any, queue.Queue[Any]]":
    blueprint = world.get_blueprint_library().find(f"sensor.other.{name}")
    for key, value in attributes.items():
        blueprint.set_attribute(key, value)
    sensor = world.spawn_actor(blueprint, carla.Transform(carla.Location(z=2.0)), attach_to=car)
    events: queue.Queue[Any] = queue.Queue()
    sensor.listen(events.put)
    return sensor, events


def car_at(world: carla.World, point: carla.Transform, name: str = "vehicle.tesla.model3") -> carla.Actor:
    return world.spawn_actor(world.get_blueprint_library().find(name), point)


def ahead(point: carla.Transform, distance_m: float) -> carla.Transform:
    location = point.location + point.get_forward_vector() * distance_m
    return carla.Transform(carla.Location(location.x, location.y, location.z + 0.2), point.rotation)


def test_a_vehicle_hears_what_another_tells_of_itself(world) -> None:
    point = spawn_point(world, 100)
    listener, speaker = car_at(world, point), car_at(world, ahead(point, 12.0), "vehicle.easymile.ez10")
    sensor, events = radio(world, listener)
    voice, _ = radio(world, speaker)
    for _ in range(30):
        world.tick()
    event = events.get(timeout=10.0)
    assert isinstance(event, carla.CAMEvent)
    assert event.get_message_count() == len(event) == 1
    message = event[0].get()["Message"]
    assert message["Header"] == {"Protocol Version": 2, "Message ID": "CAM", "Station ID": speaker.id}
    assert event[0].power == event[0].get()["Power"]
    sensor.stop()
    voice.stop()
