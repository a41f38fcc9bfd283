"""Claims about clients that are killed, hang or come in crowds: what they leave behind is no more than CARLA leaves.

The long versions, with figures, are the rows of ``benchmarks/soak.py``.
"""

from collections.abc import Callable, Iterator

import carla
import psutil
import pytest

from fakes.client_programs import LATE, LISTENING, TRAFFIC, client_program, numbers
from fakes.raw_client import RawClient, RawSubscriber
from servers import END_LIMIT_S, RunningServer, running_server


@pytest.fixture
def raw(server: RunningServer, world: carla.World) -> Iterator[RawClient]:
    """A client that speaks bytes, in the fresh episode of ``world``."""
    with RawClient(server.port) as client:
        yield client


def test_what_a_killed_client_spawned_stays_and_others_can_clear_it_away(
    server: RunningServer, client: carla.Client, world: carla.World
) -> None:
    with client_program(server.port, LISTENING) as victim:
        ticks = numbers(victim, 20)
        victim.kill()
        victim.wait()
    assert world.tick() > ticks[-1]
    left = [actor for actor in world.get_actors() if actor.type_id.startswith(("vehicle.", "sensor."))]
    assert len(left) == 4
    destroyed = client.apply_batch_sync([carla.command.DestroyActor(actor) for actor in left], True)
    assert not any(answer.has_error() for answer in destroyed[:1])
    world.tick()
    assert not [actor for actor in world.get_actors() if actor.type_id.startswith(("vehicle.", "sensor."))]


def test_the_port_of_a_killed_traffic_manager_is_free_again(server: RunningServer, raw: RawClient) -> None:
    with client_program(server.port, TRAFFIC) as victim:
        (port,) = numbers(victim, 1)
        assert raw.call("is_traffic_manager_running", port) is True
        numbers(victim, 10)
        victim.kill()
        victim.wait()
    while raw.call("is_traffic_manager_running", port):
        pass
    assert raw.call("tick_cue") > 0


def test_a_server_that_ends_takes_no_client_along_that_has_yet_to_read_the_lamps() -> None:
    """Without an answer to that call LibCarla would end the client's process by ``std::terminate``."""
    with running_server("--sync") as own, client_program(own.port, LATE) as program, RawClient(own.port) as ticking:
        numbers(program, 1)
        ticking.call("tick_cue")
        numbers(program, 1)
        ticking.call("tick_cue")
        own.process.terminate()
        assert own.process.wait(END_LIMIT_S) == 0
        assert program.wait(END_LIMIT_S) == 0


def least_growth_mib(server: RunningServer, act: Callable[[], None], times: int) -> float:
    """The least of three rounds' growth in memory: a leak is in all of them, a pool that is filled in one."""
    process, growths = psutil.Process(server.process.pid), []
    for _ in range(3):
        before = process.memory_info().rss
        for _ in range(times):
            act()
        growths.append((process.memory_info().rss - before) / 2**20)
    return min(growths)


def test_reloads_take_no_memory(server: RunningServer, raw: RawClient) -> None:
    def reload() -> None:
        raw.call("load_new_episode", "", False, 0xFFFF)
        raw.call("tick_cue")

    assert least_growth_mib(server, reload, 40) < 1.0


def test_sensors_that_come_and_go_take_no_memory_and_no_files(server: RunningServer, raw: RawClient) -> None:
    points = raw.call("get_map_info")[1]
    car = raw.call("spawn_actor", [0, "vehicle.tesla.model3", []], points[0])[0]
    imu, at_its_middle = [0, "sensor.other.imu", []], [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]

    def cycle() -> None:
        sensor = raw.call("spawn_actor_with_parent", imu, at_its_middle, car, 0, "")
        with RawSubscriber(server.streaming_port, int.from_bytes(sensor[5][:4], "little")) as listener:
            raw.call("tick_cue")
            listener.socket.setblocking(False)
        assert raw.call("destroy_actor", sensor[0]) is True
        raw.call("tick_cue")

    before_files = psutil.Process(server.process.pid).num_fds()
    assert least_growth_mib(server, cycle, 100) < 0.5
    assert psutil.Process(server.process.pid).num_fds() <= before_files + 2


def test_a_hundred_silent_connections_keep_no_client_out(server: RunningServer, raw: RawClient) -> None:
    silent = [RawClient(server.port) for _ in range(100)]
    with RawClient(server.port) as newcomer:
        assert newcomer.call("tick_cue") > 0
    for each in silent:
        each.socket.close()


def test_a_batch_of_ten_thousand_comes_through(raw: RawClient) -> None:
    points = raw.call("get_map_info")[1]
    car = raw.call("spawn_actor", [0, "vehicle.tesla.model3", []], points[0])[0]
    control = [[2, [car, [0.1, 0.0, 0.0, False, False, False, 0]]]]
    number = raw.send("apply_batch", [control] * 10_000, False)
    assert raw.answer() == [1, number, None, [[[1, car]]] * 10_000]
