"""Tests of ``basu.agents.builtin.perception``."""

import math
from types import SimpleNamespace

import carla
import pytest

from basu.agents.builtin.perception import (
    OTHERS_TOP_MPS,
    SHUTTLE,
    SHUTTLE_TOP_MPS,
    Lights,
    Steering,
    VehicleFacts,
    read_facts,
    see_ego,
)
from basu.agents.builtin.rules.stopping_lines import Light


def seen(number: int, x_m: float, y_m: float, yaw_deg: float = 0.0) -> SimpleNamespace:
    """One actor of a snapshot."""
    return SimpleNamespace(
        id=number,
        get_transform=lambda: carla.Transform(carla.Location(x_m, y_m, 0.0), carla.Rotation(yaw=yaw_deg)),
        get_velocity=lambda: carla.Vector3D(3.0, 4.0, 0.0),
        get_angular_velocity=lambda: carla.Vector3D(0.0, 0.0, 90.0),
    )


def test_the_own_speed_is_that_along_the_vehicles_axis() -> None:
    snapshot = SimpleNamespace(timestamp=SimpleNamespace(elapsed_seconds=7.5))
    ego = see_ego(snapshot, seen(1, 1.0, 2.0, 90.0), carla.VehicleControl(gear=3, hand_brake=True))
    assert ego[:3] == pytest.approx((7.5, 1.0, 2.0))
    assert ego.speed_mps == pytest.approx(4.0)
    assert ego.gear == 3
    assert ego.parked


def test_lights_are_known_by_their_opendrive_id_and_a_missing_one_is_dark() -> None:
    states = {"12": carla.TrafficLightState.Red, "13": carla.TrafficLightState.Green, "14": carla.TrafficLightState.Off}

    def find(landmark_id: str) -> SimpleNamespace | None:
        state = states.get(landmark_id)
        return None if state is None else SimpleNamespace(get_state=lambda: state)

    lights = Lights(SimpleNamespace(get_traffic_light_from_opendrive_id=find), ["12", "13", "14", "99"])
    assert [lights.shows(i) for i in ("12", "13", "14", "99")] == [Light.RED, Light.GREEN, Light.DARK, Light.DARK]


def vehicle_at(pose: carla.Transform, type_id: str = SHUTTLE, *, wheels_known: bool = True) -> SimpleNamespace:
    wheels = []
    for ahead_m, side_m in ((1.4, 0.8), (1.4, -0.8), (-1.4, 0.8), (-1.4, -0.8)):
        wheel = carla.WheelPhysicsControl()
        at = pose.transform(carla.Location(ahead_m, side_m, 0.3)) if wheels_known else carla.Location()
        wheel.position = carla.Vector3D(100.0 * at.x, 100.0 * at.y, 100.0 * at.z)
        wheel.radius, wheel.max_brake_torque = 32.0, 1000.0
        wheel.max_steer_angle = 40.0 if ahead_m > 0.0 else 0.0
        wheels.append(wheel)
    control = carla.VehiclePhysicsControl()
    control.wheels = wheels
    control.mass, control.final_ratio, control.max_rpm = 2050.0, 10.0, 3400.0
    gear = carla.GearPhysicsControl()
    gear.ratio = 1.0
    control.forward_gears = [gear]
    control.torque_curve = [carla.Vector2D(0.0, 110.0), carla.Vector2D(1389.0, 110.0), carla.Vector2D(3340.0, 0.0)]
    control.steering_curve = [carla.Vector2D(0.0, 1.0), carla.Vector2D(40.0, 0.5)]
    box = carla.BoundingBox(carla.Location(0.1, 0.0, 1.4), carla.Vector3D(2.0, 1.0, 1.4))
    return SimpleNamespace(type_id=type_id, bounding_box=box, get_physics_control=lambda: control)


def facts_at(pose: carla.Transform, type_id: str = SHUTTLE, *, wheels_known: bool = True) -> VehicleFacts:
    return read_facts(vehicle_at(pose, type_id, wheels_known=wheels_known), pose)


@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, -137.0])
def test_axles_are_found_wherever_the_vehicle_stands(yaw_deg: float) -> None:
    body = facts_at(carla.Transform(carla.Location(500.0, -200.0, 248.0), carla.Rotation(yaw=yaw_deg))).body
    assert body.wheelbase_m == pytest.approx(2.8, abs=0.01)
    assert body.rear_axle_m == pytest.approx(1.4, abs=0.01)
    assert (body.front_m, body.rear_m, body.half_width_m) == pytest.approx((2.1, 1.9, 1.0))


def test_a_server_that_does_not_tell_the_wheels_gets_the_usual_wheelbase() -> None:
    body = facts_at(carla.Transform(carla.Location(500.0, -200.0, 248.0)), wheels_known=False).body
    assert body.wheelbase_m == pytest.approx(2.4)


def test_full_pedals_do_what_torque_gear_wheel_and_mass_make_of_them() -> None:
    model = facts_at(carla.Transform()).model
    assert model.throttle_mps2(0.0) == pytest.approx(110.0 * 10.0 / 0.32 / 2050.0, rel=1e-3)
    assert model.throttle_mps2(12.0) < 0.2  # beyond 3400 rpm at 11.4 m/s nothing pulls
    assert model.full_brake_mps2 == pytest.approx(4 * 1000.0 / 0.32 / 2050.0, rel=1e-3)


def test_the_shuttle_has_a_top_speed_of_its_own() -> None:
    assert facts_at(carla.Transform()).top_mps == SHUTTLE_TOP_MPS == pytest.approx(6.7056)
    assert facts_at(carla.Transform(), "vehicle.tesla.model3").top_mps == OTHERS_TOP_MPS


def test_steer_allows_for_what_the_steering_curve_takes_away_at_speed() -> None:
    steering = facts_at(carla.Transform()).steering
    assert steering.command(math.radians(10.0), 0.0) == pytest.approx(0.25)
    assert steering.command(math.radians(10.0), 40.0 / 3.6) == pytest.approx(0.5)
    assert steering.command(-1.5, 0.0) == -1.0
    assert Steering(0.7, (), ()).command(0.35, 5.0) == pytest.approx(0.5)
