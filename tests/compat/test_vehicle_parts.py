"""What a vehicle is made of, through the official client: physics control, wheels, doors, telemetry, other engines."""

import math
from typing import Any

import carla
import pytest

from fakes.raw_client import RawClient
from servers import RunningServer
from spawn_points import spawn_point

WHEEL = carla.VehicleWheelLocation


def ticks(world: carla.World, count: int) -> None:
    for _ in range(count):
        world.tick()


@pytest.fixture
def point(world: carla.World) -> carla.Transform:
    return spawn_point(world, 100)


def spawned(world: carla.World, model: str, at: carla.Transform) -> carla.Vehicle:
    vehicle = world.spawn_actor(world.get_blueprint_library().find(model), at)
    ticks(world, 20)
    return vehicle


@pytest.fixture
def car(world: carla.World, point: carla.Transform) -> carla.Vehicle:
    """One with doors and lamps."""
    return spawned(world, "vehicle.lincoln.mkz_2020", point)


def values(part: Any, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Everything that a structure of the client holds, as plain values."""
    found = {}
    for name in dir(part):
        value = getattr(part, name)
        if name.startswith("_") or name in without or callable(value):
            continue
        if isinstance(value, (list, tuple)):
            found[name] = [values(item) if not isinstance(item, (int, float)) else item for item in value]
        elif hasattr(value, "x"):
            found[name] = (value.x, value.y, getattr(value, "z", 0.0))
        else:
            found[name] = value
    return found


def unusual(control: carla.VehiclePhysicsControl) -> carla.VehiclePhysicsControl:
    """Change every field to something that no vehicle has by itself."""
    control.torque_curve = [carla.Vector2D(0.0, 111.0), carla.Vector2D(2500.0, 222.5), carla.Vector2D(4000.0, 33.25)]
    control.max_rpm, control.moi, control.mass, control.drag_coefficient = 4321.0, 1.5, 1357.0, 0.41
    control.damping_rate_full_throttle = 0.21
    control.damping_rate_zero_throttle_clutch_engaged = 1.75
    control.damping_rate_zero_throttle_clutch_disengaged = 0.45
    control.use_gear_autobox, control.gear_switch_time, control.clutch_strength = False, 0.125, 7.5
    control.final_ratio = 3.5
    control.forward_gears = [carla.GearPhysicsControl(3.0, 0.25, 0.75), carla.GearPhysicsControl(1.5, 0.125, 0.875)]
    control.center_of_mass = carla.Vector3D(0.125, 0.25, -0.375)
    control.steering_curve = [carla.Vector2D(0.0, 1.0), carla.Vector2D(33.0, 0.75), carla.Vector2D(99.0, 0.25)]
    control.use_sweep_wheel_collision = True
    wheels = control.wheels
    for k, wheel in enumerate(wheels):
        wheel.tire_friction, wheel.damping_rate, wheel.max_steer_angle = 1.5 + k, 0.5 + k, 40.0 + k
        wheel.radius, wheel.max_brake_torque, wheel.max_handbrake_torque = 31.0 + k, 700.0 + k, 1000.0 + k
        wheel.lat_stiff_max_load, wheel.lat_stiff_value, wheel.long_stiff_value = 2.5 + k, 15.0 + k, 900.0 + k
    control.wheels = wheels
    return control


def test_every_field_of_a_physics_control_is_answered_as_it_was_set(world, car) -> None:
    car.apply_control(carla.VehicleControl(throttle=0.5))
    ticks(world, 20)
    wanted = unusual(car.get_physics_control())
    ticks(world, 20)  # the positions in it are old by now: wheels stay on the vehicle all the same
    car.apply_physics_control(wanted)
    world.tick()
    found = car.get_physics_control()
    assert values(found, ("wheels",)) == values(wanted, ("wheels",))
    for given, kept in zip(wanted.wheels, found.wheels, strict=True):
        assert values(kept, ("position",)) == values(given, ("position",))
        at = carla.Location(kept.position.x, kept.position.y, kept.position.z) * 0.01
        assert 1.0 < at.distance(car.get_location()) < 3.0
    frozen = values(found)
    car.apply_physics_control(found)
    world.tick()
    assert values(car.get_physics_control(), ("wheels",)) == {k: v for k, v in frozen.items() if k != "wheels"}


UNFIT: list[tuple[dict[str, Any], str]] = [
    ({"mass": -1.0}, "mass, moi and max_rpm must be positive"),
    ({"mass": math.nan}, "expected a finite number"),
    ({"wheels": []}, "wheels, not 0"),
    ({"forward_gears": []}, "forward gears, not 0"),
]


def test_a_physics_control_that_cannot_drive_changes_nothing_and_the_log_says_why(
    world, car, server: RunningServer
) -> None:
    car.set_simulate_physics(False)
    before = values(car.get_physics_control())
    for change, why in UNFIT:
        control = car.get_physics_control()
        for name, value in change.items():
            setattr(control, name, value)
        car.apply_physics_control(control)
        world.tick()
        assert values(car.get_physics_control()) == before
        assert why in server.log()


def test_wheels_turn_with_the_vehicle_and_can_be_set_only_without_physics(world, car, server: RunningServer) -> None:
    car.set_wheel_steer_direction(WHEEL.FL_Wheel, 25.0)
    car.apply_control(carla.VehicleControl(throttle=0.4, steer=0.2))
    ticks(world, 10)
    assert "Cannot set wheel steer direction. Physics are enabled" in server.log()
    steer = car.get_wheel_steer_angle(WHEEL.FR_Wheel)
    assert 1.0 < steer < 70.0
    assert car.get_wheel_steer_angle(WHEEL.BL_Wheel) == 0.0
    rolled = car.get_wheel_pitch_angle(WHEEL.BL_Wheel)
    assert rolled != 0.0
    car.set_simulate_physics(False)
    assert car.get_wheel_steer_angle(WHEEL.FR_Wheel) == 0.0
    car.set_wheel_steer_direction(WHEEL.FL_Wheel, 25.0)
    car.set_wheel_pitch_angle(WHEEL.BR_Wheel, -300.0)
    ticks(world, 2)
    assert car.get_wheel_steer_angle(WHEEL.FL_Wheel) == pytest.approx(25.0)
    assert car.get_wheel_steer_angle(WHEEL.FR_Wheel) == 0.0
    assert car.get_wheel_pitch_angle(WHEEL.BR_Wheel) == pytest.approx(-300.0)
    car.set_simulate_physics(True)
    ticks(world, 2)
    assert car.get_wheel_steer_angle(WHEEL.FL_Wheel) > 1.0  # the wheel is still held at 0.2


def test_doors_move_where_there_are_any_and_the_log_says_where_not(world, car, point, server: RunningServer) -> None:
    box = car.bounding_box.extent.y
    for door in (carla.VehicleDoor.FL, carla.VehicleDoor.RR, carla.VehicleDoor.All):
        car.open_door(door)
        car.close_door(door)
    car.open_door(carla.VehicleDoor.All)
    world.tick()
    assert car.bounding_box.extent.y == box
    assert "doors" not in server.log()
    car.destroy()
    old = spawned(world, "vehicle.audi.tt", point)
    old.open_door(carla.VehicleDoor.FL)
    world.tick()
    assert "vehicle.audi.tt" in server.log()
    assert "has_dynamic_doors is false" in server.log()


def test_telemetry_tells_a_likely_story(world, car) -> None:
    weight_n = 9.81 * car.get_physics_control().mass
    ticks(world, 40)  # without a pedal it takes a second until friction holds it
    still = car.get_telemetry_data()
    assert sum(wheel.tire_load for wheel in still.wheels) == pytest.approx(weight_n, rel=0.02)
    assert sum(wheel.normalized_tire_load for wheel in still.wheels) == pytest.approx(4.0, rel=0.02)
    assert (still.speed, still.throttle, still.drag) == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    car.apply_control(carla.VehicleControl(throttle=0.75, steer=0.125))
    ticks(world, 40)
    seen = car.get_telemetry_data()
    assert (seen.throttle, seen.steer, seen.brake) == (0.75, 0.125, 0.0)
    ahead = car.get_transform().get_forward_vector()
    assert seen.speed == pytest.approx(car.get_velocity().dot(ahead), abs=0.05)
    assert seen.gear == car.get_control().gear
    assert 500.0 < seen.engine_rpm <= car.get_physics_control().max_rpm
    assert 0.0 < seen.drag < 500.0
    for wheel in seen.wheels:
        assert 0.0 < wheel.normalized_tire_load < 2.5
        assert wheel.tire_friction == pytest.approx(car.get_physics_control().wheels[0].tire_friction)
        assert wheel.omega * 0.3 == pytest.approx(seen.speed, rel=0.5)
        assert abs(wheel.lat_slip) < 20.0  # degrees
        assert abs(wheel.long_slip) < 1.0
        assert wheel.normalized_long_force >= 0.0
        assert wheel.normalized_lat_force >= 0.0
        grip_n = wheel.tire_friction * wheel.tire_load
        assert math.hypot(wheel.long_force, wheel.lat_force) <= grip_n * 1.001
    assert sum(wheel.torque for wheel in seen.wheels) > 0.0
    outer, inner = seen.wheels[0], seen.wheels[1]  # it turns to the right
    assert outer.tire_load > inner.tire_load
    car.apply_control(carla.VehicleControl(throttle=0.5, reverse=True, brake=0.0))
    ticks(world, 120)
    assert car.get_telemetry_data().speed < -1.0


def test_other_engines_are_refused_by_name_and_the_own_one_is_always_there(world, car, server: RunningServer) -> None:
    car.enable_carsim("a.sim")
    car.use_carsim_road(True)
    car.enable_chrono_physics(100, 0.01, "v.json", "p.json", "t.json", "folder")
    car.show_debug_telemetry(True)
    car.restore_physx_physics()
    car.show_debug_telemetry(False)
    car.apply_control(carla.VehicleControl(throttle=0.5))
    ticks(world, 60)
    for sentence in (
        "CarSim is not here: it would need",
        "nor are its roads",
        "Chrono is not here",
        "no spectator window",
    ):
        assert server.log().count(sentence) == 1
    assert "restore_physx_physics" not in server.log()
    assert car.get_velocity().length() > 1.0


def test_ackermann_settings_come_back_and_rule_how_a_target_speed_is_reached(world, car) -> None:
    settings = carla.AckermannControllerSettings(0.25, 0.125, 0.5, 0.0625, 0.03125, 0.015625)
    car.apply_ackermann_controller_settings(settings)
    world.tick()
    assert values(car.get_ackermann_controller_settings()) == values(settings)
    car.apply_ackermann_controller_settings(carla.AckermannControllerSettings(0.15, 0.0, 0.25, 0.01, 0.0, 0.01))
    car.apply_ackermann_control(carla.VehicleAckermannControl(steer=0.02, steer_speed=0.2, speed=4.0))
    ticks(world, 120)
    assert car.get_velocity().length() == pytest.approx(4.0, abs=0.6)
    assert math.radians(car.get_wheel_steer_angle(WHEEL.FR_Wheel)) == pytest.approx(0.02, abs=0.004)
    car.apply_ackermann_control(carla.VehicleAckermannControl(speed=0.0))
    ticks(world, 120)
    assert car.get_velocity().length() < 0.2


def test_a_bicycle_has_two_wheels_and_answers_four_that_come_back_as_they_were_set(world, point) -> None:
    bike = spawned(world, "vehicle.bh.crossbike", point)
    assert bike.attributes["number_of_wheels"] == "2"
    control = bike.get_physics_control()
    wheels = list(control.wheels)
    assert len(wheels) == 4
    for k, wheel in enumerate(wheels):
        wheel.tire_friction = 2.0 + 0.25 * k
    control.wheels = wheels
    bike.apply_physics_control(control)
    ticks(world, 1)
    assert [wheel.tire_friction for wheel in bike.get_physics_control().wheels] == [2.0, 2.25, 2.5, 2.75]
    assert len(bike.get_telemetry_data().wheels) == 4


@pytest.mark.parametrize(("sticky", "kept"), [("True", 0.5), ("False", 0.0)])
def test_a_control_acts_once_or_until_the_next_as_the_attribute_says(world, point, sticky: str, kept: float) -> None:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    blueprint.set_attribute("sticky_control", sticky)
    car = world.spawn_actor(blueprint, point)
    car.apply_control(carla.VehicleControl(throttle=0.5))
    ticks(world, 1)
    assert car.get_control().throttle == 0.5
    ticks(world, 1)
    assert car.get_control().throttle == kept


def test_switching_an_autopilot_off_takes_the_foot_from_the_pedal(server: RunningServer, world, car) -> None:
    with RawClient(server.port) as raw:  # the official client would start a Traffic Manager
        raw.call("set_actor_autopilot", car.id, True)
        car.apply_control(carla.VehicleControl(throttle=0.5))
        ticks(world, 2)
        assert car.get_control().throttle == 0.5
        raw.call("set_actor_autopilot", car.id, False)
        ticks(world, 1)
        assert car.get_control().throttle == 0.0
