"""Claims about SUMO's vehicles in a live simulator, and CARLA's in SUMO."""

from collections.abc import Iterator
from pathlib import Path

import carla
import pytest

from basu.sumo.bridge import ROLE, Bridge
from basu.sumo.link import in_process
from servers import RunningServer

STEP_S = 0.05


@pytest.fixture
def client(simulator: RunningServer) -> Iterator[carla.Client]:
    """A client whose world is still and has nothing left in it."""
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(120.0)
    world = client.get_world()
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    yield client
    for actor in world.get_actors().filter("vehicle.*"):
        actor.destroy()
    world.apply_settings(before)


def bridge_to(client: carla.Client, folder: Path, **options: object) -> Bridge:
    world = client.get_world()
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    bridge = Bridge(link, client, world, world.get_map(), lights="none", **options)  # type: ignore[arg-type]
    bridge.is_level = False  # the small network lies on Linden's ground, and has no heights of its own
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
    assert bridge.counts == (1, 1, 0, 1)
    bridge.close()


def test_a_vehicle_whose_place_is_taken_waits_and_is_shown_later(client: carla.Client, folder: Path) -> None:
    world = client.get_world()
    bridge = bridge_to(client, folder)
    bridge.link.step()
    x_m, y_m = bridge.link.api.vehicle.getPosition("one")
    obstacle = parked(world, x_m, -y_m)
    bridge._known.add(obstacle.id)  # SUMO does not see it, so its vehicle does not wait by itself
    bridge._departed += 1
    bridge._kinds["one"] = bridge._kind("one")
    bridge.link.api.vehicle.subscribe("one", (0x39, 0x43, 0x36, 0x5B))
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
