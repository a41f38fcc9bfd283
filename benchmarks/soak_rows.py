"""Rows of soak.py, of clients that come, go, are killed or read slowly: each does so a number of times.

A row takes the server, how often, and what to call after every repetition; it returns a remark.
"""

import contextlib
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import carla
import psutil

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from fakes.client_programs import LISTENING, client_program, numbers
from fakes.raw_client import RawClient, RawSubscriber

Done = Callable[[], None]


class Target(NamedTuple):
    """The server under test."""

    process: psutil.Process
    port: int
    streaming_port: int
    log: Path


def caller(target: Target) -> RawClient:
    """A connection that speaks bytes, and has patience with a server that is plagued."""
    return RawClient(target.port, timeout_s=60.0)


def subscriber(target: Target, stream_id: int) -> RawSubscriber:
    return RawSubscriber(target.streaming_port, stream_id)


def settle(target: Target, synchronous: bool = True) -> None:  # noqa: FBT001, FBT002 - what a row asks for
    """Begin a new episode, in one mode or the other, and tick a few times: what a client that behaves does next."""
    with caller(target) as client:
        client.call("load_new_episode", "Linden", True, 0xFFFF)
        settings = [synchronous, False, [True, 0.05], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
        client.call("set_episode_settings", settings)
        for _ in range(20):
            client.call("tick_cue")


def official(target: Target) -> tuple[carla.Client, carla.World]:
    client = carla.Client("127.0.0.1", target.port)
    client.set_timeout(60.0)
    return client, client.get_world()


# -- coming and going ------------------------------------------------------------------------------------------------


def rpc_connects(target: Target, count: int, done: Done) -> str:
    for _ in range(count):
        with caller(target) as client:
            client.call("version")
        done()
    return ""


def stream_connects(target: Target, count: int, done: Done) -> str:
    for number in range(count):
        subscriber(target, 1 + number % 50).socket.close()
        done()
    return ""


def cut_off(target: Target, count: int, done: Done) -> str:
    for number in range(count):
        client = RawClient(target.port if number % 2 else target.streaming_port)
        client.socket.sendall(client.request("tick_cue")[: 1 + number % 10] if number % 2 else b"\1\0\0"[: number % 4])
        client.reset()
        done()
    return "half by half a call, half by half a handshake"


def silent(target: Target, count: int, done: Done) -> str:
    held = []
    for _ in range(count):
        held.append(caller(target))
        done()
    open_files = target.process.num_fds()
    with caller(target) as client:
        client.call("tick_cue")
    for each in held:
        each.socket.close()
    return f"{open_files} files open meanwhile, and a tick was made"


def whole_clients(target: Target, count: int, done: Done) -> str:
    for _ in range(count):
        client, world = official(target)
        world.get_settings()
        del world, client
        done()
    return ""


# -- killed ----------------------------------------------------------------------------------------------------------


def killed(text: str) -> Callable[[Target, int, Done], str]:
    def row(target: Target, count: int, done: Done) -> str:
        for number in range(count):
            with client_program(target.port, text, number) as victim:
                numbers(victim, 30)
            with caller(target) as survivor:
                survivor.call("tick_cue")
            done()
        return "each after 30 ticks of its own; another ticked after each"

    return row


def ten_at_once(target: Target, count: int, done: Done) -> str:
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(client_program(target.port, LISTENING, 5 * number)) for number in range(10)]
        frames = [numbers(client, 1) for client in clients]
        began_s = time.monotonic()

        def follow(client: subprocess.Popen[str], mine: list[int]) -> None:
            mine += numbers(client, count // 10)

        threads = [threading.Thread(target=follow, args=pair) for pair in zip(clients, frames, strict=True)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        took_s = time.monotonic() - began_s
    for _ in range(count):
        done()
    ticks = [frame for mine in frames for frame in mine]
    return f"{count / took_s:.0f} ticks/s together, {len(ticks) - len(set(ticks))} frames shared by two"


# -- reading slowly --------------------------------------------------------------------------------------------------


def crowd(target: Target) -> None:
    """Enough actors that snapshots are not small."""
    client, world = official(target)
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    spawn, car = carla.command.SpawnActor, library.find("vehicle.tesla.model3")
    client.apply_batch_sync([spawn(car, point) for point in points[:100]], True)


def deaf_asynchronous(target: Target, count: int, done: Done) -> str:
    settle(target, synchronous=False)
    crowd(target)
    with caller(target) as client, subscriber(target, 1) as reader, contextlib.ExitStack() as stack:
        for _ in range(10):
            stack.enter_context(subscriber(target, 1))
        seen = longest_ms = 0
        for _ in range(count):  # frames beside those by the clock, so that it does not take an hour
            began_s = time.perf_counter()
            client.call("tick_cue")
            longest_ms = max(longest_ms, (time.perf_counter() - began_s) * 1000.0)
            seen += len(reader.socket.recv(1 << 20)) > 0
            done()
    return f"10 deaf subscribers of 120 actors; longest tick for the others {longest_ms:.0f} ms"


def deaf_synchronous(target: Target, count: int, done: Done) -> str:
    crowd(target)
    waits_s = []
    with caller(target) as client:
        for _ in range(count):
            with subscriber(target, 1):
                longest_s, closed = 0.0, _shown_out(target)
                patient_until_s = time.monotonic() + 300.0
                while _shown_out(target) == closed:
                    assert time.monotonic() < patient_until_s, "nobody shows the deaf one out"
                    began_s = time.perf_counter()
                    client.call("tick_cue")
                    longest_s = max(longest_s, time.perf_counter() - began_s)
                waits_s.append(longest_s)
            done()
    return f"each closed after the others had waited {max(waits_s):.1f} s at most"


def _shown_out(target: Target) -> int:
    """How many subscribers were closed because they had kept synchronous mode waiting."""
    return target.log.read_text().count("is closed: in synchronous")


def slow_loris(target: Target, count: int, done: Done) -> str:
    clients = [caller(target) for _ in range(count)]
    message = clients[0].request("get_sensor_token", 1)
    longest_ms = 0.0
    with caller(target) as other:
        for byte in message:
            for client in clients:
                client.socket.sendall(bytes([byte]))
            began_s = time.perf_counter()
            other.call("tick_cue")
            longest_ms = max(longest_ms, (time.perf_counter() - began_s) * 1000.0)
    for client in clients:
        assert client.socket.recv(1000)
        client.socket.close()
        done()
    return f"a byte a turn, all answered in the end; longest tick for another {longest_ms:.0f} ms"
