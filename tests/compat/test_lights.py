"""Traffic lights and signs through the official client."""

import carla
import pytest

from fakes.crossing_map import crossing
from fakes.own_map import world_of
from servers import RunningServer

Colour = carla.TrafficLightState
TICKS_PER_S = 20


@pytest.fixture
def lights(world: carla.World) -> list[carla.TrafficLight]:
    world.tick()
    return sorted(world.get_actors().filter("traffic.traffic_light"), key=lambda light: light.id)


def tick(world: carla.World, seconds: float) -> None:
    for _ in range(round(seconds * TICKS_PER_S)):
        world.tick()


def colours_of(world: carla.World, light: carla.TrafficLight, seconds: float) -> list[tuple[Colour, int]]:
    """Return the colours a light shows, each with the number of ticks it lasts."""
    seen: list[tuple[Colour, int]] = []
    for _ in range(round(seconds * TICKS_PER_S)):
        world.tick()
        same = seen and seen[-1][0] == light.state
        seen = [*seen[:-1], (light.state, seen[-1][1] + 1)] if same else [*seen, (light.state, 1)]
    return seen


def at_sign(world: carla.World, kind: str) -> carla.Transform:
    """Return a place on the road under a sign."""
    sign = min(world.get_actors().filter(kind), key=lambda sign: sign.id)
    middle = sign.get_transform().transform(carla.Location(sign.trigger_volume.location))
    pose = world.get_map().get_waypoint(middle).transform
    pose.location.z += 0.3
    return pose


# -- which light is which ----------------------------------------------------------------------------------------------


def test_every_light_belongs_to_a_signal_of_the_map(world, lights) -> None:
    assert lights
    for light in lights:
        assert world.get_traffic_light_from_opendrive_id(light.get_opendrive_id()).id == light.id


def test_every_landmark_of_a_light_finds_it(world, lights) -> None:
    found = [world.get_traffic_light(landmark) for landmark in world.get_map().get_all_landmarks_of_type("1000001")]
    assert sorted({light.id for light in found}) == [light.id for light in lights]


def test_the_lights_of_a_junction_take_turns_there(world, lights) -> None:
    for light in lights:
        ahead = light.get_stop_waypoints()[0].next(12.0)[0]
        assert ahead.is_junction
        in_junction = world.get_traffic_lights_in_junction(ahead.get_junction().id)
        assert sorted(each.id for each in in_junction) == sorted(each.id for each in light.get_group_traffic_lights())


def test_every_light_of_a_group_has_a_pole_of_its_own(lights) -> None:
    for light in lights:
        poles = sorted(each.get_pole_index() for each in light.get_group_traffic_lights())
        assert poles == list(range(len(poles)))


def test_one_stops_before_the_line_on_the_lanes_that_the_light_is_for(world, lights) -> None:
    for light in lights:
        listed = world.get_map().get_all_landmarks_from_id(light.get_opendrive_id())
        behind = {way.road_id for place in light.get_stop_waypoints() for way in place.next(12.0)}
        (landmark,) = (each for each in listed if each.road_id not in behind)
        # as in CARLA's towns, each way behind the line refers to the light
        assert behind == {each.road_id for each in listed} - {landmark.road_id}
        stops, affected = light.get_stop_waypoints(), light.get_affected_lane_waypoints()
        lanes = {lane for first, last in landmark.get_lane_validities() for lane in range(first, last + 1)}
        assert {(place.road_id, place.lane_id) for place in stops} == {(landmark.road_id, lane) for lane in lanes}
        assert {(place.road_id, place.lane_id) for place in affected} == {
            *((landmark.road_id, lane) for lane in lanes),
            *((road_id, -1) for road_id in behind),
        }
        assert all(2.0 < abs(place.s - landmark.s) < 4.0 for place in stops)


def test_a_vehicle_that_looks_ahead_finds_its_next_light(world, lights) -> None:
    for light in lights:
        for place in light.get_stop_waypoints():
            assert [each.id for each in world.get_traffic_lights_from_waypoint(place, 30.0)] == [light.id]


# -- how they change ---------------------------------------------------------------------------------------------------


def test_a_light_goes_through_all_colours_within_a_cycle_of_its_group(world, lights) -> None:
    seen = colours_of(world, lights[0], 60.0)  # four turns of 15 s
    assert {colour for colour, _ in seen} == {Colour.Red, Colour.Yellow, Colour.Green}


def test_times_and_colours_can_be_set(world, lights) -> None:
    light = lights[0]
    light.set_green_time(4.0)
    light.set_state(Colour.Green)
    light.freeze(True)
    world.tick()
    assert light.get_green_time() == pytest.approx(4.0)
    assert light.state == Colour.Green
    assert light.is_frozen()
    tick(world, 20.0)
    assert light.state == Colour.Green


def test_the_times_that_are_set_pass(world, lights) -> None:
    group = lights[0].get_group_traffic_lights()
    for light in group:
        light.set_green_time(3.0)
        light.set_yellow_time(1.0)
        light.set_red_time(0.5)
    lights[0].reset_group()
    whole = colours_of(world, lights[0], 40.0)[1:-1]  # the first and the last colour are cut short
    lasting = {colour: ticks / TICKS_PER_S for colour, ticks in whole}
    assert lasting[Colour.Green] == pytest.approx(3.0, abs=0.06)
    assert lasting[Colour.Yellow] == pytest.approx(1.0, abs=0.06)
    assert lasting[Colour.Red] > 0.5


def test_two_lights_that_cross_are_never_green_at_once(world, lights) -> None:
    group = lights[0].get_group_traffic_lights()
    together = set()
    for _ in range(60 * TICKS_PER_S):
        world.tick()
        together.add(frozenset(light.id for light in group if light.state != Colour.Red))
    turns = [turn for turn in together if turn]
    assert len(turns) > 1
    assert sum(map(len, turns)) == len(frozenset().union(*turns)) == len(group)


def test_time_stands_still_for_frozen_lights_and_goes_on_where_it_stood(world, lights) -> None:
    tick(world, 4.0)
    light = next(light for light in lights if light.state == Colour.Green)
    elapsed_s = light.get_elapsed_time()
    world.freeze_all_traffic_lights(True)
    tick(world, 30.0)
    assert light.is_frozen()
    assert (light.state, light.get_elapsed_time()) == (Colour.Green, elapsed_s)
    world.freeze_all_traffic_lights(False)
    tick(world, 1.0)
    assert not light.is_frozen()
    assert light.get_elapsed_time() == pytest.approx(elapsed_s + 1.0, abs=0.06)


def test_a_colour_set_by_hand_lasts_until_the_turn_changes(world, lights) -> None:
    tick(world, 1.0)
    light = next(light for light in lights if light.state == Colour.Green)
    light.set_state(Colour.Red)
    seen = colours_of(world, light, 12.0)
    assert seen[0][0] == Colour.Red
    assert Colour.Yellow in {colour for colour, _ in seen}  # the turn went on beneath


def test_a_group_that_is_reset_begins_again_and_leaves_the_others_alone(world, lights) -> None:
    tick(world, 8.0)
    light = lights[0]
    own = {each.id for each in light.get_group_traffic_lights()}
    other = next(each for each in lights if each.id not in own and each.state == Colour.Green)
    light.reset_group()
    tick(world, 0.1)
    assert max(each.get_elapsed_time() for each in light.get_group_traffic_lights()) < 0.2
    assert other.get_elapsed_time() > 8.0
    world.reset_all_traffic_lights()
    tick(world, 0.1)
    assert max(each.get_elapsed_time() for each in lights) < 0.2


def test_a_light_can_be_switched_off(world, lights) -> None:
    lights[0].freeze(True)
    lights[0].set_state(Colour.Off)
    tick(world, 20.0)
    assert lights[0].state == Colour.Off


# -- whom they tell ----------------------------------------------------------------------------------------------------


def test_a_vehicle_learns_of_the_light_it_waits_at(world, lights) -> None:
    light = lights[0]
    light.set_state(Colour.Red)
    light.freeze(True)
    stop = light.get_stop_waypoints()[0].transform
    stop.location.z += 0.5
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), stop)
    tick(world, 0.25)
    assert car.is_at_traffic_light()
    assert car.get_traffic_light_state() == Colour.Red
    assert car.get_traffic_light().id == light.id
    light.set_state(Colour.Green)
    tick(world, 0.1)
    assert (car.is_at_traffic_light(), car.get_traffic_light_state()) == (True, Colour.Green)
    car.destroy()


def test_stop_signs_stand_where_the_map_has_them(world) -> None:
    world.tick()
    signs = {sign.id for sign in world.get_actors().filter("traffic.stop")}
    landmarks = world.get_map().get_all_landmarks_of_type("206")
    assert len(signs) == len({landmark.id for landmark in landmarks}) > 0


def test_a_stop_sign_is_a_red_light_without_a_light_for_two_seconds(world) -> None:
    world.tick()
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), at_sign(world, "traffic.stop"))
    tick(world, 0.1)
    assert (car.is_at_traffic_light(), car.get_traffic_light_state()) == (False, Colour.Red)
    tick(world, 2.1)
    assert car.get_traffic_light_state() == Colour.Green
    car.destroy()


def test_a_yield_sign_is_green_where_no_vehicle_comes(world) -> None:
    world.tick()
    car = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), at_sign(world, "traffic.yield"))
    tick(world, 0.5)
    assert (car.is_at_traffic_light(), car.get_traffic_light_state()) == (False, Colour.Green)
    car.destroy()


# -- a map that a client sends -----------------------------------------------------------------------------------------


def lit_crossing() -> str:
    """Four streets that cross, a light on each; those that face each other share a controller."""
    text = crossing().replace('type="206"', 'type="1000001"').replace('type="205"', 'type="1000001"')
    text = text.replace('name="sign" dynamic="no"', 'name="light" dynamic="yes"')
    controllers = "".join(
        f'<controller id="{number}" name="axis {number}" sequence="{number}">'
        f'<control signalId="{100 + number}" type=""/><control signalId="{102 + number}" type=""/></controller>'
        for number in (0, 1)
    )
    links = '<controller id="0" type="0"/><controller id="1" type="0"/>'
    return text.replace('<junction id="50"', controllers + '<junction id="50"').replace(
        "</junction>", links + "</junction>"
    )


@pytest.fixture
def crossing_world(server: RunningServer) -> carla.World:
    world = world_of(server.port, lit_crossing())
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, 1.0 / TICKS_PER_S
    world.apply_settings(settings)
    return world


def test_the_lights_of_a_crossing_of_ones_own_take_turns_by_axis(crossing_world: carla.World) -> None:
    crossing_world.tick()
    light = {n: crossing_world.get_traffic_light_from_opendrive_id(str(100 + n)) for n in range(4)}
    assert {each.id for each in light[0].get_group_traffic_lights()} == {each.id for each in light.values()}
    assert {each.id for each in crossing_world.get_traffic_lights_in_junction(50)} == {e.id for e in light.values()}
    seen = set()
    for _ in range(31 * TICKS_PER_S):
        crossing_world.tick()
        assert light[0].state == light[2].state
        assert light[1].state == light[3].state
        seen.add((light[0].state, light[1].state))
    assert seen == {
        (Colour.Green, Colour.Red),
        (Colour.Yellow, Colour.Red),
        (Colour.Red, Colour.Red),
        (Colour.Red, Colour.Green),
        (Colour.Red, Colour.Yellow),
    }


def test_a_light_of_ones_own_is_for_the_lane_that_leads_in(crossing_world: carla.World) -> None:
    crossing_world.tick()
    light = crossing_world.get_traffic_light_from_opendrive_id("100")
    (stop,) = light.get_stop_waypoints()
    assert (stop.road_id, stop.lane_id) == (1, 1)
    assert [each.id for each in crossing_world.get_traffic_lights_from_waypoint(stop, 20.0)] == [light.id]
