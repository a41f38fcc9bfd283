"""Claims about what only LibCarla can ask of an actor: the official Python client has no name for it."""

import math

import pytest

from fakes.simulation import FakeFrames, FakeMaps
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire.stream import StreamTable
from linden.server.rpc import actors
from linden.server.rpc.context import Context
from linden.world import World
from opendrive_texts import street_through_junction

STREET = street_through_junction()
HIGH_M = 60.0


@pytest.fixture
def context() -> Context:
    simulation = World(LoadedMap(name="street", text=STREET, **vars(derive(STREET))))
    return Context(simulation, FakeMaps(), FakeFrames(sensor_bytes=0), StreamTable(2001), lambda: 0.05)


@pytest.fixture
def slot(context: Context) -> int:
    """Slot of a car that floats, its nose to the east."""
    episode = context.world.episode
    pose = Transform(Vector3D(0.0, 500.0, HIGH_M), Rotation())
    record = context.world.spawn(ActorDescription(0, "vehicle.tesla.model3"), pose)
    episode.bodies.set_gravity(record.slot, falls=False)
    context.world.step(0.05)
    return record.slot


def actor(context: Context, slot: int) -> int:
    return context.world.episode.actors.of_slot(slot).id


def test_an_impulse_before_the_centre_turns_the_nose_with_it(context: Context, slot: int) -> None:
    bodies = context.world.episode.bodies
    mass_kg, inertia = float(bodies.mass_kg[slot]), float(bodies.state["yaw_inertia_kgm2"][slot])
    centre = bodies.position[slot] + bodies.state["centre_of_mass"][slot]
    push = Vector3D(0.0, mass_kg, 0.0)
    at = Vector3D(float(centre[0]) + 2.0, float(centre[1]), float(centre[2]))
    actors.add_actor_impulse_at_location(context, actor(context, slot), push, at)
    context.world.step(0.05)
    assert bodies.angular_velocity[slot, 2] == pytest.approx(2.0 * mass_kg / inertia, rel=0.01)


def test_a_force_at_a_point_acts_for_one_frame(context: Context, slot: int) -> None:
    bodies = context.world.episode.bodies
    centre = bodies.position[slot] + bodies.state["centre_of_mass"][slot]
    push = Vector3D(0.0, 0.0, float(bodies.mass_kg[slot]) * 10.0)
    actors.add_actor_force_at_location(context, actor(context, slot), push, Vector3D(*map(float, centre)))
    context.world.step(0.05)
    assert bodies.velocity[slot, 2] == pytest.approx(0.5, rel=0.01)
    assert bodies.angular_velocity[slot] == pytest.approx(0.0, abs=1e-6)
    context.world.step(0.05)
    assert bodies.velocity[slot, 2] == pytest.approx(0.5, rel=0.01)


def test_a_torque_is_in_kg_cm2_and_degrees(context: Context, slot: int) -> None:
    bodies = context.world.episode.bodies
    inertia = float(bodies.state["yaw_inertia_kgm2"][slot])
    actors.add_actor_torque(context, actor(context, slot), Vector3D(0.0, 0.0, 100.0 * inertia * 1e4))
    context.world.step(0.05)
    assert math.degrees(bodies.angular_velocity[slot, 2]) == pytest.approx(100.0 * 0.05, rel=0.01)
