"""Boxes, objects, layers and rays of the scene through the official client."""

import math

import carla
import pytest

from opendrive_texts import street_through_junction
from servers import RunningServer
from spawn_points import spawn_point

Label = carla.CityObjectLabel
ANY = [
    Label.Roads, Label.Sidewalks, Label.Buildings, Label.Walls, Label.Fences, Label.Poles, Label.TrafficLight,
    Label.TrafficSigns, Label.Vegetation, Label.Terrain, Label.Pedestrians, Label.Rider, Label.Car, Label.Truck,
    Label.Bus, Label.Motorcycle, Label.Bicycle, Label.Static, Label.Dynamic, Label.Other,
]  # fmt: skip


@pytest.fixture
def car(world: carla.World) -> carla.Actor:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    vehicle = world.spawn_actor(blueprint, spawn_point(world, 40))
    for _ in range(20):
        world.tick()
    return vehicle


@pytest.fixture
def house(world: carla.World) -> carla.EnvironmentObject:
    """Give a house with no porch and no parked car before it."""
    objects = world.get_environment_objects(Label.Buildings)
    others = [item for item in objects if item.name.startswith("Porch")] + world.get_environment_objects(Label.Car)
    places = [item.transform.location for item in others]
    houses = [item for item in objects if item.name.startswith("House")][100:]
    return next(item for item in houses if all(item.transform.location.distance(place) > 12.0 for place in places))


def above(place: carla.Location, height_m: float) -> carla.Location:
    return carla.Location(place.x, place.y, place.z + height_m)


def labels(hits: list[carla.LabelledPoint]) -> list[Label]:
    return [hit.label for hit in hits]


def test_boxes_of_all_tags_are_those_of_any(world, car) -> None:
    everything = world.get_level_bbs(Label.Any)
    assert sum(len(world.get_level_bbs(tag)) for tag in ANY) == len(everything) > 5000
    assert len(world.get_level_bbs()) == len(everything)


def test_an_actor_has_a_box_that_carries_its_id_and_goes_with_it(world, car) -> None:
    parked = len(world.get_environment_objects(Label.Car))
    box = world.get_level_bbs(Label.Car)[-1]
    middle = car.get_transform().transform(car.bounding_box.location)
    assert box.location.distance(middle) < 0.01
    assert box.extent == car.bounding_box.extent
    assert box.rotation.yaw == pytest.approx(car.get_transform().rotation.yaw, abs=0.01)
    car.destroy()
    world.tick()
    assert len(world.get_level_bbs(Label.Car)) == parked


def test_objects_are_those_of_the_map_with_their_own_ids_and_names(world, car) -> None:
    objects = world.get_environment_objects(Label.Any)
    assert len({item.id for item in objects}) == len({item.name for item in objects}) == len(objects) > 5000
    assert all(item.name.startswith("ParkedCar") for item in objects if item.type == Label.Car)
    poles = world.get_environment_objects(Label.Poles)
    assert {item.id for item in poles} == {item.id for item in objects if item.type == Label.Poles}
    named = set(world.get_names_of_all_objects())
    assert all(item.name.rsplit("_", 2)[0] in named for item in objects)


def test_every_light_and_sign_stands_among_the_objects(world) -> None:
    lights = world.get_actors().filter("traffic.traffic_light")
    heads = world.get_environment_objects(Label.TrafficLight)
    assert len(heads) == len(lights) > 0
    for light in lights:
        assert min(light.get_location().distance_2d(head.transform.location) for head in heads) < 0.01


def test_a_light_s_boxes_hang_over_its_pole_higher_than_a_person(world) -> None:
    light = world.get_actors().filter("traffic.traffic_light")[0]
    (box,) = light.get_light_boxes()
    assert box.location.distance_2d(light.get_location()) < 0.5
    assert box.location.z - box.extent.z > light.get_location().z + 2.3
    assert box.extent.z > box.extent.x > 0.1


def test_a_ray_tells_all_it_crosses_in_order(world, car) -> None:
    place = car.get_location()
    hits = world.cast_ray(above(place, 10.0), above(place, -5.0))
    assert labels(hits) == [Label.Car, Label.Roads]
    top_m = place.z + car.bounding_box.location.z + car.bounding_box.extent.z
    assert hits[0].location.z == pytest.approx(top_m, abs=0.05)
    assert hits[1].location.z == pytest.approx(place.z, abs=0.1)
    from_below = world.cast_ray(above(place, -5.0), above(place, 10.0))
    assert set(labels(from_below)) == {Label.Roads, Label.Car}  # the car's box ends about where its wheels do
    assert from_below[0].location.z <= from_below[1].location.z
    assert world.cast_ray(above(place, 10.0), above(place, 5.0)) == []


def test_a_point_is_projected_onto_what_lies_in_a_direction(world, house) -> None:
    place = house.bounding_box.location
    roof = world.ground_projection(above(place, 50.0), 100.0)
    assert roof.label == Label.Buildings
    assert roof.location.z == pytest.approx(place.z + house.bounding_box.extent.z, abs=0.01)
    assert world.ground_projection(above(place, 50.0), 10.0) is None
    front = house.bounding_box.rotation.get_forward_vector()
    before = place - front * 12.0
    wall = world.project_point(before, front * 3.0, 20.0)
    assert wall.label == Label.Buildings
    assert wall.location.distance(before) == pytest.approx(12.0 - house.bounding_box.extent.x, abs=0.01)
    with pytest.raises(RuntimeError, match="points nowhere"):
        world.project_point(before, carla.Vector3D(), 20.0)


def test_beside_the_streets_lies_terrain_and_beyond_the_map_too(world, house) -> None:
    yard = house.bounding_box.location - house.bounding_box.rotation.get_forward_vector() * (
        house.bounding_box.extent.x + 1.0
    )
    assert world.ground_projection(above(yard, 20.0), 100.0).label == Label.Terrain
    assert world.ground_projection(carla.Location(9e4, 9e4, 900.0), 2000.0).label == Label.Terrain


def test_what_is_disabled_is_not_met_not_in_the_way_and_comes_back(world, house) -> None:
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    inside = carla.Transform(above(house.transform.location, 1.0))
    through = above(house.bounding_box.location, 30.0), above(house.bounding_box.location, -30.0)
    assert Label.Buildings in labels(world.cast_ray(*through))
    assert world.try_spawn_actor(blueprint, inside) is None
    world.enable_environment_objects({house.id}, False)
    assert labels(world.cast_ray(*through)) == [Label.Terrain]
    assert house.id in {item.id for item in world.get_environment_objects(Label.Buildings)}
    tenant = world.try_spawn_actor(blueprint, inside)
    assert tenant is not None
    tenant.destroy()
    world.enable_environment_objects({house.id}, True)
    assert world.try_spawn_actor(blueprint, inside) is None


def test_an_unknown_id_is_named_in_the_log(world, server: RunningServer) -> None:
    world.enable_environment_objects({12345}, False)
    world.tick()
    assert "no object has the id 12345" in server.log()


def test_layers_come_and_go_with_all_that_is_in_them(world, house) -> None:
    count = len(world.get_level_bbs(Label.Any))
    houses = len(world.get_level_bbs(Label.Buildings))
    world.enable_environment_objects({house.id}, False)
    world.unload_map_layer(carla.MapLayer.Buildings)
    assert world.get_environment_objects(Label.Buildings) == []
    assert not any(name.startswith("House") for name in world.get_names_of_all_objects())
    assert len(world.get_level_bbs(Label.Any)) == count - houses
    world.load_map_layer(carla.MapLayer.Buildings)
    assert len(world.get_level_bbs(Label.Any)) == count


def test_a_map_can_be_loaded_without_its_layers(client) -> None:
    world = client.load_world("Linden", True, carla.MapLayer.Foliage)
    assert world.get_environment_objects(Label.Buildings) == []
    assert len(world.get_environment_objects(Label.Vegetation)) > 1000
    assert len(world.get_environment_objects(Label.TrafficLight)) > 0
    assert len(client.reload_world().get_environment_objects(Label.Buildings)) > 1000


def test_a_house_stops_a_car_and_the_collision_says_what_it_was(world, house) -> None:
    library = world.get_blueprint_library()
    front = house.bounding_box.rotation.get_forward_vector()
    yard = above(house.transform.location - front * (house.bounding_box.extent.x + 4.0), 0.5)
    world.unload_map_layer(carla.MapLayer.Foliage)
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), carla.Transform(yard, house.transform.rotation))
    sensor = world.spawn_actor(library.find("sensor.other.collision"), carla.Transform(), attach_to=car)
    hit: list[str] = []
    sensor.listen(lambda event: hit.append(event.other_actor.type_id))
    car.apply_control(carla.VehicleControl(throttle=1.0))
    for _ in range(80):
        world.tick()
    sensor.stop()
    for _ in range(3):
        world.tick()
    sensor.destroy()
    assert set(hit) == {"static.building"}
    away = car.get_location() - house.transform.location
    assert -(away.x * front.x + away.y * front.y) > house.bounding_box.extent.x + 2.0
    assert math.hypot(car.get_velocity().x, car.get_velocity().y) < 0.5


def test_what_needs_unreal_is_refused_by_a_sentence(world, server: RunningServer) -> None:
    texture = carla.TextureColor(2, 2)
    with pytest.raises(RuntimeError, match="no texture can be applied to 'House_0'"):
        world.apply_color_texture_to_object("House_0", carla.MaterialParameter.Diffuse, texture)
    with pytest.raises(RuntimeError, match="no texture can be applied to 2 objects"):
        world.apply_float_color_texture_to_objects(
            ["a", "b"], carla.MaterialParameter.Emissive, carla.TextureFloatColor(2, 2)
        )
    world.set_annotations_traverse_translucency(True)
    world.tick()
    assert "nothing in linden's scene is translucent" in server.log()


def test_a_world_made_of_a_text_has_the_walls_that_were_asked_for(client) -> None:
    text = street_through_junction()
    walled = client.generate_opendrive_world(text, carla.OpendriveGenerationParameters(wall_height=1.5))
    walls = walled.get_level_bbs(Label.Walls)
    assert len(walls) >= 4
    assert all(box.extent.z == pytest.approx(0.75) for box in walls)
    across = walled.cast_ray(carla.Location(21.0, 0.0, 0.5), carla.Location(21.0, 9.0, 0.5))
    assert labels(across) == [Label.Walls]
    assert across[0].location.y == pytest.approx(5.0, abs=0.1)
    open_world = client.generate_opendrive_world(text, carla.OpendriveGenerationParameters(wall_height=0.0))
    assert open_world.get_level_bbs(Label.Walls) == []
