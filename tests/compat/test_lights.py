"""Traffic lights and signs through the official client."""

import carla
import pytest

Colour = carla.TrafficLightState


@pytest.fixture
def lights(world: carla.World) -> list[carla.TrafficLight]:
    world.tick()
    return list(world.get_actors().filter("traffic.traffic_light"))


def test_every_light_belongs_to_a_signal_of_the_map(world, lights) -> None:
    assert lights
    for light in lights:
        assert world.get_traffic_light_from_opendrive_id(light.get_opendrive_id()).id == light.id


def test_a_light_goes_through_all_colours_within_a_cycle_of_its_group(world, lights) -> None:
    light = lights[0]
    assert light.id in {other.id for other in light.get_group_traffic_lights()}
    seen = set()
    for _ in range(20 * 60):  # four turns of 15 s
        world.tick()
        seen.add(light.state)
    assert seen == {Colour.Red, Colour.Yellow, Colour.Green}


def test_times_and_colours_can_be_set(world, lights) -> None:
    light = lights[0]
    light.set_green_time(4.0)
    light.set_state(Colour.Green)
    light.freeze(True)
    world.tick()
    assert light.get_green_time() == pytest.approx(4.0)
    assert light.state == Colour.Green
    assert light.is_frozen()
    for _ in range(400):
        world.tick()
    assert light.state == Colour.Green


def test_a_vehicle_learns_of_the_light_it_waits_at(world, lights) -> None:
    light = lights[0]
    light.set_state(Colour.Red)
    light.freeze(True)
    stop = light.get_stop_waypoints()[0].transform
    stop.location.z += 0.5
    library = world.get_blueprint_library()
    car = world.spawn_actor(library.find("vehicle.tesla.model3"), stop)
    for _ in range(5):
        world.tick()
    assert car.is_at_traffic_light()
    assert car.get_traffic_light_state() == Colour.Red
    assert car.get_traffic_light().id == light.id


def test_stop_signs_stand_where_the_map_has_them(world) -> None:
    signs = {sign.id for sign in world.get_actors().filter("traffic.stop")}
    landmarks = world.get_map().get_all_landmarks_of_type("206")
    assert len(signs) == len({landmark.id for landmark in landmarks}) > 0
