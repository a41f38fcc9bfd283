"""The ways on which ScenarioRunner's classes go, call by call, without ScenarioRunner: small scenarios in its manner.

Each test is one of its behaviours as ``docs/how-to/scenario-runner.md`` names them, made of the same calls in the same
order.
"""

import math
from collections.abc import Callable, Iterator

import carla
import pytest

STREET = carla.Location(952.3, -332.6, 251.8)
"""A street of one lane each way, straight for 300 m."""
LIGHTS = carla.Location(145.0, -756.0, 254.5)
"""A junction with four lights."""
EPSILON_MPS = 0.001


@pytest.fixture
def street(world: carla.World) -> carla.Waypoint:
    waypoint = world.get_map().get_waypoint(STREET)
    assert waypoint is not None
    return waypoint.next(12.0)[0]


@pytest.fixture
def brought(world: carla.World) -> Iterator[list[carla.Actor]]:
    """Who came; taken away at the end, sensors first."""
    actors: list[carla.Actor] = []
    yield actors
    for actor in reversed(actors):
        if actor.is_alive:
            actor.destroy()
    world.tick()


def new_actor(
    world: carla.World, brought: list[carla.Actor], model: str, place: carla.Transform, **filters: object
) -> carla.Actor:
    """``CarlaDataProvider.request_new_actor``: filtered by attributes, lifted a little, awaited for a tick."""
    blueprints = list(world.get_blueprint_library().filter(model))
    for name, wanted in filters.items():
        blueprints = [each for each in blueprints if each.has_attribute(name) and value_of(each, name) == wanted]
    blueprint = min(blueprints, key=lambda each: str(each.id))
    if blueprint.has_attribute("role_name"):
        blueprint.set_attribute("role_name", "scenario")
    lift_m = 0.0 if "prop" in model else 0.2
    lifted = carla.Transform(place.location + carla.Location(z=lift_m), place.rotation)
    actor = world.try_spawn_actor(blueprint, lifted)
    assert actor is not None, f"{model} found no room"
    brought.append(actor)
    world.tick()
    return actor


def value_of(blueprint: carla.ActorBlueprint, name: str) -> object:
    """An attribute in its own type, as ScenarioRunner asks for it."""
    attribute = blueprint.get_attribute(name)
    by_type: dict[carla.ActorAttributeType, Callable[[], object]] = {
        carla.ActorAttributeType.Bool: attribute.as_bool,
        carla.ActorAttributeType.Int: attribute.as_int,
        carla.ActorAttributeType.Float: attribute.as_float,
        carla.ActorAttributeType.String: attribute.as_str,
    }
    return by_type[attribute.type]()


def lower(place: carla.Transform, by_m: float) -> carla.Transform:
    return carla.Transform(place.location - carla.Location(z=by_m), place.rotation)


def test_an_actor_waits_far_below_and_is_put_on_the_road(world, street, brought) -> None:
    """ActorTransformSetter: without physics 500 m under the street, then 1 m above it with physics again."""
    visible = street.transform
    visible.location.z += 1.0
    leader = new_actor(world, brought, "vehicle.nissan.patrol", lower(visible, 501.0))
    leader.set_simulate_physics(enabled=False)
    for _ in range(20):
        world.tick()
    assert leader.get_location().z == pytest.approx(visible.location.z - 500.8, abs=0.1)
    leader.set_target_velocity(carla.Vector3D(0.0, 0.0, 0.0))
    leader.set_target_angular_velocity(carla.Vector3D(0.0, 0.0, 0.0))
    leader.set_transform(visible)
    world.tick()
    assert leader.get_location().distance(visible.location) < 1.0
    leader.set_simulate_physics(enabled=True)
    for _ in range(40):
        world.tick()
    away = leader.get_location() - street.transform.location
    assert math.hypot(away.x, away.y) < 0.3
    assert away.z == pytest.approx(0.0, abs=0.2)


def test_a_vehicle_keeps_its_velocity_and_then_stops(world, street, brought) -> None:
    """KeepVelocity by ``set_target_velocity`` along the heading, DriveDistance, StopVehicle."""
    leader = new_actor(world, brought, "vehicle.tesla.model3", street.transform)
    begin = leader.get_location()
    for _ in range(60):
        yaw_rad = math.radians(leader.get_transform().rotation.yaw)
        leader.set_target_velocity(carla.Vector3D(8.0 * math.cos(yaw_rad), 8.0 * math.sin(yaw_rad), 0.0))
        world.tick()
    velocity = leader.get_velocity()
    assert math.hypot(velocity.x, velocity.y) == pytest.approx(8.0, abs=0.3)
    assert leader.get_location().distance(begin) == pytest.approx(24.0, abs=1.0)
    control = carla.VehicleControl()
    control.brake, control.hand_brake = 1.0, True
    leader.apply_control(control)
    for _ in range(80):
        world.tick()
    velocity = leader.get_velocity()
    assert math.hypot(velocity.x, velocity.y) < EPSILON_MPS


def test_the_ego_rolls_over_debris_on_projected_ground(world, street, brought) -> None:
    """ControlLoss: ``ground_projection``, a flat prop without physics, and no collision by it."""
    ahead = street.next(14.0)[0].transform
    ground = world.ground_projection(ahead.location + carla.Location(z=1.0), 2.0)
    assert ground is not None
    assert ground.location.z == pytest.approx(ahead.location.z, abs=0.2)
    debris = new_actor(world, brought, "static.prop.dirtdebris01", carla.Transform(ground.location, ahead.rotation))
    debris.set_simulate_physics(enabled=False)
    ego = new_actor(world, brought, "vehicle.lincoln.mkz_2017", street.transform)
    hits: list[int] = []
    sensor = world.spawn_actor(
        world.get_blueprint_library().find("sensor.other.collision"), carla.Transform(), attach_to=ego
    )
    brought.append(sensor)
    sensor.listen(lambda event: hits.append(event.frame))
    for _ in range(120):
        ego.apply_control(carla.VehicleControl(throttle=0.8))
        world.tick()
    assert ego.get_location().distance(street.transform.location) > 25.0
    sensor.stop()
    for _ in range(3):
        world.tick()
    assert hits == []


def test_a_hidden_walker_is_put_on_the_pavement_and_crosses(world, street, brought) -> None:
    """DynamicObjectCrossing: ``set_location`` far below, ``set_transform``, and a WalkerControl each frame."""
    start = street.next(30.0)[0].transform
    right = start.get_right_vector()
    start.location += carla.Location(6.0 * right.x, 6.0 * right.y, 1.2)
    start.rotation.yaw -= 90.0
    walker = new_actor(world, brought, "walker.pedestrian.0001", lower(start, 50.0))
    walker.set_simulate_physics(enabled=False)
    walker.set_location(walker.get_location() + carla.Location(z=-50.0))
    world.tick()
    assert walker.get_location().z < start.location.z - 90.0
    walker.set_transform(start)
    world.tick()
    assert walker.get_location().distance(start.location) < 1.0
    walker.set_simulate_physics(enabled=True)
    for _ in range(100):
        walker.apply_control(carla.WalkerControl(walker.get_transform().get_forward_vector(), 2.0, False))
        world.tick()
    gone = walker.get_location() - start.location
    assert math.hypot(gone.x, gone.y) == pytest.approx(10.0, abs=0.6)
    assert gone.x * right.x + gone.y * right.y == pytest.approx(-10.0, abs=0.6)  # across, to the left


def test_the_lights_of_a_junction_are_held_by_their_times(world, brought) -> None:
    """TrafficLightFreezer: states and times set light by light, and given back."""
    entry = world.get_map().get_waypoint(LIGHTS)
    junction = entry.get_junction()
    lights = world.get_traffic_lights_in_junction(junction.id)
    assert len(lights) == 4
    before = [(light.get_green_time(), light.get_yellow_time(), light.get_red_time()) for light in lights]
    wanted = {
        light.id: carla.TrafficLightState.Green if number == 0 else carla.TrafficLightState.Red
        for number, light in enumerate(lights)
    }
    for light in lights:
        held_s = 10000.0 + light.get_elapsed_time()
        light.set_state(wanted[light.id])
        light.set_green_time(held_s)
        light.set_red_time(held_s)
        light.set_yellow_time(held_s)
    for _ in range(400):
        world.tick()
    assert {light.id: light.get_state() for light in lights} == wanted
    for light, (green_s, yellow_s, red_s) in zip(lights, before, strict=True):
        light.set_green_time(green_s)
        light.set_yellow_time(yellow_s)
        light.set_red_time(red_s)
    world.tick()
    assert [(light.get_green_time(), light.get_yellow_time(), light.get_red_time()) for light in lights] == before


def test_an_emergency_vehicle_and_a_flow_are_found_by_attributes(world, street, brought) -> None:
    """OppositeVehicleJunction and ActorFlow: attribute filters, special lamps, constant velocity."""
    emergency = new_actor(world, brought, "vehicle.*", street.next(60.0)[0].transform, special_type="emergency")
    lamps = emergency.get_light_state()
    lamps |= carla.VehicleLightState.Special1 | carla.VehicleLightState.Special2
    emergency.set_light_state(carla.VehicleLightState(lamps))
    world.tick()
    assert emergency.get_light_state() & carla.VehicleLightState.Special1
    car = new_actor(world, brought, "vehicle.*", street.transform, base_type="car", has_lights=True, special_type="")
    car.enable_constant_velocity(carla.Vector3D(8.0, 0.0, 0.0))
    begin = car.get_location()
    for _ in range(40):
        world.tick()
    assert car.get_location().distance(begin) == pytest.approx(16.0, abs=1.0)
    car.disable_constant_velocity()
