"""The components of vehicles that CARLA's own example asks for by name."""

import carla

from spawn_points import spawn_point


def test_a_car_knows_where_its_blinkers_are(world: carla.World) -> None:
    point = spawn_point(world, 120)
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.audi.tt"), point)
    world.tick()
    assert next(iter(car.get_component_names())) == "VehicleMesh"
    half = car.bounding_box.extent
    place = car.get_component_relative_transform("front-blinker-r-1").location
    assert abs(place.x - half.x) < 0.3
    assert abs(place.y - half.y) < 0.3
    opposite = car.get_component_relative_transform("back-blinker-l-1").location
    assert opposite.x < 0.0 > opposite.y
    in_world = car.get_transform().transform(carla.Location(place))
    assert car.get_component_world_transform("front-blinker-r-1").location.distance(in_world) < 0.01


def test_a_bicycle_has_none(world: carla.World) -> None:
    point = spawn_point(world, 120)
    bike = world.spawn_actor(world.get_blueprint_library().find("vehicle.bh.crossbike"), point)
    assert list(bike.get_component_names()) == ["VehicleMesh"]
