"""Whatever is commanded at whatever step: nothing explodes, energy is not made, the same input gives the same bytes."""

import itertools
import math

import numpy as np
import pytest

from fleet import BOX, FLAT, NOTHING, OFFSETS, G, at, one, run, sedan, slick, slope, slow_uncompiled, wall, wheels
from linden.maps.ground import Ground
from linden.physics.bodies import Bodies
from linden.physics.step import advance
from linden.protocol.values.control import VehicleControl

NEUTRAL = VehicleControl(manual_gear_shift=True, gear=0)


@slow_uncompiled
@pytest.mark.parametrize("dt_s", [0.01, 0.02, 0.05, 0.1])
@pytest.mark.parametrize("v_mps", [0.0, 0.1, 1.0, 5.0, 20.0, 40.0])
def test_a_braking_car_comes_to_a_real_stop(v_mps: float, dt_s: float) -> None:
    for steer, side in itertools.product((-1.0, 0.0, 0.3), (0.0, 0.3)):
        bodies, car = one()
        bodies.set_control(car, VehicleControl(brake=1.0, steer=steer))
        bodies.set_target_velocity(car, (v_mps, side * v_mps, 0.0))
        bodies.set_target_angular_velocity(car, (0.0, 0.0, 0.05 * v_mps))
        speeds = []
        for _ in range(round(14.0 / dt_s)):
            advance(bodies, FLAT, NOTHING, dt_s)
            speeds.append(math.hypot(*bodies.velocity[car, :2]))
        assert max(speeds) <= 1.1 * v_mps + 1e-9
        assert speeds[-1] == 0.0
        stood = bodies.state[car].tobytes()
        run(bodies, 1.0, dt_s)
        assert bodies.state[car].tobytes() == stood


@slow_uncompiled
@pytest.mark.parametrize("dt_s", [0.01, 0.05, 0.1])
@pytest.mark.parametrize("seed", range(4))
def test_wild_driving_stays_finite_and_upright(seed: int, dt_s: float) -> None:
    rng = np.random.default_rng(seed)
    friction = float(rng.choice([0.05, 0.5, 1.0, 3.5, 10.0]))
    bodies, car = one(sedan(wheels=wheels(tire_friction=friction)))
    for _ in range(100):
        throttle, brake = rng.uniform(size=2) * (rng.random(2) < 0.5)
        lever = rng.random(3) < 0.15
        bodies.set_control(
            car, VehicleControl(throttle, rng.uniform(-1, 1), brake, *map(bool, lever), int(rng.integers(-1, 7)))
        )
        run(bodies, 0.5, dt_s)
        assert np.isfinite(bodies.position[car]).all()
        assert np.isfinite(bodies.wheel_load[car]).all()
        assert math.hypot(*bodies.velocity[car, :2]) < 75.0
        assert abs(bodies.angular_velocity[car, 2]) < 12.0
        assert np.abs(bodies.rotation[car, ::2]).max() < 0.2
        assert abs(bodies.position[car, 2]) < 0.05


def energy_j(bodies: Bodies, slot: int) -> float:
    """In the plane of flat ground: of the centre of mass, of yaw, of the wheels."""
    s = bodies.state[slot]
    yaw, turn = s["rotation"][1], s["angular_velocity"][2]
    x, y = s["centre_of_mass"][:2]
    arm = math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y
    velocity = s["velocity"][0] - turn * arm[1], s["velocity"][1] + turn * arm[0]
    spin = 0.5 * float((bodies.spec(slot)["wheel_inertia_kgm2"] * s["wheel_omega"] ** 2).sum())
    return 0.5 * float(s["mass_kg"] * (velocity[0] ** 2 + velocity[1] ** 2) + s["yaw_inertia_kgm2"] * turn**2) + spin


@slow_uncompiled
@pytest.mark.parametrize("dt_s", [0.01, 0.05, 0.1])
def test_a_coasting_car_never_gains_energy(dt_s: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        bodies, car = one(slick(wheels=wheels(damping_rate=0.0, tire_friction=float(rng.uniform(0.1, 4.0)))))
        bodies.set_control(car, NEUTRAL._replace(steer=rng.uniform(-1, 1), brake=rng.uniform() * (rng.random() < 0.5)))
        run(bodies, 0.5, dt_s)
        bodies.set_target_velocity(car, (*rng.uniform(-25.0, 25.0, 2), 0.0))
        bodies.set_target_angular_velocity(car, (0.0, 0.0, rng.uniform(-4.0, 4.0)))
        before = energy_j(bodies, car)
        for _ in range(round(3.0 / dt_s)):
            advance(bodies, FLAT, NOTHING, dt_s)
            after = energy_j(bodies, car)
            assert after <= before * (1.0 + 1e-5) + 1e-6
            before = after


def hills() -> Ground:
    x, y = np.meshgrid(np.arange(-50.0, 451.0), (-30.0, 30.0), indexing="ij")
    corners = np.stack([x.ravel(), y.ravel(), 3.0 * (1.0 - np.cos(x.ravel() / 15.0))], axis=1)
    first = np.arange(500) * 2
    return Ground.from_triangles(
        corners,
        np.concatenate([np.stack([first, first + 1, first + 2], 1), np.stack([first + 1, first + 3, first + 2], 1)]),
    )


@slow_uncompiled
def test_over_the_hills_speed_turns_into_height_and_back_and_none_is_gained() -> None:
    ground = hills()
    bodies, car = one(slick())
    bodies.set_control(car, NEUTRAL)
    run(bodies, 1.0, ground=ground)
    bodies.set_target_velocity(car, (18.0, 0.0, 0.0))
    highest = 0.5 * 1736.0 * 18.0**2
    for _ in range(1500):
        advance(bodies, ground, NOTHING, 0.01)
        height_j = 1696.0 * G * float(bodies.position[car, 2])
        moving_j = 0.5 * 1736.0 * float((bodies.velocity[car] ** 2).sum())
        assert height_j + moving_j < highest * 1.005
    assert bodies.position[car, 0] > 150.0
    assert height_j + moving_j > 0.7 * highest


def crowd(seed: int) -> Bodies:
    rng = np.random.default_rng(seed)
    bodies = Bodies()
    for k in range(30):
        x, y, yaw = rng.uniform((0.0, 0.0, -180.0), (60.0, 60.0, 180.0))
        if k % 3 == 2:
            bodies.add_prop(at(x, y, 1.0, yaw), BOX._replace(extent=BOX.extent._replace(x=0.4, y=0.6)), 40.0)
        else:
            bodies.add_vehicle(sedan(), at(x, y, 0.5, yaw), BOX, OFFSETS)
            bodies.set_control(bodies.count - 1, VehicleControl(throttle=rng.uniform(), steer=rng.uniform(-0.5, 0.5)))
    return bodies


@slow_uncompiled
def test_the_same_input_gives_the_same_bytes() -> None:
    def outcome() -> bytes:
        bodies, ground, statics = crowd(5), slope(0.02), wall(30.0)
        contacts = b"".join(advance(bodies, ground, statics, 0.05, 5).tobytes() for _ in range(60))
        return bodies.state[: bodies.count].tobytes() + contacts

    first = outcome()
    assert first == outcome()


@slow_uncompiled
def test_what_stood_in_a_slot_before_leaves_no_trace() -> None:
    fresh, used = crowd(6), Bodies()
    for _ in range(30):
        slot = used.add_vehicle(sedan(mass=900.0), at(5.0, 5.0), BOX, OFFSETS)
        used.set_control(slot, VehicleControl(throttle=1.0, reverse=True))
    run(used, 0.5)
    for slot in range(30):
        used.remove(slot)
    other = crowd(6)
    for slot in range(30):  # the same bodies, moved over into the used slots in the same order
        if other.kind[slot] == 1:
            used.add_vehicle(sedan(), other.pose(slot), BOX, OFFSETS)
            used.set_control(slot, other.control(slot))
        else:
            used.add_prop(other.pose(slot), BOX._replace(extent=BOX.extent._replace(x=0.4, y=0.6)), 40.0)
    for bodies in (fresh, used):
        run(bodies, 1.0, 0.05)
    np.testing.assert_allclose(used.position[:30], fresh.position[:30], atol=1e-6)


@pytest.mark.parametrize(
    "bad",
    [math.nan, *(pytest.param(bad, marks=slow_uncompiled) for bad in (math.inf, -math.inf, 1e300))],
)
def test_no_number_of_a_client_makes_the_state_lose_its_mind(bad: float) -> None:
    bodies, car = one()
    bodies.set_control(car, VehicleControl(throttle=bad, steer=bad, brake=bad))
    bodies.add_impulse(car, (bad, 0.0, 0.0))
    bodies.add_force(car, (0.0, bad, 0.0), (bad, 0.0, 0.0))
    bodies.add_torque(car, (bad, bad, bad))
    bodies.set_target_velocity(car, (bad, bad, bad))
    bodies.set_target_angular_velocity(car, (bad, bad, bad))
    run(bodies, 0.2)
    bodies.set_pose(car, at(bad, bad, bad, bad, bad))
    run(bodies, 0.2)
    assert np.isfinite(bodies.position[car]).all()
    assert np.isfinite(bodies.velocity[car]).all()
    assert np.isfinite(bodies.rotation[car]).all()


@pytest.mark.parametrize(("dt_s", "substeps"), [(0.0, 1), (-0.1, 1), (math.nan, 1), (math.inf, 1), (0.1, 0)])
def test_a_step_without_a_duration_is_refused(dt_s: float, substeps: int) -> None:
    with pytest.raises(ValueError, match="positive duration"):
        advance(Bodies(), FLAT, NOTHING, dt_s, substeps)
