"""Pushes, velocities, roll-over, weather and friction triggers through the official client."""

import math
from collections.abc import Callable

import carla
import pytest

from spawn_points import spawn_point

STEP_S = 0.05


@pytest.fixture
def point(world: carla.World) -> carla.Transform:
    return spawn_point(world, 100)


@pytest.fixture
def car(world: carla.World, point: carla.Transform) -> carla.Vehicle:
    vehicle = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), point)
    ticks(world, 20)
    return vehicle


def ticks(world: carla.World, count: int) -> None:
    for _ in range(count):
        world.tick()


def mass_kg(car: carla.Vehicle) -> float:
    return car.get_physics_control().mass


def yaw_inertia_kgm2(car: carla.Vehicle) -> float:
    half = car.bounding_box.extent
    hull = 0.75  # of the box's (linden.physics.vehicle.parameters)
    return hull * mass_kg(car) * (half.x**2 + half.y**2) / 3.0


def roll_inertia_kgm2(car: carla.Vehicle) -> float:
    half = car.bounding_box.extent
    return mass_kg(car) * (half.y**2 + half.z**2) / 3.0


def in_the_air(world: carla.World, car: carla.Vehicle) -> None:
    """Where nothing but what a test adds acts: high up, without gravity, at rest."""
    high = car.get_transform()
    high.location.z += 50.0
    high.rotation = carla.Rotation(yaw=high.rotation.yaw)
    car.set_enable_gravity(False)
    car.set_transform(high)
    car.set_target_velocity(carla.Vector3D())
    ticks(world, 1)


def test_an_impulse_changes_the_velocity_by_itself_over_the_mass(world, car) -> None:
    in_the_air(world, car)
    push = carla.Vector3D(1.0, -2.0, 0.5) * mass_kg(car)
    car.add_impulse(push)
    ticks(world, 1)
    velocity = car.get_velocity()
    assert (velocity.x, velocity.y, velocity.z) == pytest.approx((1.0, -2.0, 0.5), abs=0.01)


def test_a_force_acts_for_one_frame(world, car) -> None:
    in_the_air(world, car)
    car.add_force(carla.Vector3D(10.0, 0.0, 0.0) * mass_kg(car))
    ticks(world, 1)
    assert car.get_velocity().x == pytest.approx(10.0 * STEP_S, rel=0.01)
    assert car.get_acceleration().x == pytest.approx(10.0, rel=0.01)
    ticks(world, 1)
    assert car.get_velocity().x == pytest.approx(10.0 * STEP_S, rel=0.01)


@pytest.mark.parametrize("add", [carla.Actor.add_angular_impulse, carla.Actor.add_torque])
def test_angular_pushes_count_in_kg_cm2_and_degrees_as_unreal_does(
    world, car, add: Callable[[carla.Actor, carla.Vector3D], None]
) -> None:
    in_the_air(world, car)
    wanted_degps = 30.0
    add(car, carla.Vector3D(0.0, 0.0, wanted_degps * yaw_inertia_kgm2(car) * 1e4))
    ticks(world, 1)
    assert car.get_angular_velocity().z == pytest.approx(wanted_degps, rel=0.02)


def test_a_target_angular_velocity_is_in_degrees(world, car) -> None:
    in_the_air(world, car)
    car.set_target_angular_velocity(carla.Vector3D(0.0, 0.0, 45.0))
    yaw = car.get_transform().rotation.yaw
    ticks(world, 10)
    assert car.get_angular_velocity().z == pytest.approx(45.0, rel=0.01)
    assert (car.get_transform().rotation.yaw - yaw) % 360.0 == pytest.approx(45.0 * 10 * STEP_S, rel=0.05)


def test_constant_velocity_is_held_until_it_is_disabled(world, car) -> None:
    car.apply_control(carla.VehicleControl(brake=1.0))
    car.enable_constant_velocity(carla.Vector3D(4.0, 0.0, 0.0))
    ticks(world, 20)
    ahead = car.get_transform().get_forward_vector()
    assert car.get_velocity().dot(ahead) == pytest.approx(4.0, abs=0.05)
    car.disable_constant_velocity()
    ticks(world, 40)
    assert car.get_velocity().length() < 0.01


def test_a_teleport_keeps_the_velocity(world, car) -> None:
    ahead = car.get_transform().get_forward_vector()
    car.set_target_velocity(ahead * 8.0)
    ticks(world, 2)
    before = car.get_velocity()
    car.set_transform(car.get_transform())
    ticks(world, 1)
    assert car.get_velocity().distance(before) < 0.5


def test_a_car_dropped_from_a_roof_lands_on_its_wheels(world, car) -> None:
    high = car.get_transform()
    ground_m = high.location.z
    high.location.z += 8.0
    car.set_transform(high)
    ticks(world, 10)
    assert car.get_velocity().z == pytest.approx(-9.81 * 10 * STEP_S, rel=0.02)
    ticks(world, 80)
    assert car.get_location().z == pytest.approx(ground_m, abs=0.05)
    assert car.get_failure_state() == carla.VehicleFailureState.NONE


def test_a_hard_turn_about_its_nose_throws_a_car_over(world, car) -> None:
    about_the_nose = car.get_transform().get_forward_vector() * (480.0 * roll_inertia_kgm2(car) * 1e4)
    car.add_angular_impulse(about_the_nose)
    most_deg = 0.0
    for _ in range(40):
        world.tick()
        most_deg = max(most_deg, abs(car.get_transform().rotation.roll))
    assert most_deg > 90.0


def test_a_car_on_its_roof_says_so_after_five_seconds_until_it_is_put_right(world, car, point) -> None:
    over = car.get_transform()
    over.location.z += 2.0
    over.rotation.roll = 180.0
    car.set_transform(over)
    ticks(world, 90)
    assert car.get_failure_state() == carla.VehicleFailureState.NONE
    ticks(world, 40)
    assert abs(car.get_transform().rotation.roll) > 170.0
    assert car.get_failure_state() == carla.VehicleFailureState.Rollover
    car.set_transform(point)
    ticks(world, 20)
    assert car.get_failure_state() == carla.VehicleFailureState.NONE
    assert abs(car.get_transform().rotation.roll) < 1.0


def braking_m(world: carla.World, car: carla.Vehicle, point: carla.Transform) -> float:
    """Metres from 12 m/s to a stop with locked wheels."""
    car.set_transform(point)
    ticks(world, 20)
    begin = car.get_location()
    car.set_target_velocity(car.get_transform().get_forward_vector() * 12.0)
    car.apply_control(carla.VehicleControl(brake=1.0, hand_brake=True))
    for _ in range(200):
        world.tick()
        if car.get_velocity().length() < 0.01:
            break
    car.apply_control(carla.VehicleControl())
    return car.get_location().distance(begin)


def with_friction(control: carla.VehiclePhysicsControl, friction: float) -> carla.VehiclePhysicsControl:
    wheels = control.wheels
    for wheel in wheels:
        wheel.tire_friction = friction
        wheel.max_brake_torque = 1e5
    control.wheels = wheels
    return control


def test_a_wet_road_lengthens_the_way_to_a_stop_by_the_handbook_s_ratio(world, car, point) -> None:
    car.apply_physics_control(with_friction(car.get_physics_control(), 0.8))
    ways = {}
    for name, weather in {
        "dry": carla.WeatherParameters.ClearNoon,
        "wet": carla.WeatherParameters(wetness=100.0),
        "puddles": carla.WeatherParameters(precipitation_deposits=100.0),
        "dry again": carla.WeatherParameters(),
    }.items():
        world.set_weather(weather)
        ways[name] = braking_m(world, car, point)
    grip = 0.7 * 1.16  # of the road, and of the load that counts (linden.physics.vehicle.wheels)
    assert ways["dry"] == pytest.approx(12.0**2 / (2.0 * 0.8 * grip * 9.81), rel=0.1)
    assert ways["wet"] / ways["dry"] == pytest.approx(0.85 / 0.65, rel=0.06)
    assert ways["puddles"] / ways["dry"] == pytest.approx(0.85 / 0.50, rel=0.06)
    assert ways["dry again"] == pytest.approx(ways["dry"], rel=0.02)
    assert car.get_physics_control().wheels[0].tire_friction == pytest.approx(0.8)


def spawn_trigger(world: carla.World, at: carla.Transform, friction: float, half_m: float) -> carla.Actor:
    blueprint = world.get_blueprint_library().find("static.trigger.friction")
    blueprint.set_attribute("friction", str(friction))
    for axis in "xyz":
        blueprint.set_attribute(f"extent_{axis}", str(100.0 * half_m))  # in cm, as in CARLA
    return world.spawn_actor(blueprint, at)


def frictions(car: carla.Vehicle) -> list[float]:
    return [wheel.tire_friction for wheel in car.get_physics_control().wheels]


def test_a_friction_trigger_changes_the_tyres_inside_and_gives_them_back_outside(world, car, point) -> None:
    own = frictions(car)
    trigger = spawn_trigger(world, car.get_transform(), 0.25, 3.0)
    assert trigger.bounding_box.extent.x == pytest.approx(3.0)
    ticks(world, 1)
    assert frictions(car) == [0.25] * 4
    assert car.get_telemetry_data().wheels[0].tire_friction == pytest.approx(0.25)
    car.set_target_velocity(car.get_transform().get_forward_vector() * 12.0)
    ticks(world, 1)
    assert frictions(car) == [0.25] * 4
    ticks(world, 30)
    assert frictions(car) == own
    car.set_transform(point)
    ticks(world, 2)
    assert frictions(car) == [0.25] * 4
    trigger.destroy()
    ticks(world, 1)
    assert frictions(car) == own


def test_physics_set_inside_a_trigger_is_answered_and_lasts(world, car) -> None:
    spawn_trigger(world, car.get_transform(), 0.25, 4.0)
    ticks(world, 1)
    car.apply_physics_control(with_friction(car.get_physics_control(), 2.0))
    ticks(world, 2)
    assert frictions(car) == [2.0] * 4


def test_without_friction_and_drag_nothing_slows_a_car_on_the_flat(world, car) -> None:
    in_the_air(world, car)
    control = with_friction(car.get_physics_control(), 0.0)
    control.drag_coefficient = 0.0
    car.apply_physics_control(control)
    car.set_target_velocity(carla.Vector3D(10.0, 0.0, 0.0))
    ticks(world, 50)
    assert car.get_velocity().x == pytest.approx(10.0, abs=0.01)


def test_substeps_of_any_number_lead_to_nearly_the_same_place_and_each_to_the_same_bytes(client, world, point) -> None:
    ends = {}
    for substeps in (1, 5, 10, 5):
        settings = world.get_settings()
        settings.substepping, settings.max_substeps = True, substeps
        settings.max_substep_delta_time = STEP_S / substeps + 1e-6
        world.apply_settings(settings)
        car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), point)
        ticks(world, 20)
        car.apply_control(carla.VehicleControl(throttle=0.6, steer=0.1))
        ticks(world, 40)
        at = car.get_transform()
        end = (at.location.x, at.location.y, at.location.z, at.rotation.yaw, car.get_velocity().length())
        assert end == ends.setdefault(substeps, end)
        car.destroy()
        ticks(world, 1)
    assert math.dist(ends[1][:2], ends[10][:2]) < 1.0
    assert math.dist(ends[5][:2], ends[10][:2]) < 0.3
