"""Who touches whom, and what follows: boxes against polygons, pairs against all pairs, impulses against laws."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fleet import BOX, FLAT, NOTHING, OFFSETS, at, one, run, sedan, seeds, slick, slope, slow_uncompiled, wall
from linden.physics.bodies import Bodies
from linden.physics.contact.boxes import overlap
from linden.physics.contact.pairs import find_pairs
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.physics.step import CONTACT, advance, step
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import BoundingBox, Vector3D
from naive.physics import near_pairs, shared_area

NEUTRAL = VehicleControl(manual_gear_shift=True, gear=0)


def box(x: float, y: float, yaw: float, half_x: float, half_y: float) -> np.ndarray:
    return np.array([x, y, math.cos(yaw), math.sin(yaw), half_x, half_y, 0.0, 1.0])


place = st.floats(-4.0, 4.0)
half = st.floats(0.1, 3.0)
boxes = st.builds(box, place, place, st.floats(-4.0, 4.0), half, half)


@settings(max_examples=20 if numba.config.DISABLE_JIT else 300, deadline=None)
@given(boxes, boxes)
def test_boxes_overlap_where_their_polygons_share_an_area(a: np.ndarray, b: np.ndarray) -> None:
    depth, normal_x, normal_y, _, _ = overlap(a, b)
    area = shared_area(a, b)
    if area > 1e-6:
        assert depth > 0.0
    if depth > 1e-6:
        assert area > 0.0
        assert math.hypot(normal_x, normal_y) == pytest.approx(1.0)
        parted = a.copy()
        parted[0] += (depth + 1e-6) * normal_x
        parted[1] += (depth + 1e-6) * normal_y
        assert shared_area(parted, b) == pytest.approx(0.0, abs=1e-5)


def test_the_contact_point_of_two_faces_is_the_middle_of_what_they_share() -> None:
    depth, normal_x, normal_y, x, y = overlap(box(0.0, 0.0, 0.0, 1.0, 1.0), box(1.9, 1.0, 0.0, 1.0, 1.0))
    assert (depth, normal_x, normal_y) == (pytest.approx(0.1), -1.0, 0.0)
    assert (x, y) == (pytest.approx(0.95), pytest.approx(0.5))


def test_what_is_above_does_not_touch() -> None:
    high = box(0.0, 0.0, 0.0, 1.0, 1.0)
    high[6:] = 1.0, 2.0
    assert overlap(box(0.0, 0.0, 0.0, 1.0, 1.0), high)[0] == 0.0


def scattered(seed: int, count: int) -> Bodies:
    rng = np.random.default_rng(seed)
    bodies = Bodies()
    for k in range(count):
        x, y = rng.uniform(-40.0, 40.0, 2)
        size = rng.choice([0.2, 1.0, 3.0, 60.0 if k % 17 == 0 else 2.0])
        extent = Vector3D(size, 0.5 * size, 1.0)
        bodies.add_prop(at(x, y), BoundingBox(Vector3D(0.0, 0.0, 1.0), extent), 10.0 if rng.random() < 0.7 else None)
    return bodies


@pytest.mark.parametrize("seed", seeds(8))
def test_the_grid_finds_the_pairs_that_all_against_all_finds(seed: int) -> None:
    bodies = scattered(seed, 60)
    s = bodies.state[: bodies.count]
    radius = np.hypot(s["half_extent"][:, 0], s["half_extent"][:, 1])
    moving = radius + 0.5 * 20.0 * 0.05**2 + 0.2
    radius = np.where(s["immovable"], radius, moving)
    circles = list(zip(s["position"][:, 0], s["position"][:, 1], radius, strict=True))
    found = find_pairs(bodies.state, bodies.count, NOTHING, 0.05)
    assert list(map(tuple, found.tolist())) == near_pairs(circles, s["immovable"].tolist())


@pytest.mark.parametrize("seed", seeds(4))
def test_statics_are_found_like_bodies(seed: int) -> None:
    rng = np.random.default_rng(seed)
    standing = np.zeros(80, STATIC_BOX)
    standing["centre"][:, :2] = rng.uniform(-60.0, 60.0, (80, 2))
    standing["half"] = rng.uniform(0.2, 9.0, (80, 3))
    bodies = scattered(seed, 20)
    found = find_pairs(bodies.state, bodies.count, Statics.of(standing), 0.05)
    expected = []
    for i in np.flatnonzero(~bodies.state["immovable"][:20]):
        reach = math.hypot(*bodies.half_extent[i, :2]) + 0.5 * 20.0 * 0.05**2 + 0.2
        away = np.linalg.norm(standing["centre"][:, :2] - bodies.position[i, :2], axis=1)
        expected += [(i, -1 - n) for n in np.flatnonzero(away < reach + np.hypot(*standing["half"][:, :2].T))]
    assert [tuple(pair) for pair in found.tolist() if pair[1] < 0] == expected


def floating(seed: int, count: int) -> Bodies:
    """Boxes without weight, so that nothing but contacts changes their motion."""
    rng = np.random.default_rng(seed)
    bodies = Bodies()
    for _ in range(count):
        x, y, yaw = rng.uniform((-8.0, -8.0, -180.0), (8.0, 8.0, 180.0))
        extent = Vector3D(*rng.uniform(0.3, 1.5, 3))
        slot = bodies.add_prop(at(x, y, 5.0, yaw), BoundingBox(Vector3D(), extent), rng.uniform(5.0, 500.0))
        bodies.gravity[slot] = False
        bodies.velocity[slot, :2] = rng.uniform(-5.0, 5.0, 2)
        bodies.angular_velocity[slot, 2] = rng.uniform(-2.0, 2.0)
    return bodies


@pytest.mark.parametrize("seed", seeds(6))
def test_collisions_keep_momentum_and_make_no_energy(seed: int) -> None:
    bodies = floating(seed, 12)
    mass = bodies.mass_kg[:12]
    met = 0
    for _ in range(100):
        momentum = (mass[:, None] * bodies.velocity[:12]).sum(axis=0)
        energy = 0.5 * (mass * (bodies.velocity[:12] ** 2).sum(axis=1)).sum()
        energy += 0.5 * (bodies.state["yaw_inertia_kgm2"][:12] * bodies.angular_velocity[:12, 2] ** 2).sum()
        contacts = step(bodies, FLAT, NOTHING, 0.02)
        met += len(contacts)
        after = 0.5 * (mass * (bodies.velocity[:12] ** 2).sum(axis=1)).sum()
        after += 0.5 * (bodies.state["yaw_inertia_kgm2"][:12] * bodies.angular_velocity[:12, 2] ** 2).sum()
        assert after <= energy * (1.0 + 1e-12)
        assert (mass[:, None] * bodies.velocity[:12]).sum(axis=0) == pytest.approx(momentum, abs=1e-8)
        keys = list(zip(contacts["a"].tolist(), contacts["b"].tolist(), strict=True))
        assert keys == sorted(set(keys))
        assert (contacts["a"] < contacts["b"]).all()
    assert met > 0


@slow_uncompiled
def test_a_wall_stops_a_car_and_says_with_what_impulse() -> None:
    bodies, car = one(slick())
    bodies.set_control(car, NEUTRAL)
    bodies.set_target_velocity(car, (10.0, 0.0, 0.0))
    impulse, rows = np.zeros(3), 0
    for _ in range(100):
        contacts = advance(bodies, FLAT, wall(10.0), 0.05, 5)
        assert contacts.dtype == CONTACT
        for contact in contacts:
            assert (contact["a"], contact["b"], contact["static_id"], contact["tag"]) == (car, -1, 77, 4)
            impulse, rows = impulse + contact["impulse"], rows + 1
            assert contact["point"][0] == pytest.approx(9.5, abs=0.2)
    assert rows > 0
    assert bodies.position[car, 0] < 9.5 - BOX.extent.x + 0.05
    assert -1696.0 * 10.0 * 1.35 < impulse[0] < -1696.0 * 10.0 * 0.95


@slow_uncompiled
def test_a_car_pressed_against_a_wall_stays_outside_it() -> None:
    bodies, car = one()
    bodies.set_control(car, VehicleControl(throttle=1.0))
    run(bodies, 20.0, 0.05, statics=wall(10.0))
    assert bodies.position[car, 0] < 9.5 - BOX.extent.x + 0.1


@slow_uncompiled
def test_a_heavy_car_pushes_a_light_one_and_not_the_other_way_round() -> None:
    bodies = Bodies()
    heavy = bodies.add_vehicle(slick(mass=6000.0), at(), BOX, OFFSETS)
    light = bodies.add_vehicle(slick(mass=800.0), at(x=8.0), BOX, OFFSETS)
    for slot in (heavy, light):
        bodies.set_control(slot, NEUTRAL)
    run(bodies, 0.3)
    bodies.set_target_velocity(heavy, (8.0, 0.0, 0.0))
    run(bodies, 1.0)
    assert 6.0 < bodies.velocity[heavy, 0] < 7.6
    assert bodies.velocity[light, 0] > 7.0


def test_what_is_not_simulated_is_a_wall() -> None:
    bodies = Bodies()
    fixed = bodies.add_vehicle(sedan(mass=500.0), at(x=8.0, z=3.0), BOX, OFFSETS)
    bodies.set_simulate(fixed, simulate=False)
    bodies.set_pose(fixed, at(x=8.0))
    car = bodies.add_vehicle(sedan(), at(), BOX, OFFSETS)
    bodies.set_target_velocity(car, (10.0, 0.0, 0.0))
    before = bodies.position[fixed].copy()
    run(bodies, 3.0)
    assert (bodies.position[fixed] == before).all()
    assert bodies.position[car, 0] < 8.0 - 2.0 * BOX.extent.x + 0.1


def test_wheels_roll_over_what_is_lower_than_the_clearance() -> None:
    bodies, car = one(slick())
    bodies.set_control(car, NEUTRAL)
    bodies.set_target_velocity(car, (10.0, 0.0, 0.0))
    run(bodies, 2.0, statics=wall(10.0, half=(0.5, 5.0, 0.05)))
    assert bodies.velocity[car, 0] > 9.0


@slow_uncompiled
def test_wheels_roll_over_low_things_on_a_hill_too() -> None:
    rise = 0.1
    bodies, slot = one(pose=at(pitch=math.degrees(math.atan(rise))))
    ahead_m = 14.0
    debris = at(ahead_m, 0.0, rise * ahead_m, pitch=math.degrees(math.atan(rise)))
    bodies.add_prop(debris, BoundingBox(Vector3D(0.0, 0.0, 0.075), Vector3D(0.93, 0.75, 0.075)), None)
    bodies.velocity[slot] = 10.0, 0.0, 10.0 * rise
    run(bodies, 4.0, ground=slope(rise))
    assert bodies.position[slot][0] > ahead_m + 5.0


@slow_uncompiled
def test_without_collisions_bodies_pass_through_each_other() -> None:
    bodies, car = one(slick())
    bodies.collides[car] = False
    bodies.set_control(car, NEUTRAL)
    bodies.set_target_velocity(car, (10.0, 0.0, 0.0))
    run(bodies, 2.0, statics=wall(10.0))
    assert bodies.position[car, 0] > 15.0


def test_a_hit_prop_slides_by_friction_and_stops() -> None:
    bodies = Bodies()
    crate = bodies.add_prop(at(), BoundingBox(Vector3D(0.0, 0.0, 0.4), Vector3D(0.4, 0.4, 0.4)), 30.0)
    run(bodies, 0.5)
    bodies.set_target_velocity(crate, (6.0, 0.0, 0.0))
    run(bodies, 3.0)
    assert not bodies.velocity[crate].any()
    assert bodies.position[crate, 0] == pytest.approx(6.0**2 / (2.0 * 0.6 * 9.81), rel=0.03)


def test_a_static_that_is_no_number_is_refused() -> None:
    broken = np.zeros(1, STATIC_BOX)
    broken["yaw_rad"] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        Statics.of(broken)


def test_contacts_are_listed_by_pair_statics_first() -> None:
    bodies = Bodies()
    for k in range(6):
        bodies.add_vehicle(sedan(), at(x=5.0 * k), BOX, OFFSETS)
        bodies.set_target_velocity(k, (3.0 if k % 2 == 0 else -3.0, 0.0, 0.0))
    bodies.set_target_velocity(0, (-3.0, 0.0, 0.0))
    rows = advance(bodies, FLAT, wall(-2.8), 0.05, 5)
    keys = list(zip(rows["a"].tolist(), rows["b"].tolist(), strict=True))
    assert keys == [(0, -1), (0, 1), (2, 3), (4, 5)]
