"""Vehicles off their wheels: how they fall, roll over, slide and lie, and how they come to stand again."""

import math
from typing import Any

import numpy as np
import pytest

from fleet import BOX, FLAT, NOTHING, G, at, one, run, sedan, slope, slow_uncompiled, wall, wheels
from linden.geometry import rotation_matrix
from linden.physics.bodies import Bodies
from linden.physics.step import advance
from linden.physics.tumble import BODY_FRICTION, tripping_speed_mps
from linden.physics.vehicle.rollover import FLAG_AFTER_S, ROLLOVER
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.space import Rotation, Transform, Vector3D

MASS_KG = 1696.0
ROOF_M = BOX.location.z + BOX.extent.z


def put(roll: float, z: float, pitch: float = 0.0, yaw: float = 0.0) -> Transform:
    return Transform(Vector3D(0.0, 0.0, z), Rotation(pitch, yaw, roll))


def standing() -> tuple[Bodies, int]:
    bodies, car = one()
    run(bodies, 0.5, 0.05)
    return bodies, car


def roll_deg(bodies: Bodies, slot: int) -> float:
    return math.degrees(bodies.rotation[slot, 2])


def test_a_vehicle_put_on_its_roof_stays_there_and_is_reported_after_five_seconds() -> None:
    bodies, car = one(pose=put(180.0, ROOF_M + 0.3))
    seen = []
    for _ in range(160):
        advance(bodies, FLAT, NOTHING, 0.05, 5)
        seen.append(int(bodies.failure[car]))
    first = seen.index(ROLLOVER)
    assert FLAG_AFTER_S <= first * 0.05 <= FLAG_AFTER_S + 1.0
    assert set(seen[first:]) == {ROLLOVER}
    assert abs(roll_deg(bodies, car)) > 175.0
    assert bodies.position[car, 2] == pytest.approx(ROOF_M, abs=0.03)
    assert not bodies.velocity[car].any()


@slow_uncompiled
def test_a_vehicle_put_back_on_its_wheels_has_no_failure_and_drives_on() -> None:
    bodies, car = one(pose=put(180.0, ROOF_M))
    run(bodies, 6.0, 0.05)
    assert bodies.failure[car] == ROLLOVER
    bodies.set_pose(car, at(z=0.2))
    bodies.set_control(car, VehicleControl(throttle=0.5))
    run(bodies, 4.0, 0.05)
    assert bodies.failure[car] == 0
    assert not bodies.tumbling[car]
    assert bodies.velocity[car, 0] > 3.0


def test_a_vehicle_on_its_side_lies_there_and_has_not_rolled_over() -> None:
    bodies, car = one(pose=put(90.0, 1.3))
    run(bodies, 8.0, 0.05)
    assert roll_deg(bodies, car) == pytest.approx(90.0, abs=3.0)
    assert bodies.position[car, 2] == pytest.approx(BOX.extent.y, abs=0.05)
    assert bodies.failure[car] == 0


def test_a_vehicle_that_lands_a_little_askew_comes_down_on_its_wheels() -> None:
    bodies, car = one(pose=put(40.0, 2.0))
    run(bodies, 4.0, 0.05)
    assert not bodies.tumbling[car]
    assert bodies.rotation[car, ::2] == pytest.approx(0.0, abs=1e-3)
    assert bodies.position[car, 2] == pytest.approx(0.0, abs=0.02)


@slow_uncompiled
@pytest.mark.parametrize(("gained_mps", "falls"), [(1.0, False), (3.0, True), (5.0, True)])
def test_a_push_at_the_roof_tips_a_vehicle_if_it_is_hard_enough(gained_mps: float, *, falls: bool) -> None:
    bodies, car = standing()
    bodies.add_impulse(car, (0.0, MASS_KG * gained_mps, 0.0), (0.0, 0.0, 1.4))
    most = 0.0
    for _ in range(200):
        advance(bodies, FLAT, NOTHING, 0.05, 5)
        most = max(most, abs(roll_deg(bodies, car)))
    assert (most > 60.0) is falls
    if not falls:
        assert most < 10.0
        assert roll_deg(bodies, car) == pytest.approx(0.0, abs=0.01)


def test_a_steady_push_at_the_roof_tips_a_vehicle_once_it_exceeds_its_weight_s_moment() -> None:
    for share, falls in ((0.5, False), (2.0, True)):
        bodies, car = standing()
        force_n = share * MASS_KG * G * 0.785 / 1.4  # about the wheels it is pushed over
        most = 0.0
        for _ in range(40):
            for side, height in ((1.0, 1.4), (-1.0, 0.0)):  # held at the ground: a pure moment
                bodies.add_force(car, (0.0, side * force_n, 0.0), (*bodies.position[car, :2], height))
            advance(bodies, FLAT, NOTHING, 0.05, 5)
            most = max(most, abs(roll_deg(bodies, car)))
        assert (most > 45.0) is falls


@slow_uncompiled
def test_a_push_to_the_side_throws_a_vehicle_over_only_where_its_tyres_catch() -> None:
    over = []
    for friction in (0.3, 3.5):
        bodies, car = one(sedan(wheels=wheels(tire_friction=friction)))
        run(bodies, 0.5, 0.05)
        bodies.add_impulse(car, (0.0, MASS_KG * 14.0, 0.0))
        most = 0.0
        for _ in range(100):
            advance(bodies, FLAT, NOTHING, 0.05, 5)
            most = max(most, abs(roll_deg(bodies, car)))
        over.append(most > 90.0)
    assert over == [False, True]


def plain(compiled: Any) -> Any:
    """A compiled function as Python has it, which it is already where the compiler is off."""
    return getattr(compiled, "py_func", compiled)


def test_the_tripping_speed_lifts_the_centre_of_mass_over_the_caught_wheels() -> None:
    bodies, car = one()
    height, arm = float(bodies.state["centre_of_mass"][car, 2]), 0.75 * BOX.extent.y
    inertia = (BOX.extent.y**2 + BOX.extent.z**2) / 3.0 + height**2 + arm**2
    spin = plain(tripping_speed_mps)(bodies.state[car : car + 1].view(np.recarray)[0]) * height / inertia
    assert 0.5 * inertia * spin**2 == pytest.approx(G * (math.hypot(height, arm) - height))


@slow_uncompiled
def test_cornering_alone_never_lifts_a_vehicle_off_its_wheels() -> None:
    bodies, car = standing()
    for speed_mps in (10.0, 25.0, 40.0):
        bodies.set_target_velocity(car, (speed_mps, 0.0, 0.0))
        bodies.set_control(car, VehicleControl(steer=1.0, throttle=1.0))
        for _ in range(60):
            advance(bodies, FLAT, NOTHING, 0.05, 5)
            assert not bodies.tumbling[car]


@slow_uncompiled
def test_a_vehicle_sliding_on_its_roof_stops_by_friction() -> None:
    bodies, car = one(pose=put(180.0, ROOF_M))
    run(bodies, 1.0)
    begin = float(bodies.position[car, 0])
    bodies.set_target_velocity(car, (-10.0, 0.0, 0.0))
    run(bodies, 4.0)
    assert not bodies.velocity[car].any()
    assert begin - bodies.position[car, 0] == pytest.approx(10.0**2 / (2.0 * BODY_FRICTION * G), rel=0.1)


def test_a_vehicle_without_weight_keeps_turning_about_its_centre_of_mass() -> None:
    bodies, car = one(pose=put(170.0, 50.0))
    bodies.set_gravity(car, falls=False)
    run(bodies, 0.1)
    bodies.set_target_angular_velocity(car, (1.0, 0.0, 0.0))
    run(bodies, 0.05)
    spin = bodies.angular_velocity[car].copy()
    assert spin == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)
    middle = bodies._mass_point(car)
    run(bodies, 1.0)
    assert bodies.angular_velocity[car] == pytest.approx(spin, abs=1e-9)
    assert np.linalg.norm(bodies._mass_point(car) - middle) < 2.0
    turned = (170.0 - roll_deg(bodies, car)) % 360.0
    assert turned == pytest.approx(math.degrees(1.05), abs=0.5)


@slow_uncompiled
def test_a_two_wheeler_that_leans_in_the_air_is_not_upset_and_one_that_lies_is() -> None:
    two = (wheels()[0], wheels()[2])
    offsets = (Vector3D(0.7, 0.0, 0.0), Vector3D(-0.7, 0.0, 0.0))
    slim = BOX._replace(extent=Vector3D(1.0, 0.4, 0.75))
    for lean_deg, upset in ((38.0, False), (90.0, True)):
        bodies = Bodies()
        bike = bodies.add_vehicle(sedan(mass=200.0, wheels=two), put(lean_deg, 0.5), slim, offsets)
        run(bodies, 4.0)
        assert bodies.tumbling[bike] == upset
        assert (abs(roll_deg(bodies, bike)) > 60.0) is upset


@slow_uncompiled
def test_nothing_falls_through_the_ground_however_fast_and_coarsely_stepped() -> None:
    for dt_s in (0.01, 0.05, 0.1):
        bodies, car = one(pose=put(170.0, 60.0, 20.0))
        bodies.set_target_velocity(car, (0.0, 0.0, -60.0))
        for _ in range(round(6.0 / dt_s)):
            advance(bodies, FLAT, NOTHING, dt_s)
            assert bodies.position[car, 2] > -0.6


def lowest_m(bodies: Bodies, slot: int) -> float:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * BOX.extent * 0.75
    turned = (corners + BOX.location) @ rotation_matrix(bodies.pose(slot).rotation).T
    return float((turned + bodies.position[slot])[:, 2].min())


@slow_uncompiled
@pytest.mark.parametrize("dt_s", [0.01, 0.02, 0.05])
@pytest.mark.parametrize("seed", range(5))
def test_whatever_is_thrown_comes_to_rest_above_the_ground(seed: int, dt_s: float) -> None:
    rng = np.random.default_rng(seed)
    pitch, yaw, roll = rng.uniform((-80.0, -180.0, -180.0), (80.0, 180.0, 180.0))
    bodies, car = one(pose=put(roll, 4.0, pitch, yaw))
    bodies.set_control(car, VehicleControl(hand_brake=True))
    bodies.set_target_velocity(car, rng.uniform(-12.0, 12.0, 3))
    bodies.set_target_angular_velocity(car, rng.uniform(-4.0, 4.0, 3))
    fastest = 0.0
    for _ in range(round(12.0 / dt_s)):
        advance(bodies, FLAT, NOTHING, dt_s)
        assert np.isfinite(bodies.position[car]).all()
        fastest = max(fastest, float(np.abs(bodies.velocity[car]).max()))
    assert fastest < 45.0
    assert not bodies.velocity[car].any()
    assert lowest_m(bodies, car) > -0.1
    stood = bodies.state[car].tobytes()
    advance(bodies, FLAT, NOTHING, dt_s)
    assert bodies.failure[car] in (0, ROLLOVER)
    assert bodies.state[car]["position"].tobytes() == np.frombuffer(stood, bodies.state.dtype)[0]["position"].tobytes()


@slow_uncompiled
def test_a_tumble_is_the_same_bytes_each_time() -> None:
    def outcome() -> bytes:
        bodies, car = one(pose=put(60.0, 3.0, 50.0, 20.0))
        bodies.set_target_velocity(car, (15.0, 3.0, 0.0))
        ground, statics = slope(0.05), wall(12.0)
        contacts = b"".join(advance(bodies, ground, statics, 0.05, 5).tobytes() for _ in range(80))
        return bodies.state[: bodies.count].tobytes() + contacts

    assert outcome() == outcome()


def test_a_car_that_lies_on_its_side_is_hit_at_the_height_it_lies_at() -> None:
    bodies, lying = one(pose=put(90.0, BOX.extent.y))
    run(bodies, 1.0)
    other = bodies.add_vehicle(sedan(), at(x=-12.0), BOX, None)
    bodies.set_target_velocity(other, (12.0, 0.0, 0.0))
    met = 0
    for _ in range(60):
        met += len(advance(bodies, FLAT, NOTHING, 0.05, 5))
    assert met > 0
    assert bodies.position[lying, 0] > 0.5


def test_a_pushed_wreck_slides_and_turns_in_space() -> None:
    bodies, car = one(pose=put(180.0, ROOF_M))
    run(bodies, 1.0)
    bodies.add_impulse(car, (MASS_KG * 4.0, 0.0, 0.0), (0.0, 2.0, 0.5))
    advance(bodies, FLAT, NOTHING, 0.01)
    assert bodies.velocity[car, 0] > 1.0
    assert bodies.angular_velocity[car, 2] < -0.1
