"""Claims about batches: many transforms or controls at once do what each alone does."""

import math

import msgpack
import numpy as np
import pytest

from fakes.simulation import FakeFrames, FakeMaps
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire import commands as cmd
from linden.protocol.wire.controls import Controls, Transforms
from linden.protocol.wire.rpc import Packed
from linden.protocol.wire.stream import StreamTable
from linden.server.rpc.actors import set_actor_transform
from linden.server.rpc.batch import apply_batch
from linden.server.rpc.context import Context
from linden.server.rpc.vehicles import apply_control_to_vehicle, get_vehicle_light_states, set_light_bits
from linden.world import World
from opendrive_texts import street_through_junction

STREET = street_through_junction()
SEED = 11


def crowd() -> tuple[Context, list[int]]:
    """A car, a walker and a prop for each of six places, and the ids of all."""
    simulation = World(LoadedMap(name="street", text=STREET, **vars(derive(STREET))))
    kinds = ("vehicle.tesla.model3", "walker.pedestrian.0001", "static.prop.trafficcone01")
    ids = []
    for place in range(18):
        pose = Transform(Vector3D(12.0 * place, 300.0, 1.0), Rotation())
        ids.append(simulation.spawn(ActorDescription(0, kinds[place % 3]), pose).id)
    context = Context(simulation, FakeMaps(), FakeFrames(sensor_bytes=0), StreamTable(2001), lambda: 0.05)
    for _ in range(3):
        simulation.step(0.05)
    return context, ids


def places(count: int) -> list[tuple[float, ...]]:
    """Places at random; some lie far below the ground, some angles beyond a turn."""
    chance = np.random.default_rng(SEED)
    found = chance.uniform((-80.0, 200.0, -40.0, -720.0, -720.0, -720.0), (80.0, 400.0, 5.0, 720.0, 720.0, 720.0))
    rows = [tuple(chance.permuted(found).tolist()) for _ in range(count)]
    return [*rows[:-1], (1e9, -1e9, 0.0, 180.0, -180.0, 540.5)]


def test_many_transforms_at_once_do_what_each_alone_does() -> None:
    (together, ids), (alone, same_ids) = crowd(), crowd()
    assert ids == same_ids
    rows = places(len(ids))
    answers = apply_batch(together, (Transforms(tuple(ids), tuple(rows)),), False)
    assert answers == [cmd.done(actor_id) for actor_id in ids]
    for actor_id, row in zip(ids, rows, strict=True):
        set_actor_transform(alone, actor_id, Transform(Vector3D(*row[:3]), Rotation(*row[3:])))
    ours, theirs = (context.world.episode.bodies.state for context in (together, alone))
    for name in ours.dtype.names:
        np.testing.assert_array_equal(ours[name], theirs[name], err_msg=name)


def test_an_actor_that_is_gone_fails_alone() -> None:
    context, ids = crowd()
    row = (1.0, 300.0, 1.0, 0.0, 0.0, 0.0)
    answers = apply_batch(context, (Transforms((ids[0], 9999, ids[1]), (row, row, row)),), False)
    assert [status for ((status, _),) in answers] == [1, 0, 1]


def test_of_two_transforms_of_one_actor_the_last_holds() -> None:
    context, ids = crowd()
    rows = ((1.0, 300.0, 1.0, 0.0, 0.0, 0.0), (2.0, 310.0, 1.0, 0.0, 90.0, 0.0))
    apply_batch(context, (Transforms((ids[0], ids[0]), rows),), False)
    bodies, slot = context.world.episode.bodies, context.world.episode.actors.get(ids[0]).slot
    assert bodies.position[slot].tolist() == [2.0, 310.0, 1.0]
    assert bodies.rotation[slot, 1] == pytest.approx(math.pi / 2.0)


CONTROLS = [
    [0.5, -0.25, 0.0, 0.0, 0.0, 0.0, 0.0],
    [9.0, 7.0, 3.0, 1.0, 1.0, 1.0, 400.0],
    [-9.0, -7.0, -3.0, 0.0, 1.0, 0.0, -7.0],
    [0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0],
    [1.0, 1.0, 0.1, 0.0, 0.0, 0.0, 1.0],
    [0.3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
]


def test_many_controls_at_once_do_what_each_alone_does() -> None:
    (together, ids), (alone, _) = crowd(), crowd()
    cars = ids[::3]
    answers = apply_batch(together, (Controls(np.array(cars, np.int64), np.array(CONTROLS)),), False)
    assert isinstance(answers, Packed)
    assert msgpack.unpackb(answers) == [[[1, actor_id]] for actor_id in cars]
    for actor_id, row in zip(cars, CONTROLS, strict=True):
        control = VehicleControl(*row[:3], *map(bool, row[3:6]), int(row[6]))
        apply_control_to_vehicle(alone, actor_id, control)
    ours, theirs = (context.world.episode.bodies.state for context in (together, alone))
    for name in ours.dtype.names:
        np.testing.assert_array_equal(ours[name], theirs[name], err_msg=name)


def test_a_control_for_a_vehicle_that_is_gone_fails_alone() -> None:
    context, ids = crowd()
    controls = Controls(np.array([ids[0], 9999, ids[3]], np.int64), np.array(CONTROLS[:3]))
    answers = apply_batch(context, (controls,), False)
    assert not isinstance(answers, Packed)
    assert [status for ((status, _),) in answers] == [1, 0, 1]
    assert context.world.episode.bodies.throttle[context.world.episode.vehicle(ids[0])] == 0.5


def test_the_lamps_that_a_client_reads_are_those_of_the_moment() -> None:
    context, ids = crowd()
    assert msgpack.unpackb(get_vehicle_light_states(context)) == [[actor_id, 0] for actor_id in ids[::3]]
    set_light_bits(context, ids[3], 5)
    assert msgpack.unpackb(get_vehicle_light_states(context))[1] == [ids[3], 5]
    context.world.destroy(ids[0])
    assert msgpack.unpackb(get_vehicle_light_states(context))[0] == [ids[3], 5]
