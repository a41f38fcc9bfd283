"""Walkers through the official client: its crowd on our mesh, crossings at crosswalks, bones, poses, sockets."""

import math
from collections.abc import Callable

import carla
import pytest

from fakes.own_map import world_of
from opendrive_texts import street_through_junction
from servers import RunningServer
from spawn_points import spawn_point

CROSSWALK = (
    '<object id="c" type="crosswalk" name="crosswalk" s="30" t="0" zOffset="0" hdg="0" orientation="none"><outline>'
    + "".join(
        f'<cornerLocal u="{u}" v="{v}" z="0" height="0"/>'
        for u, v in ((-1.5, -3.5), (1.5, -3.5), (1.5, 3.5), (-1.5, 3.5), (-1.5, -3.5))
    )
    + "</outline></object>"
)
HALF_M = 0.93


def synchronous(world: carla.World) -> carla.World:
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
    world.apply_settings(settings)
    return world


@pytest.fixture
def generated(server: RunningServer) -> Callable[[str], carla.World]:
    """What makes a world of a text."""
    return lambda text: synchronous(world_of(server.port, text))


def spawn(world: carla.World, place: carla.Location, number: int = 1) -> tuple[carla.Walker, carla.WalkerAIController]:
    blueprints = world.get_blueprint_library()
    walker = world.spawn_actor(
        blueprints.find(f"walker.pedestrian.{number:04}"), carla.Transform(place + carla.Location(z=1.0))
    )
    controller = world.spawn_actor(blueprints.find("controller.ai.walker"), carla.Transform(), walker)
    world.tick()
    return walker, controller


def test_random_places_lie_on_pavements_all_over_the_map(world) -> None:
    world.set_pedestrians_seed(3)
    street_map, places = world.get_map(), [world.get_random_location_from_navigation() for _ in range(150)]
    for place in places:
        found = street_map.get_waypoint(place, project_to_road=True, lane_type=carla.LaneType.Sidewalk)
        away = found.transform.location - place
        # the mesh keeps 0.2 m clear of the edges and follows them to 0.3 m
        assert math.hypot(away.x, away.y) < 0.5 * found.lane_width + 0.1
        assert 0.0 <= place.z - found.transform.location.z < 0.5  # the waypoint is not lifted by the kerb
    assert len({(place.x // 500, place.y // 500) for place in places}) > 10


def test_a_crowd_walks_and_stands_on_the_ground(world) -> None:
    world.set_pedestrians_seed(5)
    pairs = [spawn(world, world.get_random_location_from_navigation(), n + 1) for n in range(8)]
    for _, controller in pairs:
        controller.start()
        controller.go_to_location(world.get_random_location_from_navigation())
        controller.set_max_speed(1.4)
    walked_m = dict.fromkeys((walker.id for walker, _ in pairs), 0.0)
    for _ in range(100):
        before = {walker.id: walker.get_location() for walker, _ in pairs}
        world.tick()
        for walker, _ in pairs:
            walked_m[walker.id] += walker.get_location().distance(before[walker.id])
    for walker, _ in pairs:
        feet = walker.get_location() - carla.Location(z=walker.bounding_box.extent.z)
        assert 4.0 < walked_m[walker.id] < 7.5
        assert abs(world.ground_projection(feet + carla.Location(z=0.3), 1.0).location.z - feet.z) < 0.01
        speed = walker.get_velocity().length()
        assert speed == pytest.approx(1.4, abs=0.2)
        assert walker.get_control().speed == pytest.approx(speed, abs=0.2)
    for _, controller in pairs:
        controller.stop()
    world.tick()


def test_walkers_that_may_not_cross_roads_stay_on_the_crosswalk(generated) -> None:
    street = generated(street_through_junction(objects=CROSSWALK))  # two pavements, one crosswalk at x = 30 m
    street.set_pedestrians_cross_factor(0.0)
    walker, controller = spawn(street, carla.Location(5.0, 4.3, 0.15))
    controller.start()
    controller.go_to_location(carla.Location(45.0, -4.3, 0.15))
    controller.set_max_speed(2.5)
    crossed = set()
    for _ in range(560):
        street.tick()
        place = walker.get_location()
        if abs(place.y) < 3.4:
            crossed.add(round(place.x))
        if place.y < -3.6 and place.x > 40.0:
            break
    else:
        pytest.fail(f"it never arrived: {walker.get_location()}")
    assert crossed
    assert crossed <= set(range(28, 33))
    controller.stop()
    street.tick()


def test_a_map_without_pavements_has_no_places_for_walkers(client, generated) -> None:
    world = generated(street_through_junction().replace('type="sidewalk"', 'type="shoulder"'))
    world.tick()
    assert client.get_required_files("Nav", False) == []
    assert world.get_random_location_from_navigation() is None


def test_files_are_named_by_their_content_and_others_are_refused(client, world) -> None:
    (name,) = client.get_required_files("Nav", False)
    assert name.startswith("Carla/Maps/Nav/Linden_")
    assert client.get_required_files("", False) == [name]
    assert client.get_required_files("TM", False) == []
    with pytest.raises(RuntimeError, match="secrets' not found on this server"):
        client.request_file("../../secrets")


@pytest.fixture
def walker(world) -> carla.Walker:
    walker = world.spawn_actor(world.get_blueprint_library().find("walker.pedestrian.0001"), spawn_point(world, 100))
    for _ in range(20):
        world.tick()
    return walker


def bones(walker: carla.Walker) -> dict[str, carla.Transform]:
    return {bone.name: bone.component for bone in walker.get_bones().bone_transforms}


def test_a_walkers_bones_stand_over_its_feet_and_step_as_it_walks(world, walker) -> None:
    found = walker.get_bones().bone_transforms
    assert [bone.name for bone in found] == list(walker.get_bone_names()) == list(walker.get_socket_names())
    head = next(bone for bone in found if bone.name == "crl_Head__C")
    assert 1.5 < head.world.location.z - (walker.get_location().z - HALF_M) < 1.8
    standing = bones(walker)["crl_foot__L"].location
    walker.apply_control(carla.WalkerControl(carla.Vector3D(1.0, 0.0, 0.0), 1.4))
    swings = []
    for _ in range(40):
        world.tick()
        swings.append(bones(walker)["crl_foot__L"].location.x - standing.x)
    assert max(swings) - min(swings) > 0.4


def test_a_custom_pose_is_shown_as_far_as_it_is_blended_in(world, walker) -> None:
    raised = carla.Transform(bones_in_parent(walker)["crl_arm__L"].location, carla.Rotation(roll=90.0))
    hanging = bones(walker)["crl_hand__L"].location.z
    walker.set_bones(carla.WalkerBoneControlIn([("crl_arm__L", raised)]))
    world.tick()
    assert bones(walker)["crl_hand__L"].location.z == pytest.approx(hanging, abs=1e-3)
    heights = []
    for share in (0.5, 1.0):
        walker.blend_pose(share)
        world.tick()
        heights.append(bones(walker)["crl_hand__L"].location.z)
    assert hanging < heights[0] < heights[1]
    assert heights[1] == pytest.approx(bones(walker)["crl_arm__L"].location.z, abs=0.1)
    walker.hide_pose()
    world.tick()
    assert bones(walker)["crl_hand__L"].location.z == pytest.approx(hanging, abs=1e-3)


def bones_in_parent(walker: carla.Walker) -> dict[str, carla.Transform]:
    return {bone.name: bone.relative for bone in walker.get_bones().bone_transforms}


def test_what_is_attached_to_a_bone_goes_where_it_goes(world, walker) -> None:
    sensor = world.spawn_actor(
        world.get_blueprint_library().find("sensor.other.gnss"),
        carla.Transform(),
        walker,
        carla.AttachmentType.Rigid,
        "crl_hand__R",
    )
    walker.apply_control(carla.WalkerControl(carla.Vector3D(0.0, 1.0, 0.0), 1.4))
    for _ in range(25):
        world.tick()
        hand = next(bone.world for bone in walker.get_bones().bone_transforms if bone.name == "crl_hand__R")
        assert sensor.get_location().distance(hand.location) < 0.01
    with pytest.raises(RuntimeError, match="the parent has no socket or bone 'tail'"):
        world.spawn_actor(
            world.get_blueprint_library().find("sensor.other.gnss"),
            carla.Transform(),
            walker,
            carla.AttachmentType.Rigid,
            "tail",
        )


def test_a_vehicles_bones_are_its_wheels(world) -> None:
    point = spawn_point(world, 120)
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), point)
    for _ in range(20):
        world.tick()
    names = list(car.get_bone_names())
    places = dict(zip(names, car.get_bone_relative_transforms(), strict=True))
    assert names[0] == "Vehicle_Base"
    assert places["Wheel_Front_Left"].location.x > 0.0 > places["Wheel_Rear_Left"].location.x
    assert places["Wheel_Front_Left"].location.y < 0.0 < places["Wheel_Front_Right"].location.y
    in_world = car.get_transform().transform(places["Wheel_Rear_Right"].location)
    wheel = dict(zip(names, car.get_vehicle_bone_world_transforms(), strict=True))["Wheel_Rear_Right"]
    assert wheel.location.distance(carla.Location(in_world)) < 0.01
    assert car.get_component_world_transform("VehicleMesh").location.distance(car.get_location()) < 1e-3
    with pytest.raises(RuntimeError, match="Component could not be found in this actor"):
        car.get_component_relative_transform("Spoiler")
