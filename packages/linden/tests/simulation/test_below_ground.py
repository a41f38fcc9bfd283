"""Claims about actors that are hidden far below the ground."""

import numpy as np
import pytest

from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.protocol.values.space import BoundingBox, Rotation, Transform, Vector3D
from linden.simulation.below_ground import DEEP_M, BelowGround

BOX = BoundingBox(Vector3D(), Vector3D(0.3, 0.3, 0.9))


def at(z_m: float) -> Transform:
    return Transform(Vector3D(4.0, 5.0, z_m), Rotation())


@pytest.fixture
def bodies() -> Bodies:
    return Bodies()


@pytest.fixture
def buried(bodies: Bodies) -> BelowGround:
    return BelowGround(Ground.flat(100.0), bodies)


def test_an_actor_put_far_below_stays_there_until_put_up_again(bodies: Bodies, buried: BelowGround) -> None:
    slot = bodies.add_walker(at(101.0), BOX, 70.0)
    buried.arrive(slot)
    assert bodies.simulate[slot]
    bodies.set_pose(slot, at(100.0 - DEEP_M - 0.1))
    buried.settle(slot)
    assert not bodies.simulate[slot]
    bodies.set_pose(slot, at(101.0))
    buried.settle(slot)
    assert bodies.simulate[slot]


def test_an_actor_that_begins_below_gets_its_physics_when_it_is_put_up(bodies: Bodies, buried: BelowGround) -> None:
    slot = bodies.add_walker(at(-400.0), BOX, 70.0)
    buried.arrive(slot)
    assert not bodies.simulate[slot]
    buried.simulate(slot, wanted=True)  # asked for too early
    assert not bodies.simulate[slot]
    bodies.set_pose(slot, at(101.0))
    buried.settle(slot)
    assert bodies.simulate[slot]


def test_an_actor_without_physics_has_none_when_put_up(bodies: Bodies, buried: BelowGround) -> None:
    slot = bodies.add_walker(at(-400.0), BOX, 70.0)
    buried.arrive(slot)
    buried.simulate(slot, wanted=False)
    bodies.set_pose(slot, at(101.0))
    buried.settle(slot)
    assert not bodies.simulate[slot]


def test_a_slot_begins_anew_with_each_actor(bodies: Bodies, buried: BelowGround) -> None:
    first = bodies.add_walker(at(-400.0), BOX, 70.0)
    buried.arrive(first)
    bodies.remove(first)
    slot = bodies.add_walker(at(101.0), BOX, 70.0)
    bodies.set_simulate(slot, simulate=False)  # as a prop begins that does not move
    buried.arrive(slot)
    assert slot == first
    assert not bodies.simulate[slot]


def test_an_actor_on_the_ground_is_let_alone(bodies: Bodies, buried: BelowGround) -> None:
    slot = bodies.add_walker(at(100.93), BOX, 70.0)
    buried.arrive(slot)
    bodies.set_pose(slot, at(100.0 - DEEP_M + 0.1))  # deep in, not below
    buried.settle(slot)
    assert bodies.simulate[slot]
    assert np.isfinite(bodies.position[slot]).all()
