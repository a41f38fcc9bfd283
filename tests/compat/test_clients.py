"""Claims about several clients at once: as CARLA has it, any of them may tick, and none depends on another."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import carla

from servers import RunningServer
from spawn_points import spawn_point

TICKING = """
import carla, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(20.0)
world = client.get_world()
while True:
    print(world.tick(), flush=True)
"""


def another(server: RunningServer) -> carla.Client:
    client = carla.Client("127.0.0.1", server.port)
    client.set_timeout(20.0)
    return client


def await_frame(world: carla.World, frame: int) -> None:
    """Wait until the snapshot of a frame that another client made has reached this one."""
    while world.get_snapshot().frame < frame:
        os.sched_yield()


def spawn(world: carla.World, place: int = 0) -> carla.Actor:
    blueprint = world.get_blueprint_library().filter("vehicle.*")[0]
    return world.spawn_actor(blueprint, spawn_point(world, place))


def test_the_client_finds_its_own_version(client: carla.Client) -> None:
    assert client.get_server_version() == client.get_client_version() == "0.9.16"


def test_a_second_client_joining_in_synchronous_mode_sees_the_world_without_a_tick(
    server: RunningServer, world: carla.World
) -> None:
    vehicle = spawn(world)
    frame = world.tick()
    seen = another(server).get_world()
    await_frame(seen, frame)  # sent to whoever subscribes; in this mode the client does not wait for it by itself
    assert seen.get_snapshot().frame == frame
    assert vehicle.id in {actor.id for actor in seen.get_actors()}
    assert seen.get_settings().synchronous_mode


def test_two_clients_ticking_advance_two_frames(server: RunningServer, world: carla.World) -> None:
    other = another(server).get_world()
    first = world.tick()
    assert other.tick() == first + 1
    assert world.tick() == first + 2
    await_frame(other, first + 2)
    assert world.get_snapshot().timestamp == other.get_snapshot().timestamp


def test_what_one_client_spawns_another_drives_and_a_third_destroys(server: RunningServer, world: carla.World) -> None:
    vehicle = spawn(world)
    world.tick()
    driver, wrecker = another(server).get_world(), another(server).get_world()
    driver.get_actor(vehicle.id).apply_control(carla.VehicleControl(throttle=0.5))
    await_frame(world, driver.tick())
    assert world.get_actor(vehicle.id).get_control().throttle == 0.5
    assert wrecker.get_actor(vehicle.id).destroy()
    wrecker.tick()
    assert vehicle.id not in {actor.id for actor in wrecker.get_actors()}


@contextmanager
def ticking_client(server: RunningServer) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(
        [sys.executable, "-c", TICKING, str(server.port)], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def test_a_client_killed_in_the_middle_of_ticking_leaves_the_server_to_the_others(
    server: RunningServer, world: carla.World
) -> None:
    with ticking_client(server) as victim:
        assert victim.stdout is not None
        ticks = [int(victim.stdout.readline()) for _ in range(50)]
        victim.kill()
        victim.wait()
    assert ticks == sorted(ticks)
    frame = world.tick()
    assert frame > ticks[-1]
    assert world.tick() == frame + 1


def test_two_processes_ticking_at_once_never_share_a_frame(server: RunningServer, world: carla.World) -> None:
    with ticking_client(server) as one, ticking_client(server) as another_one:
        assert one.stdout is not None
        assert another_one.stdout is not None
        ticks = [[int(process.stdout.readline()) for _ in range(200)] for process in (one, another_one)]
    assert set(ticks[0]).isdisjoint(ticks[1])


def test_a_traffic_manager_is_found_by_other_clients_until_its_own_ends_it(
    server: RunningServer, client: carla.Client
) -> None:
    manager = client.get_trafficmanager(0)
    port = manager.get_port()
    assert another(server).get_trafficmanager(port).get_port() == port
    manager.shut_down()
