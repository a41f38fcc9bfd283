"""Claims about SUMO's vehicles in a live simulator, and CARLA's in SUMO."""

from collections.abc import Iterator
from pathlib import Path

import carla
import pytest

from basu import simulator as simulator_module
from basu_sumo.bridge import ROLE, Bridge
from basu_sumo.link import in_process
from servers import RunningServer

STEP_S = 0.05


@pytest.fixture
def client(simulator: RunningServer) -> Iterator[carla.Client]:
    """A client whose world is still and has nothing left in it."""
    client = simulator_module.connect("127.0.0.1", simulator.port, 120.0)
    world = client.get_world()
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    yield client
    for actor in world.get_actors():
        if actor.type_id.startswith(("vehicle.", "walker.")):
            actor.destroy()
    world.apply_settings(before)


def bridge_to(client: carla.Client, folder: Path, config: str = "small.sumocfg", **options: object) -> Bridge:
    world = client.get_world()
    link = in_process(folder / config, step_s=STEP_S, seed=0)
    bridge = Bridge(link, client, world, world.get_map(), lights="none", **options)  # type: ignore[arg-type]
    bridge.display.is_level = False  # the small network lies on Linden's ground, and has no heights of its own
    return bridge


def ticked(bridge: Bridge, world: carla.World, ticks: int) -> None:
    for _ in range(ticks):
        bridge.step(world.get_snapshot())
        world.tick()


def shown(world: carla.World) -> list[carla.Actor]:
    return [actor for actor in world.get_actors().filter("vehicle.*") if actor.attributes["role_name"] == ROLE]


def parked(world: carla.World, x_m: float, y_m: float) -> carla.Actor:
    blueprint = world.get_blueprint_library().find("vehicle.audi.a2")
    ground = world.get_map().get_waypoint(carla.Location(x_m, y_m, 248.0), lane_type=carla.LaneType.Any)
    actor = world.spawn_actor(blueprint, carla.Transform(carla.Location(x_m, y_m, ground.transform.location.z)))
    actor.set_simulate_physics(False)
    world.tick()
    return actor


def test_a_vehicle_is_shown_where_sumo_has_it_and_leaves_with_it(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    ticked(bridge, world, 100)
    (actor,) = shown(world)
    x_m, y_m = bridge.link.api.vehicle.getPosition("one")
    at = actor.get_transform()
    assert actor.type_id == "vehicle.audi.a2"
    assert at.location.x + 0.5 * 3.7 == pytest.approx(x_m, abs=0.01)
    assert at.location.y == pytest.approx(-y_m, abs=0.01)
    assert at.rotation.yaw == pytest.approx(0.0, abs=1.0)
    while bridge.link.api.simulation.getMinExpectedNumber() > 0:
        ticked(bridge, world, 1)
    ticked(bridge, world, 2)
    assert shown(world) == []
    assert bridge.counts == (1, 1, 0, 1, 0, 0)
    bridge.close()


def test_a_vehicle_without_room_waits_and_is_shown_later(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    bridge.link.step()
    x_m, y_m = bridge.link.api.vehicle.getPosition("one")
    obstacle = parked(world, x_m, -y_m)
    bridge.mirrors.known.add(obstacle.id)  # SUMO does not see it, so its vehicle does not wait by itself
    bridge.vehicles.depart("one")
    ticked(bridge, world, 1)
    assert bridge.counts.waiting == 1
    assert shown(world) == []
    obstacle.destroy()
    ticked(bridge, world, 2)
    assert bridge.counts.waiting == 0
    assert len(shown(world)) == 1
    bridge.close()


def test_sumo_s_driver_stops_behind_a_vehicle_of_carla(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    bridge.link.step()
    lane_y_m = -bridge.link.api.vehicle.getPosition("one")[1]
    bridge.link.close()
    parked(world, 80.0, lane_y_m)
    bridge = bridge_to(client, folder)
    ticked(bridge, world, 400)
    front_m = bridge.link.api.vehicle.getPosition("one")[0]
    assert bridge.link.api.vehicle.getSpeed("one") < 0.1
    assert 70.0 < front_m < 80.0 - 1.85
    bridge.close()


def test_only_what_is_within_the_radius_is_shown(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    parked(world, 120.0, 60.0)
    bridge = bridge_to(client, folder, radius_m=90.0)
    ticked(bridge, world, 5)
    assert shown(world) == []
    while bridge.link.api.vehicle.getPosition("one")[0] < 120.0:
        ticked(bridge, world, 1)
    assert len(shown(world)) == 1
    while bridge.link.api.vehicle.getPosition("one")[0] < 240.0:
        ticked(bridge, world, 1)
    assert shown(world) == []
    assert bridge.link.api.vehicle.getIDCount() == 2, "it drives on in SUMO"
    bridge.close()


def test_a_bridge_leaves_nothing_and_takes_away_what_a_dead_one_left(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    ticked(bridge, world, 3)
    bridge.link.close()  # as if its process had died: the actor stays
    assert len(shown(world)) == 1
    bridge = bridge_to(client, folder)
    world.tick()
    assert shown(world) == []
    ticked(bridge, world, 3)
    bridge.close()
    world.tick()
    assert shown(world) == []


def walkers(world: carla.World) -> list[carla.Actor]:
    return [actor for actor in world.get_actors().filter("walker.*") if actor.attributes["role_name"] == ROLE]


def test_people_walk_where_sumo_has_them_and_wait_on_the_pavement(client: carla.Client, walked: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, walked, "walk.sumocfg")
    ticked(bridge, world, 60)
    assert bridge.display.waiting == {}
    assert len(walkers(world)) == 4
    by_name = {name: world.get_actor(actor_id) for name, actor_id in bridge.walker_ids.items()}
    before = by_name["walker"].get_location()
    x_m, y_m = bridge.link.api.person.getPosition("walker")
    assert (before.x, before.y) == pytest.approx((x_m, -y_m), abs=0.08), "a walker makes its own next step in the tick"
    ticked(bridge, world, 20)
    after = by_name["walker"].get_location()
    assert 0.8 < after.x - before.x < 2.0, "a second of walking east"
    assert by_name["walker"].get_velocity().x > 0.8, "a walker has the speed that its gait shows"
    kerb_y_m = -(bridge.link.api.lane.getShape("ab_1")[0][1] - 1.6)
    assert by_name["early"].get_location().y > kerb_y_m, "beside the lane, not on it"
    assert bridge.counts.people == 4
    assert len({actor.type_id for actor in by_name.values()}) == 4
    bridge.close()
    world.tick()
    assert walkers(world) == []


def test_a_walker_that_another_client_destroys_comes_back(client: carla.Client, walked: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, walked, "walk.sumocfg")
    ticked(bridge, world, 3)
    world.get_actor(bridge.walker_ids["walker"]).destroy()
    world.tick()
    ticked(bridge, world, 3)
    assert "person walker" not in bridge.display.waiting
    assert world.get_actor(bridge.walker_ids["walker"]) is not None
    bridge.close()


@pytest.mark.parametrize(("aside_m", "stops"), [(0.0, True), (4.0, False)])
def test_sumo_s_driver_stops_for_a_walker_of_carla_on_the_lane_alone(
    client: carla.Client, folder: Path, aside_m: float, *, stops: bool
) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    bridge.link.step()
    lane_y_m = -bridge.link.api.vehicle.getPosition("one")[1]
    bridge.link.close()
    blueprint = world.get_blueprint_library().find("walker.pedestrian.0001")
    ground = world.get_map().get_waypoint(carla.Location(80.0, lane_y_m, 248.0), lane_type=carla.LaneType.Any)
    place = carla.Location(80.0, lane_y_m + aside_m, ground.transform.location.z + 1.0)
    walker = world.spawn_actor(blueprint, carla.Transform(place))
    walker.set_simulate_physics(False)
    world.tick()
    bridge = bridge_to(client, folder)
    ticked(bridge, world, 300)
    front_m = bridge.link.api.vehicle.getPosition("one")[0]
    assert (front_m < 80.0) is stops
    walker.destroy()
    world.tick()
    ticked(bridge, world, 60)
    assert f"carla{walker.id}" not in bridge.link.api.vehicle.getIDList()
    assert bridge.link.api.vehicle.getSpeed("one") > 1.0, "it drives on"
    bridge.close()
