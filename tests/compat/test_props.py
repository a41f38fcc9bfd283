"""Props through the official client: what is pushed away, what stands fast, how it falls and comes to rest."""

import math

import carla
import pytest

from spawn_points import spawn_point

STEP_S = 0.05


@pytest.fixture
def point(world: carla.World) -> carla.Transform:
    return spawn_point(world, 100)


def ticks(world: carla.World, count: int) -> None:
    for _ in range(count):
        world.tick()


def prop(
    world: carla.World, name: str, at: carla.Transform, ahead_m: float, aside_m: float = 0.0, **attributes: object
) -> carla.Actor:
    """Put a prop onto the road before a place."""
    blueprint = world.get_blueprint_library().find(f"static.prop.{name}")
    for key, value in attributes.items():
        blueprint.set_attribute(key, str(value))
    place = at.transform(carla.Location(x=ahead_m, y=aside_m))
    place.z = world.get_map().get_waypoint(place).transform.location.z
    return world.spawn_actor(blueprint, carla.Transform(place, at.rotation))


def rammed(world: carla.World, point: carla.Transform, thing: carla.Actor, speed_mps: float = 10.0) -> float:
    """Let a car run into a thing 15 m ahead and brake; returns how far the thing was pushed, m."""
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), point)
    ticks(world, 20)
    begin = thing.get_location()
    car.set_target_velocity(car.get_transform().get_forward_vector() * speed_mps)
    ticks(world, 26)
    car.apply_control(carla.VehicleControl(brake=1.0))
    ticks(world, 80)
    assert thing.get_velocity().length() == 0.0
    assert thing.get_angular_velocity().length() == 0.0
    car.destroy()
    return thing.get_location().distance(begin)


def test_a_car_throws_a_cone_pushes_a_barrier_and_hardly_moves_a_container(world, point) -> None:
    pushed_m = {}
    for name in ("trafficcone01", "streetbarrier", "container"):
        thing = prop(world, name, point, 15.0)
        thing.set_simulate_physics(True)
        pushed_m[name] = rammed(world, point, thing)
        thing.destroy()
    assert pushed_m["trafficcone01"] > 6.0
    assert pushed_m["streetbarrier"] > 6.0
    assert 0.5 < pushed_m["container"] < 0.7 * pushed_m["trafficcone01"]


def test_what_stands_fast_is_let_go_by_its_physics_and_held_again(world, point) -> None:
    container = prop(world, "container", point, 15.0)
    assert rammed(world, point, container) == 0.0
    container.set_simulate_physics(True)
    assert rammed(world, point, container) > 0.5
    cone = prop(world, "constructioncone", point, 15.0, 3.0)
    cone.set_simulate_physics(False)
    cone.set_target_velocity(carla.Vector3D(5.0, 0.0, 0.0))
    ticks(world, 5)
    assert cone.get_velocity().length() == 0.0


def test_a_hit_beside_its_middle_turns_a_prop(world, point) -> None:
    box = prop(world, "streetbarrier", point, 15.0, 0.9)
    yaw = box.get_transform().rotation.yaw
    rammed(world, point, box)
    assert abs(math.remainder(box.get_transform().rotation.yaw - yaw, 360.0)) > 5.0


def test_a_mesh_has_the_mass_and_scale_of_its_attributes(world, point) -> None:
    pushed_m = []
    for mass_kg in (20.0, 2000.0):
        mesh = prop(world, "mesh", point, 15.0, mass=mass_kg, scale=0.8)
        assert mesh.bounding_box.extent.x == pytest.approx(0.4)
        pushed_m.append(rammed(world, point, mesh))
        mesh.destroy()
    assert pushed_m[0] > 2.0 * pushed_m[1] > 0.0
    fixed = prop(world, "mesh", point, 15.0)
    assert rammed(world, point, fixed) == 0.0
    blueprint = world.get_blueprint_library().find("static.prop.mesh")
    blueprint.set_attribute("scale", "0")
    with pytest.raises(RuntimeError, match="needs a scale above 0"):
        world.spawn_actor(blueprint, point)


def test_a_prop_falls_floats_and_slides_to_a_stop(world, point) -> None:
    high = carla.Transform(point.location + carla.Location(z=5.0), point.rotation)
    crate = world.spawn_actor(world.get_blueprint_library().find("static.prop.box01"), high)
    crate.set_enable_gravity(False)
    ticks(world, 20)
    assert crate.get_location().z == pytest.approx(high.location.z, abs=1e-4)
    crate.set_enable_gravity(True)
    ticks(world, 10)
    assert crate.get_velocity().z == pytest.approx(-9.81 * 10 * STEP_S, rel=0.01)
    ticks(world, 60)
    assert crate.get_velocity().length() == 0.0
    begin = crate.get_location()
    crate.add_impulse(point.get_forward_vector() * (4.0 * 60.0 * 0.65 * 0.65 * 0.69))  # 4 m/s by its mass
    ticks(world, 40)
    assert crate.get_velocity().length() == 0.0
    assert crate.get_location().distance(begin) == pytest.approx(4.0**2 / (2.0 * 0.6 * 9.81), rel=0.15)


def test_without_collisions_a_cone_is_driven_through(world, point) -> None:
    cone = prop(world, "trafficcone01", point, 15.0)
    cone.set_collisions(False)
    assert rammed(world, point, cone) == 0.0


def test_a_car_that_hits_a_cone_gets_a_collision_event(world, point) -> None:
    cone = prop(world, "trafficcone01", point, 15.0)
    library = world.get_blueprint_library()
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), point)
    sensor = world.spawn_actor(library.find("sensor.other.collision"), carla.Transform(), attach_to=car)
    hits: list[tuple[int, float]] = []
    sensor.listen(lambda event: hits.append((event.other_actor.id, event.normal_impulse.length())))
    ticks(world, 20)
    car.set_target_velocity(car.get_transform().get_forward_vector() * 10.0)
    ticks(world, 40)
    sensor.stop()
    ticks(world, 3)
    sensor.destroy()
    world.tick()
    assert hits
    assert {other for other, _ in hits} == {cone.id}
    assert sum(impulse for _, impulse in hits) > 40.0  # 7 kg to about 10 m/s
