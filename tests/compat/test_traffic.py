"""The official client's Traffic Manager on our streets: every setting of it by its effect, with a car or two."""

import socket
from collections import Counter
from collections.abc import Callable, Iterator

import carla
import pytest

from servers import RunningServer, running_server

STEP_S = 0.05
CAR = "vehicle.tesla.model3"
SLOW_KMH = 25.0
"""Above 48 km/h the Traffic Manager forgets a change of lanes: it aims 20 m ahead, and drops what is further away."""


@pytest.fixture(scope="module")
def world() -> Iterator[carla.World]:
    """One world for all tests: a load while a Traffic Manager lives is what the official client may not survive."""
    with running_server("--sync") as server:
        yield synchronous_world(server)


def synchronous_world(server: RunningServer) -> carla.World:
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(60.0)
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    world.client_of_tests = client
    return world


@pytest.fixture
def manager(world: carla.World) -> Iterator[carla.TrafficManager]:
    """A Traffic Manager in synchronous mode; the cars that it drove are taken away after the test."""
    world.reset_all_traffic_lights()
    world.freeze_all_traffic_lights(False)
    manager = world.client_of_tests.get_trafficmanager(free_port())
    manager.set_synchronous_mode(True)
    manager.set_random_device_seed(7)
    yield manager
    for actor in [*world.get_actors().filter("vehicle.*"), *world.get_actors().filter("walker.*")]:
        actor.destroy()
    manager.shut_down()
    world.tick()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def put(world: carla.World, place: carla.Waypoint, model: str = CAR, up_m: float = 0.3) -> carla.Actor:
    pose = place.transform
    pose.location.z += up_m
    return world.spawn_actor(world.get_blueprint_library().find(model), pose)


def go(world: carla.World, seconds: float, each_tick: Callable[[], object] = lambda: None) -> None:
    for _ in range(round(seconds / STEP_S)):
        world.tick()
        each_tick()


def reaches(world: carla.World, car: carla.Vehicle, goal: carla.Location, within_s: float) -> bool:
    """Whether a car comes within 3 m of a place in that time."""
    for _ in range(round(within_s / STEP_S)):
        world.tick()
        if car.get_location().distance(goal) < 3.0:
            return True
    return False


def speed_mps(car: carla.Vehicle) -> float:
    velocity = car.get_velocity()
    return (velocity.x**2 + velocity.y**2) ** 0.5


def street(world: carla.World) -> carla.Waypoint:
    """Return a place on the inner lane of the longest street with two lanes a direction, 100 m from its beginning."""
    town = world.get_map()
    lengths = Counter(place.road_id for place in town.generate_waypoints(20.0) if place.lane_id == -2)
    return town.get_waypoint_xodr(lengths.most_common(1)[0][0], -1, 100.0)


def before(world: carla.World, kind: str, distance_m: float) -> tuple[carla.Actor, carla.Waypoint]:
    """Return a light or sign with a straight approach, and a place so far before its line."""
    town = world.get_map()
    for actor in sorted(world.get_actors().filter(kind), key=lambda each: each.id):
        pose = actor.get_transform()
        line = town.get_waypoint(pose.transform(carla.Location(actor.trigger_volume.location)))
        behind = line.previous(distance_m)
        if len(behind) == 1 and behind[0].road_id == line.road_id:
            return actor, behind[0]
    raise AssertionError(f"no {kind} has an approach of {distance_m} m")


# -- speed -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wish", "share"),
    [
        pytest.param(lambda manager, car: manager.vehicle_percentage_speed_difference(car, 60.0), 0.4, id="slower"),
        pytest.param(lambda manager, car: manager.vehicle_percentage_speed_difference(car, -20.0), 1.2, id="faster"),
        pytest.param(lambda manager, _: manager.global_percentage_speed_difference(50.0), 0.5, id="all slower"),
        pytest.param(lambda manager, car: manager.set_desired_speed(car, 20.0), None, id="a speed of its own"),
    ],
)
def test_a_car_drives_at_its_desired_speed(world, manager, wish, share) -> None:
    car = put(world, street(world))
    world.tick()
    car.set_autopilot(True, manager.get_port())
    wish(manager, car)
    go(world, 12.0)
    wanted_kmh = 20.0 if share is None else share * car.get_speed_limit()
    assert speed_mps(car) * 3.6 == pytest.approx(wanted_kmh, rel=0.06)
    manager.global_percentage_speed_difference(0.0)


# -- lights and signs --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ignored_percent", "passes"), [(0.0, False), (100.0, True)])
def test_a_red_light_holds_a_car_that_does_not_ignore_it(world, manager, ignored_percent, passes) -> None:
    light, place = before(world, "traffic.traffic_light", 40.0)
    light.set_state(carla.TrafficLightState.Red)
    light.freeze(True)
    car = put(world, place)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.ignore_lights_percentage(car, ignored_percent)
    held = []
    go(world, 15.0, lambda: held.append(car.is_at_traffic_light()))
    assert any(held)
    assert (not held[-1]) == passes
    assert (speed_mps(car) > 1.0) == passes


@pytest.mark.parametrize(("ignored_percent", "stops"), [(0.0, True), (100.0, False)])
def test_a_car_that_heeds_signs_stands_at_a_stop_sign_and_drives_on(world, manager, ignored_percent, stops) -> None:
    _, place = before(world, "traffic.stop", 40.0)
    car = put(world, place)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.ignore_signs_percentage(car, ignored_percent)
    seen = []
    go(world, 15.0, lambda: seen.append((speed_mps(car), car.get_location().distance(place.transform.location))))
    under_way = [speed for speed, driven_m in seen if driven_m > 10.0]
    assert (min(under_way) < 0.05) == stops
    assert seen[-1][1] > 45.0 or not stops


# -- others on the road ------------------------------------------------------------------------------------------------


def gap_to(car: carla.Vehicle, other: carla.Actor) -> float:
    """Return the distance between the boxes of two on one street, m; below zero where they overlap."""
    between_m = car.get_location().distance(other.get_location())
    return between_m - car.bounding_box.extent.x - other.bounding_box.extent.x


def driven_and_standing(
    world: carla.World, manager: carla.TrafficManager, between_m: float
) -> tuple[carla.Vehicle, carla.Vehicle]:
    """Return a car that keeps its lane, and another that stands ahead of it."""
    place = street(world)
    car, other = put(world, place), put(world, place.next(between_m)[0])
    other.apply_control(carla.VehicleControl(hand_brake=True))
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.auto_lane_change(car, False)
    return car, other


def stopped_behind_another(world: carla.World, manager: carla.TrafficManager, gap_m: float) -> tuple[float, list]:
    """Return the gap that a car leaves to one that stands, told to keep that much, and the two."""
    car, other = driven_and_standing(world, manager, 35.0)
    manager.set_desired_speed(car, SLOW_KMH)  # faster, it brakes for longer than it looks ahead
    manager.distance_to_leading_vehicle(car, gap_m)
    go(world, 10.0)
    assert speed_mps(car) < 0.05
    return gap_to(car, other), [car, other]


def test_a_car_keeps_more_distance_where_the_setting_is_larger(world, manager) -> None:
    small_m, cars = stopped_behind_another(world, manager, 2.0)
    for car in cars:
        car.destroy()
    world.tick()
    large_m, _ = stopped_behind_another(world, manager, 10.0)
    assert small_m > 0.3
    assert large_m > small_m + 3.0


def test_a_car_that_ignores_vehicles_runs_into_one(world, manager) -> None:
    car, other = driven_and_standing(world, manager, 50.0)
    manager.ignore_vehicles_percentage(car, 100.0)
    stood = other.get_location()
    go(world, 15.0)
    assert other.get_location().distance(stood) > 1.0


@pytest.mark.parametrize(("ignored_percent", "stops"), [(0.0, True), (100.0, False)])
def test_a_car_that_heeds_walkers_stops_for_one(world, manager, ignored_percent, stops) -> None:
    place = street(world)
    car = put(world, place)
    walker = put(world, place.next(45.0)[0], "walker.pedestrian.0001", up_m=1.0)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.auto_lane_change(car, False)
    manager.ignore_walkers_percentage(car, ignored_percent)
    slowest: list[float] = []
    gaps: list[float] = []
    go(world, 12.0, lambda: (slowest.append(speed_mps(car)), gaps.append(gap_to(car, walker))))
    assert (slowest[-1] < 0.05) == stops
    assert (min(gaps) > 0.5) == stops


def test_cars_without_collision_detection_touch(world, manager) -> None:
    car, other = driven_and_standing(world, manager, 50.0)
    manager.collision_detection(car, other, False)
    gaps: list[float] = []
    go(world, 12.0, lambda: gaps.append(gap_to(car, other)))
    assert min(gaps) < 0.3


# -- lanes -------------------------------------------------------------------------------------------------------------


def lane_of(world: carla.World, car: carla.Vehicle) -> int:
    return world.get_map().get_waypoint(car.get_location()).lane_id


@pytest.mark.parametrize(("from_lane", "to_right"), [(-1, True), (-2, False)])
def test_a_forced_lane_change_is_made(world, manager, from_lane, to_right) -> None:
    place = street(world)
    place = place if from_lane == -1 else place.get_right_lane()
    car = put(world, place)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.auto_lane_change(car, False)
    manager.set_desired_speed(car, SLOW_KMH)
    go(world, 4.0)
    assert lane_of(world, car) == from_lane
    manager.force_lane_change(car, to_right)
    go(world, 6.0)
    assert lane_of(world, car) == -3 - from_lane


@pytest.mark.parametrize(("allowed", "lanes"), [(True, {-1, -2}), (False, {-1})])
def test_a_slow_car_ahead_is_overtaken_where_lane_changes_are_allowed(world, manager, allowed, lanes) -> None:
    place = street(world)
    car, other = put(world, place), put(world, place.next(50.0)[0])
    world.tick()
    for each in (car, other):
        each.set_autopilot(True, manager.get_port())
    manager.set_desired_speed(other, 8.0)
    manager.set_desired_speed(car, SLOW_KMH)
    manager.auto_lane_change(other, False)
    manager.auto_lane_change(car, allowed)
    seen = set()
    go(world, 15.0, lambda: seen.add(lane_of(world, car)))
    assert seen == lanes


def test_a_car_that_keeps_right_leaves_the_inner_lane(world, manager) -> None:
    car = put(world, street(world))
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.auto_lane_change(car, False)
    manager.keep_slow_lane_rule_percentage(car, 100.0)
    go(world, 10.0)
    assert lane_of(world, car) == -2


def test_a_car_drives_beside_the_middle_of_its_lane_if_told(world, manager) -> None:
    car = put(world, street(world))
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.auto_lane_change(car, False)
    manager.vehicle_lane_offset(car, 0.5)
    go(world, 10.0)
    middle = world.get_map().get_waypoint(car.get_location()).transform
    aside = car.get_location() - middle.location
    assert aside.dot(middle.get_right_vector()) == pytest.approx(0.5, abs=0.15)


# -- ways --------------------------------------------------------------------------------------------------------------


def junction_ahead(world: carla.World) -> tuple[carla.Waypoint, list[list[carla.Waypoint]]]:
    """Return a place 30 m before a junction with three ways out, and the ways, each as places 2 m apart, by bearing."""
    town = world.get_map()
    for sign in sorted(world.get_actors().filter("traffic.stop"), key=lambda each: each.id):
        pose = sign.get_transform()
        line = town.get_waypoint(pose.transform(carla.Location(sign.trigger_volume.location)))
        start = line.previous(25.0)
        ways = [way for way in line.next_until_lane_end(1.0)[-1].next(2.0) if way.is_junction]
        if len(ways) == 3 and len(start) == 1 and start[0].road_id == line.road_id:
            paths = []
            for way in ways:
                through = way.next_until_lane_end(2.0)
                paths.append([*through, *through[-1].next(2.0)[0].next_until_lane_end(2.0)[:10]])
            turn = [(path[-1].transform.rotation.yaw - line.transform.rotation.yaw + 180.0) % 360.0 for path in paths]
            return start[0], [path for _, path in sorted(zip(turn, paths, strict=True), key=lambda pair: pair[0])]
    raise AssertionError("no junction behind a stop sign has three ways out")


@pytest.mark.parametrize("way", [0, 1, 2], ids=["left", "straight", "right"])
def test_a_car_follows_the_path_that_it_is_given(world, manager, way) -> None:
    start, ways = junction_ahead(world)
    car = put(world, start)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.ignore_signs_percentage(car, 100.0)
    manager.set_path(car, [place.transform.location for place in ways[way][-4:]])  # it joins what lies between
    assert reaches(world, car, ways[way][-1].transform.location, within_s=25.0)


@pytest.mark.parametrize(("turn", "way"), [("Left", 0), ("Straight", 1), ("Right", 2)])
def test_a_car_takes_the_turn_that_its_route_names(world, manager, turn, way) -> None:
    start, ways = junction_ahead(world)
    car = put(world, start)
    world.tick()
    car.set_autopilot(True, manager.get_port())
    manager.ignore_signs_percentage(car, 100.0)
    manager.set_route(car, [turn])
    assert reaches(world, car, ways[way][-1].transform.location, within_s=25.0)
