"""Claims about bad input to a live server: 10,000 damaged packets, while the official client goes on driving ticks.

The packets come from a seed, which the test run prints with a failure. Four kinds, a quarter each: noise, requests cut
off, requests with bytes changed, and whole requests with arguments of any type. Functions that would rightly end the
other client's episode or change its settings are left out; being hindered by those is no bug.
"""

import random
import socket
from collections.abc import Iterator
from typing import Any

import carla
import msgpack
import pytest

from linden.wire.vocabulary import CARLA_FUNCTIONS
from servers import RunningServer

SEED = 20_261_121
PACKETS = 10_000
PACKETS_A_CONNECTION = 20
PACKETS_A_TICK = 100
WITH_A_RIGHT_TO_CHANGE_THE_SESSION = {
    "load_new_episode",
    "copy_opendrive_to_file",
    "set_episode_settings",
    "destroy_actor",
    "apply_batch",
}
METHODS = sorted(CARLA_FUNCTIONS.keys() - WITH_A_RIGHT_TO_CHANGE_THE_SESSION)


def noise(chance: random.Random) -> bytes:
    return chance.randbytes(chance.randrange(1, 200))


SCALARS: list[Any] = [
    *(None, True, False),
    *(0, 1, -1, 24, 200, 2**31, 2**32 - 1, 2**64 - 1, -(2**63)),
    *(0.0, 1.5, -1e30, 1e308, float("nan"), float("inf"), -float("inf")),
    *("", "hero", "vehicle.easymile.ez10", "x" * 300, "\udcff", "Frame"),
    *(b"", b"\0\1\2", bytes(24)),
    [0.0, 0.0, 0.0],
    [[1.0, 2.0, 3.0], [0.0, 90.0, 0.0]],
]


def argument(chance: random.Random, depth: int = 0) -> Any:
    if depth < 4 and chance.random() < 0.2:
        return [argument(chance, depth + 1) for _ in range(chance.randrange(6))]
    return chance.choice(SCALARS)


def request(chance: random.Random) -> bytes:
    arguments = [argument(chance) for _ in range(chance.randrange(5))]
    message = [0, chance.randrange(2**32), chance.choice(METHODS), [[chance.random() < 0.5], *arguments]]
    packed: bytes = msgpack.packb(message, unicode_errors="surrogateescape")
    return packed


def cut_off(chance: random.Random) -> bytes:
    whole = request(chance)
    return whole[: chance.randrange(1, len(whole))]


def changed(chance: random.Random) -> bytes:
    whole = bytearray(request(chance))
    start = whole.find(b"\x91")  # behind the name: a changed name is only a function that does not exist
    for _ in range(chance.randrange(1, 6)):
        whole[chance.randrange(start, len(whole))] = chance.randrange(256)
    return bytes(whole)


def packets(seed: int, count: int) -> Iterator[bytes]:
    chance = random.Random(seed)
    for _ in range(count):
        yield chance.choice((noise, cut_off, changed, request))(chance)


def send(port: int, some: list[bytes]) -> None:
    """Send packets over a connection of their own and leave, as abruptly as the server may close it."""
    with socket.create_connection(("127.0.0.1", port), 10.0) as rude:
        try:
            for packet in some:
                rude.sendall(packet)
        except OSError:
            pass  # closed by the server: what it should do with most of these


@pytest.mark.slow
def test_ten_thousand_bad_packets_hinder_nobody(server: RunningServer, world: carla.World) -> None:
    blueprint = world.get_blueprint_library().filter("vehicle.*")[0]
    vehicle = world.spawn_actor(blueprint, world.get_map().get_spawn_points()[0])
    frame = world.tick()
    pending: list[bytes] = []
    for i, packet in enumerate(packets(SEED, PACKETS), start=1):
        pending.append(packet)
        if i % PACKETS_A_CONNECTION == 0:
            send(server.streaming_port if i % (10 * PACKETS_A_CONNECTION) == 0 else server.port, pending)
            pending.clear()
        if i % PACKETS_A_TICK == 0:
            now = world.tick()
            assert now > frame
            frame = now
    assert vehicle.id in {actor.id for actor in world.get_actors()}
    assert vehicle.destroy()
    assert "internal error" not in server.log()
    assert "Traceback" not in server.log()


def test_one_message_of_a_hundred_megabytes_closes_its_connection_only(
    server: RunningServer, world: carla.World
) -> None:
    with socket.create_connection(("127.0.0.1", server.port), 10.0) as rude:
        rude.sendall(b"\x94\x00\x01\xa7version\x92\x91\xc2\xc6" + (100_000_000).to_bytes(4, "big"))
        block = bytes(1_000_000)
        with pytest.raises(OSError):
            send_for_ever(rude, block)
    assert world.tick() > 0
    assert "64" in server.log() or "67108864" in server.log()


def send_for_ever(rude: socket.socket, block: bytes) -> None:
    while True:
        rude.sendall(block)
