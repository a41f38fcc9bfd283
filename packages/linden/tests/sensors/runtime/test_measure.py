"""Sensors feel what carries them, however many links away it is."""

import math

import pytest

from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform, Vector3D
from linden.sensors.devices.collision import Collision
from linden.sensors.devices.imu import ImuMeasurement
from linden.world import World
from opendrive_texts import street_through_junction

DT_S = 0.05
TEXT = street_through_junction()
MAP = LoadedMap(name="street", text=TEXT, **vars(derive(TEXT)))


@pytest.fixture
def simulation() -> World:
    return World(MAP)


@pytest.mark.parametrize("links", [0, 1, 3])
def test_a_gyroscope_on_a_thing_on_a_car_turns_with_the_car(simulation: World, links: int) -> None:
    car = simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), Transform(Vector3D(20.0, 1.75, 1.0)))
    bearer = car
    for _ in range(links):
        bearer = simulation.spawn(ActorDescription(0, "static.prop.box01"), Transform(), parent_id=bearer.id)
    imu = simulation.spawn(ActorDescription(0, "sensor.other.imu"), Transform(), parent_id=bearer.id)
    bump = simulation.spawn(ActorDescription(0, "sensor.other.collision"), Transform(), parent_id=bearer.id)
    simulation.step(DT_S)
    simulation.episode.bodies.set_target_angular_velocity(car.slot, Vector3D(0.0, 0.0, math.radians(30.0)))
    simulation.spawn(ActorDescription(0, "static.prop.streetbarrier"), Transform(Vector3D(22.5, 1.75, 0.2)))
    felt, bumped = [], False
    for _ in range(5):
        simulation.step(DT_S)
        readings = [found.reading for found in simulation.measure({imu.stream_id, bump.stream_id})]
        felt += [reading.gyroscope.z for reading in readings if isinstance(reading, ImuMeasurement)]
        bumped |= any(isinstance(reading, Collision) for reading in readings)
    assert max(map(abs, felt)) > 0.01
    assert bumped
