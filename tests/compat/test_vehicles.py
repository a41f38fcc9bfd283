"""Vehicles through the official client: controls, physics control, collisions, limits."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import carla
import pytest

from spawn_points import spawn_point


@pytest.fixture
def car(world: carla.World) -> carla.Vehicle:
    return settled(world, "vehicle.tesla.model3", spawn_point(world, 100))


def settled(world: carla.World, model: str, at: carla.Transform) -> carla.Vehicle:
    vehicle = world.spawn_actor(world.get_blueprint_library().find(model), at)
    for _ in range(20):
        world.tick()
    return vehicle


def test_throttle_drives_and_the_brake_stops(world, car) -> None:
    car.apply_control(carla.VehicleControl(throttle=0.6))
    for _ in range(60):
        world.tick()
    assert car.get_velocity().length() > 4.0
    assert car.get_control().throttle == pytest.approx(0.6)
    car.apply_control(carla.VehicleControl(brake=1.0))
    for _ in range(60):
        world.tick()
    assert car.get_velocity().length() < 0.01


def test_reverse_drives_backwards(world, car) -> None:
    ahead = car.get_transform().get_forward_vector()
    car.apply_control(carla.VehicleControl(throttle=0.5, reverse=True))
    for _ in range(60):
        world.tick()
    assert car.get_velocity().dot(ahead) < -1.0
    assert car.get_control().gear == -1


def test_positive_steer_turns_to_the_right(world, car) -> None:
    begin = car.get_transform().rotation.yaw
    car.apply_control(carla.VehicleControl(throttle=0.4, steer=0.3))
    for _ in range(50):
        world.tick()
    assert 5.0 < (car.get_transform().rotation.yaw - begin) % 360.0 < 180.0
    assert car.get_wheel_steer_angle(carla.VehicleWheelLocation.FL_Wheel) > 1.0


def test_physics_control_comes_back_as_it_was_given(world, car) -> None:
    control = car.get_physics_control()
    assert len(control.wheels) == 4
    control.mass = 2222.0
    control.torque_curve = [carla.Vector2D(0.0, 300.0), carla.Vector2D(4000.0, 100.0)]
    car.apply_physics_control(control)
    world.tick()
    after = car.get_physics_control()
    assert after.mass == pytest.approx(2222.0)
    assert [(point.x, point.y) for point in after.torque_curve] == [(0.0, 300.0), (4000.0, 100.0)]
    wheel, centre = after.wheels[0].position, car.get_location()
    assert math.hypot(wheel.x / 100.0 - centre.x, wheel.y / 100.0 - centre.y) < 3.0  # cm, in the world


def test_the_speed_limit_is_that_of_the_road(world, car) -> None:
    assert car.get_speed_limit() == pytest.approx(35 * 1.609344, abs=0.01) or car.get_speed_limit() == pytest.approx(
        25 * 1.609344, abs=0.01
    )


class Impact(NamedTuple):
    """What is kept of a collision: plain values, for the client's own objects must not outlive their episode."""

    own_id: int
    other_id: int
    impulse_ns: float


def impact(event: carla.CollisionEvent) -> Impact:
    return Impact(event.actor.id, event.other_actor.id, event.normal_impulse.length())


@contextmanager
def heard(world: carla.World, name: str, car: carla.Vehicle, note: Callable[[Any], Any]) -> Iterator[list[Any]]:
    """Yield the notes that are taken of a sensor's events; at the end nothing of the sensor is under way any more."""
    sensor = world.spawn_actor(world.get_blueprint_library().find(name), carla.Transform(), attach_to=car)
    notes: list[Any] = []
    sensor.listen(lambda event: notes.append(note(event)))
    yield notes
    sensor.stop()
    for _ in range(3):
        world.tick()
    sensor.destroy()
    world.tick()


def test_a_collision_event_names_the_other_actor(world, car) -> None:
    ahead = car.get_transform()
    ahead.location += ahead.get_forward_vector() * 10.0
    ahead.location.z += 0.5
    other = settled(world, "vehicle.audi.tt", ahead)
    with heard(world, "sensor.other.collision", car, impact) as impacts:
        car.set_target_velocity(car.get_transform().get_forward_vector() * 8.0)
        for _ in range(60):
            world.tick()
    assert {(found.own_id, found.other_id) for found in impacts} == {(car.id, other.id)}
    assert impacts[0].impulse_ns > 1000.0


def test_lights_are_kept(world, car) -> None:
    state = carla.VehicleLightState(carla.VehicleLightState.Position | carla.VehicleLightState.LowBeam)
    car.set_light_state(state)
    world.tick()
    assert car.get_light_state() == state
    assert world.get_vehicles_light_states()[car.id] == state


def test_crossing_a_lane_is_noticed_by_the_clients_own_sensor(world, car) -> None:
    with heard(world, "sensor.other.lane_invasion", car, lambda event: len(event.crossed_lane_markings)) as crossed:
        car.apply_control(carla.VehicleControl(throttle=0.5, steer=-0.3))
        for _ in range(80):
            world.tick()
    assert any(crossed)
