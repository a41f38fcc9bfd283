"""Claims about actors that a page sends somewhere: they arrive on lanes, wait, and end their errands."""

import math

import numpy as np
import pytest

from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.enums import TrafficLightState
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.world import World
from linden_window.errands import Errands
from linden_window.ways import STEP_M, Ways
from opendrive_texts import SIGNS_AND_LIGHTS

STEP_S = 0.05


@pytest.fixture(scope="module")
def ways() -> Ways:
    return Ways(SIGNS_AND_LIGHTS)


def spawned(world: World, kind: str = "vehicle.tesla.model3", number: int = 0) -> int:
    point = world.spawn_points[number]
    x, y, z = point.location
    return world.spawn(ActorDescription(0, kind), Transform(Vector3D(x, y, z + 0.5), point.rotation)).id


def place(world: World, actor_id: int) -> np.ndarray:
    return world.episode.actors.pose[world.episode.actors.row(actor_id)].copy()


def run(world: World, errands: Errands, until_s: float) -> float:
    """Let the world go on until all errands have ended; return the simulated time."""
    passed_s = 0.0
    while len(errands) and passed_s < until_s:
        errands.before_frame()
        world.step(STEP_S)
        passed_s += STEP_S
    return passed_s


def farthest(world: World, ways: Ways, actor_id: int) -> np.ndarray:
    """Return a way from a vehicle to the end of a lane that it can reach, the longest of all."""
    x, y, _, _, yaw, _ = place(world, actor_id)
    ends = [ways.way(x, y, yaw, *point[:2]) for point in ways._points[::20]]
    return max((each for each in ends if each is not None), key=len)


def test_a_way_follows_lanes_and_ends_slowly(world: World, ways: Ways) -> None:
    way = farthest(world, ways, spawned(world))
    steps = np.hypot(*np.diff(way[:, :2], axis=0).T)
    assert steps.max() < 2.0 * STEP_M
    assert way[-1, 2] == 0.0
    assert np.diff(way[:, 2] ** 2)[-5:].max() < 0.0
    to_lane = [np.hypot(*(ways._points[:, :2] - point[:2]).T).min() for point in way]
    assert max(to_lane) < 1e-6


def test_a_way_begins_in_the_direction_of_the_vehicle(world: World, ways: Ways) -> None:
    count = 0
    for point in world.spawn_points:
        x, y, _ = point.location
        yaw = math.radians(point.rotation.yaw)
        goals = [ways.way(x, y, point.rotation.yaw, *goal[:2]) for goal in ways._points[::50]]
        found = [way for way in goals if way is not None and len(way) > 3]
        count += len(found)
        for way in found:
            ahead = way[2, :2] - way[0, :2]
            assert ahead @ (math.cos(yaw), math.sin(yaw)) > 0.0
    assert count > 10


def test_no_way_leads_to_a_place_far_from_all_lanes(ways: Ways) -> None:
    x, y = ways._points[0, :2]
    assert ways.way(x, y, math.degrees(ways._points[0, 2]), 1e6, 1e6) is None


def test_a_vehicle_arrives_on_its_way_within_the_limit(world: World, ways: Ways) -> None:
    for light in range(len(world.episode.traffic.state.colour)):
        world.episode.traffic.set_colour(light, TrafficLightState.GREEN)
        world.episode.traffic.freeze(light, frozen=True)
    said: list[str] = []
    car, errands = spawned(world), Errands(world, said.append)
    way = farthest(world, ways, car)
    errands.send(car, way)
    away, fastest = 0.0, 0.0
    while len(errands):
        errands.before_frame()
        world.step(STEP_S)
        x, y = place(world, car)[:2]
        away = max(away, float(np.hypot(*(way[:, :2] - (x, y)).T).min()))
        velocity = world.episode.actors.rows["velocity"][world.episode.actors.row(car)]
        fastest = max(fastest, float(np.hypot(*velocity[:2])))
        assert world.elapsed_s < 300.0
    assert said == [f"Actor {car} has arrived."]
    assert np.hypot(*(place(world, car)[:2] - way[-1, :2])) < 4.0
    assert away < 1.5
    assert fastest < way[:, 2].max() + 1.0


def test_a_vehicle_waits_behind_what_stands_on_its_way(world: World, ways: Ways) -> None:
    car, errands = spawned(world), Errands(world, print)
    way = farthest(world, ways, car)
    there = way[25]
    yaw = math.degrees(math.atan2(*(way[26, :2] - there[:2])[::-1]))
    z = world.spawn_points[0].location.z
    block = Transform(Vector3D(there[0], there[1], z + 0.5), Rotation(0.0, yaw, 0.0))
    other = world.spawn(ActorDescription(0, "vehicle.tesla.model3"), block).id
    world.episode.bodies.set_control(world.episode.vehicle(other), VehicleControl(hand_brake=True))
    errands.send(car, way)
    run(world, errands, 40.0)
    assert len(errands) == 1, "it still waits"
    gap = np.hypot(*(place(world, car)[:2] - place(world, other)[:2]))
    assert 5.0 < gap < 15.0
    world.destroy(other)
    run(world, errands, 20.0)
    assert np.hypot(*(place(world, car)[:2] - there[:2])) > 5.0 or len(errands) == 0


def test_a_walker_walks_straight_and_arrives(world: World) -> None:
    said: list[str] = []
    point = world.spawn_points[0]
    x, y, z = point.location
    walker = world.spawn(
        ActorDescription(0, "walker.pedestrian.0001"), Transform(Vector3D(x, y, z + 1.2), Rotation())
    ).id
    errands = Errands(world, said.append)
    errands.send(walker, np.array([[x + 6.0, y, 0.0]]))
    assert run(world, errands, 20.0) < 10.0
    assert said == [f"Actor {walker} has arrived."]


def test_an_errand_ends_with_its_actor_and_with_its_world(world: World, ways: Ways) -> None:
    car, errands = spawned(world), Errands(world, print)
    errands.send(car, farthest(world, ways, car))
    world.destroy(car)
    errands.before_frame()
    assert len(errands) == 0
    errands.send(spawned(world), np.zeros((2, 3)))
    world.load(world.episode.map, reset_settings=False)
    errands.before_frame()
    assert len(errands) == 0


def test_what_cannot_be_sent_is_refused(world: World) -> None:
    errands = Errands(world, print)
    light = next(record.id for record in world.episode.actors if "traffic" in record.description.id)
    with pytest.raises(Refusal, match="neither"):
        errands.send(light, np.zeros((2, 3)))
    with pytest.raises(Refusal, match="not be found"):
        errands.send(10**6, np.zeros((2, 3)))
    car = spawned(world)
    world.episode.bodies.set_autopilot(world.episode.vehicle(car), on=True)
    with pytest.raises(Refusal, match="Traffic Manager"):
        errands.send(car, np.zeros((2, 3)))
    world.episode.bodies.set_autopilot(world.episode.vehicle(car), on=False)
    with pytest.raises(ValueError, match="a way has"):
        errands.send(car, np.zeros((0, 3)))
