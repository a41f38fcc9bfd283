"""Walkers go where they are told, on what they can step onto."""

import math

import numpy as np
import pytest

from fleet import BOX, FLAT, NOTHING, OFFSETS, at, run, slick, slow_uncompiled, wall
from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.space import BoundingBox, Vector3D

BODY = BoundingBox(Vector3D(), Vector3D(0.188, 0.188, 0.93))


def pedestrian(z: float = 0.93) -> tuple[Bodies, int]:
    bodies = Bodies()
    return bodies, bodies.add_walker(at(z=z), BODY, 75.0)


def kerb(height_m: float) -> Ground:
    low = [(x, y, 0.0) for x in (-10.0, 3.0) for y in (-10.0, 10.0)]
    high = [(x, y, height_m) for x in (3.0, 20.0) for y in (-10.0, 10.0)]
    return Ground.from_triangles(low + high, [(0, 1, 2), (1, 3, 2), (4, 5, 6), (5, 7, 6)])


def test_a_walker_walks_at_the_speed_and_in_the_direction_told() -> None:
    bodies, who = pedestrian()
    bodies.set_walker_control(who, WalkerControl(Vector3D(0.6, 0.8, 0.0), 1.4))
    run(bodies, 1.0)
    start = bodies.position[who].copy()
    run(bodies, 2.0)
    assert bodies.position[who] - start == pytest.approx((1.4 * 0.6 * 2.0, 1.4 * 0.8 * 2.0, 0.0), abs=1e-6)
    assert bodies.position[who, 2] == pytest.approx(0.93)
    assert bodies.rotation[who, 1] == pytest.approx(math.atan2(0.8, 0.6))
    assert bodies.walker_control(who).speed == pytest.approx(1.4)
    bodies.set_walker_control(who, WalkerControl())
    run(bodies, 1.0)
    assert not bodies.velocity[who].any()


def test_a_kerb_is_climbed_and_a_wall_is_not() -> None:
    for height_m, climbed in ((0.15, True), (0.4, True), (1.0, False)):
        bodies, who = pedestrian()
        bodies.set_walker_control(who, WalkerControl(Vector3D(1.0, 0.0, 0.0), 1.4))
        run(bodies, 4.0, ground=kerb(height_m))
        assert bodies.position[who, 2] == pytest.approx(0.93 + (height_m if climbed else 0.0), abs=1e-6)


@slow_uncompiled
def test_a_building_stops_a_walker() -> None:
    bodies, who = pedestrian()
    bodies.set_walker_control(who, WalkerControl(Vector3D(1.0, 0.0, 0.0), 2.0))
    run(bodies, 6.0, statics=wall(5.0))
    assert bodies.position[who, 0] == pytest.approx(4.5 - 0.188, abs=0.03)


def test_a_jump_rises_by_v_squared_over_two_g_once() -> None:
    bodies, who = pedestrian()
    run(bodies, 0.1)
    bodies.set_walker_control(who, WalkerControl(speed=0.0, jump=True))
    heights = []
    for _ in range(300):
        run(bodies, 0.01)
        heights.append(float(bodies.position[who, 2]))
    assert max(heights) - 0.93 == pytest.approx(4.2**2 / (2.0 * 9.81), rel=0.02)
    assert heights[-1] == pytest.approx(0.93)
    assert np.argmax(heights) < 60


def test_a_walker_spawned_high_falls_onto_its_feet() -> None:
    bodies, who = pedestrian(z=3.0)
    run(bodies, 2.0)
    assert bodies.position[who, 2] == pytest.approx(0.93)


@slow_uncompiled
def test_a_walker_is_pushed_by_a_car_and_hardly_slows_it() -> None:
    bodies, who = pedestrian()
    car = bodies.add_vehicle(slick(), at(x=-6.0), BOX, OFFSETS)
    bodies.set_control(car, VehicleControl(manual_gear_shift=True, gear=0))
    bodies.set_target_velocity(car, (8.0, 0.0, 0.0))
    run(bodies, 1.0, statics=NOTHING, ground=FLAT)
    assert bodies.velocity[car, 0] > 6.5
    assert bodies.position[who, 0] > bodies.position[car, 0] + BOX.extent.x
