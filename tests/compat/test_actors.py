"""Actors through the official client: spawning, refusing, attaching, moving, destroying, batches."""

import queue
import time

import carla
import pytest

from fakes.raw_client import RawClient
from spawn_points import spawn_point


@pytest.fixture
def blueprints(world: carla.World) -> carla.BlueprintLibrary:
    return world.get_blueprint_library()


@pytest.fixture
def point(world: carla.World) -> carla.Transform:
    return spawn_point(world, 100)


@pytest.fixture
def car(world: carla.World, blueprints: carla.BlueprintLibrary, point: carla.Transform) -> carla.Vehicle:
    vehicle = world.spawn_actor(blueprints.find("vehicle.tesla.model3"), point)
    for _ in range(20):  # it lands
        world.tick()
    return vehicle


def test_the_library_holds_carlas_vehicles_and_the_shuttle(blueprints) -> None:
    assert len(blueprints.filter("vehicle.*")) == 41 + 1
    assert len(blueprints.filter("walker.pedestrian.*")) == 52
    shuttle = blueprints.find("vehicle.easymile.ez10")
    assert int(shuttle.get_attribute("number_of_wheels")) == 4


def test_spawning_where_something_stands_is_refused_in_carlas_words(world, blueprints, car, point) -> None:
    with pytest.raises(
        RuntimeError, match=r"^Spawn failed because of collision at spawn position.*actor [0-9]+"
    ) as info:
        world.spawn_actor(blueprints.find("vehicle.audi.tt"), point)
    assert "nearest free spawn point" in str(info.value)
    assert world.try_spawn_actor(blueprints.find("vehicle.audi.tt"), point) is None


def test_an_attached_sensor_follows_its_vehicle(world, blueprints, car) -> None:
    place = carla.Transform(carla.Location(x=1.0, z=2.0), carla.Rotation(yaw=90.0))
    sensor = world.spawn_actor(blueprints.find("sensor.other.gnss"), place, attach_to=car)
    car.apply_control(carla.VehicleControl(throttle=0.5))
    for _ in range(40):
        world.tick()
    expected = car.get_transform().transform(carla.Location(x=1.0, z=2.0))
    assert sensor.get_location().distance(expected) < 1e-3
    assert sensor.parent.id == car.id
    turn = (sensor.get_transform().rotation.yaw - car.get_transform().rotation.yaw) % 360.0
    assert turn == pytest.approx(90.0, abs=0.01)


def test_in_asynchronous_mode_the_next_snapshot_comes_at_once_for_what_was_spawned(world, blueprints) -> None:
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = False, 10.0
    world.apply_settings(settings)
    sensor, began_s = world.spawn_actor(blueprints.find("sensor.other.gnss"), carla.Transform()), time.monotonic()
    while not world.get_snapshot().has_actor(sensor.id):
        assert time.monotonic() - began_s < 5.0, "by the clock it comes after ten seconds"


def test_a_sensor_on_a_spring_arm_looks_at_its_vehicle(client, world, blueprints, car) -> None:
    blueprint, behind = blueprints.find("sensor.other.gnss"), carla.Transform(carla.Location(x=-6.0, z=3.0))
    sensor = world.spawn_actor(blueprint, behind, car, carla.AttachmentType.SpringArmGhost)
    rigid = carla.command.SpawnActor(blueprint, behind, car)
    on_arm = carla.command.SpawnActor(blueprint, behind, car, carla.AttachmentType.SpringArmGhost, "")
    answers = client.apply_batch_sync([rigid, on_arm], True)
    pitches = [world.get_actor(found).get_transform().rotation.pitch for found in (sensor.id, answers[1].actor_id)]
    assert pitches == pytest.approx([-26.6, -26.6], abs=1.0)  # the street slopes
    assert world.get_actor(answers[0].actor_id).get_transform().rotation.pitch == pytest.approx(0.0, abs=1.0)


def test_destroying_a_vehicle_leaves_its_sensors_where_they_are(world, blueprints, car) -> None:
    """As ``UActorDispatcher::DestroyActor``: it destroys an actor and its controller; Unreal detaches the rest."""
    sensors = [
        world.spawn_actor(
            blueprints.find(f"sensor.other.{kind}"), carla.Transform(carla.Location(z=2.0)), attach_to=car
        )
        for kind in ("gnss", "imu", "collision", "obstacle")
    ]
    cone = world.spawn_actor(
        blueprints.find("static.prop.trafficcone01"), carla.Transform(carla.Location(x=1.0)), attach_to=sensors[0]
    )
    heard = queue.Queue()
    for sensor in sensors:
        sensor.listen(lambda data, kind=sensor.type_id: heard.put((data.frame, kind)))
    world.tick()
    before = {actor.id: actor.get_transform() for actor in (*sensors, cone)}
    assert car.destroy()
    frame = [world.tick() for _ in range(3)][-1]
    for actor in (*sensors, cone):
        assert actor.is_alive
        assert actor.get_transform() == before[actor.id]
    measured = set()
    while {(frame, "sensor.other.gnss"), (frame, "sensor.other.imu")} - measured:
        measured.add(heard.get(timeout=5.0))
    assert world.get_actor(cone.id).parent.id == sensors[0].id
    for actor in (cone, *sensors):
        assert actor.destroy()
    world.tick()
    assert {car.id, sensor.id}.isdisjoint(actor.id for actor in world.get_actors())


def test_an_actor_of_the_map_cannot_be_destroyed(world) -> None:
    sign = world.get_actors().filter("traffic.stop")[0]
    assert not sign.destroy()
    world.tick()
    assert sign.id in {actor.id for actor in world.get_actors()}


def test_a_teleported_vehicle_is_where_it_was_put(world, car) -> None:
    target = spawn_point(world, 300)
    car.set_transform(target)
    world.tick()
    assert car.get_location().distance(target.location) < 0.1


def test_without_physics_a_vehicle_stays_in_the_air(world, car) -> None:
    car.set_simulate_physics(False)
    high = car.get_transform()
    high.location.z += 5.0
    car.set_transform(high)
    for _ in range(10):
        world.tick()
    assert car.get_location().z == pytest.approx(high.location.z, abs=1e-4)
    car.set_simulate_physics(True)
    for _ in range(60):
        world.tick()
    assert car.get_location().z == pytest.approx(high.location.z - 5.0, abs=0.1)


def test_a_target_velocity_moves_a_vehicle(world, car) -> None:
    ahead = car.get_transform().get_forward_vector()
    car.set_target_velocity(ahead * 5.0)
    world.tick()
    assert car.get_velocity().length() == pytest.approx(5.0, abs=0.5)


def test_a_batch_answers_for_each_of_its_commands(client, world, blueprints, point) -> None:
    spawn = carla.command.SpawnActor
    model = blueprints.find("vehicle.tesla.model3")
    drive = carla.command.ApplyVehicleControl(carla.command.FutureActor, carla.VehicleControl(throttle=1.0))
    answers = client.apply_batch_sync([spawn(model, point).then(drive), spawn(model, point)], True)
    assert not answers[0].has_error()
    assert answers[1].error.startswith("Spawn failed because of collision at spawn position")
    for _ in range(60):
        world.tick()
    assert world.get_actor(answers[0].actor_id).get_velocity().length() > 2.0
    gone = client.apply_batch_sync([carla.command.DestroyActor(answers[0].actor_id)] * 2, True)
    assert [answer.has_error() for answer in gone] == [False, True]


def test_a_function_for_vehicles_refuses_a_walker(client, world, blueprints, point) -> None:
    walker = world.spawn_actor(blueprints.find("walker.pedestrian.0001"), point)
    command = carla.command.ApplyVehicleControl(walker.id, carla.VehicleControl())
    error = client.apply_batch_sync([command], False)[0].error
    assert error == (
        f"Responding error from function apply_control_to_vehicle: Actor is not a Vehicle.  Actor Id: {walker.id}"
    )


def test_a_walker_walks_in_the_direction_of_its_control(world, blueprints, point) -> None:
    walker = world.spawn_actor(blueprints.find("walker.pedestrian.0001"), point)
    for _ in range(20):
        world.tick()
    begin = walker.get_location()
    walker.apply_control(carla.WalkerControl(direction=carla.Vector3D(1.0, 0.0, 0.0), speed=1.5))
    for _ in range(41):
        world.tick()
    assert walker.get_location().x - begin.x == pytest.approx(1.5 * 41 * 0.05, abs=0.15)
    assert walker.get_control().speed == pytest.approx(1.5)


def test_the_spectator_goes_where_it_is_sent(world) -> None:
    target = carla.Transform(carla.Location(1.0, 2.0, 300.0), carla.Rotation(pitch=-30.0, yaw=45.0))
    world.get_spectator().set_transform(target)
    world.tick()
    seen = world.get_spectator().get_transform()
    assert seen.location.distance(target.location) < 1e-4
    assert seen.rotation.pitch == pytest.approx(-30.0, abs=1e-4)


def test_weather_is_kept_as_it_was_set(world) -> None:
    world.set_weather(carla.WeatherParameters.HardRainNoon)
    assert world.get_weather() == carla.WeatherParameters.HardRainNoon


def test_a_walker_led_by_a_crowd_stands_on_the_surface_it_is_put_on(client, world, blueprints, point) -> None:
    walker = world.spawn_actor(blueprints.find("walker.pedestrian.0001"), point)
    surface = world.get_map().get_waypoint(point.location).transform
    surface.rotation.yaw = 30.0
    state = carla.command.ApplyWalkerState(walker.id, surface, 1.3)
    assert not client.apply_batch_sync([state], True)[0].has_error()
    seen = walker.get_transform()
    assert seen.location.z - surface.location.z == pytest.approx(walker.bounding_box.extent.z, abs=0.05)
    assert walker.get_control().speed == pytest.approx(1.3)
    assert walker.get_control().direction.y == pytest.approx(0.5, abs=1e-3)  # the sine of its heading


def test_a_push_from_the_side_moves_a_vehicle_sideways(world, car) -> None:
    begin = car.get_transform()
    side = begin.get_right_vector() * (car.get_physics_control().mass * 3.0)
    car.add_impulse(carla.Vector3D(side.x, side.y, 0.0))
    world.tick()
    assert car.get_velocity().dot(begin.get_right_vector()) > 0.5


def test_the_box_of_a_destroyed_actor_is_empty_and_no_error(server, world, car) -> None:
    # another client's Traffic Manager may ask so, in a thread where an error ends its program
    with RawClient(server.port) as other:
        there = other.call("get_actor_bounding_box", car.id)
        car.destroy()
        gone = other.call("get_actor_bounding_box", car.id)
    assert there[1][0] > 1.0
    assert there[3] == car.id
    assert gone == [[0, 0, 0], [0, 0, 0], [0, 0, 0], 0]


def test_an_old_handle_does_not_act_on_an_actor_of_the_next_episode(client, world, point) -> None:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    old = world.spawn_actor(blueprint, point)
    world = client.reload_world(False)
    new = world.spawn_actor(blueprint, point)
    assert new.id > old.id
    old.set_light_state(carla.VehicleLightState.All)  # the client does not wait for an answer
    world.tick()
    assert new.get_light_state() == carla.VehicleLightState.NONE
