"""Claims about bad input to a live server: 10,000 bad packets, while the official client goes on driving ticks.

The packets come from a seed. Five kinds, a fifth each: noise, requests cut off, requests with bytes changed, requests
with arguments of any type, and requests of the right types with values that nobody means: forces of 1e30 N, actors at
the end of the world, spawns of anything anywhere. Functions that would rightly end the other client's episode, change
its settings or destroy its vehicle are left out; being hindered by those is no bug.
"""

import contextlib
import socket

import carla
import pytest

from fakes.nonsense import connections
from servers import RunningServer
from spawn_points import spawn_point

SEED = 20_261_121
PACKETS = 10_000
PACKETS_A_TICK = 50


def send(port: int, packets: list[bytes]) -> None:
    """Send packets over a connection of their own and leave, as abruptly as the server may close it."""
    with socket.create_connection(("127.0.0.1", port), 10.0) as rude, contextlib.suppress(OSError):
        rude.sendall(b"".join(packets))  # an error: it was closed by the server, as it should be with most of these


@pytest.mark.slow
def test_ten_thousand_bad_packets_hinder_no_other_client(server: RunningServer, world: carla.World) -> None:
    blueprint = world.get_blueprint_library().filter("vehicle.*")[0]
    vehicle = world.spawn_actor(blueprint, spawn_point(world, 0))
    frame, sent, next_tick = world.tick(), 0, PACKETS_A_TICK
    for number, packets in enumerate(connections(SEED, PACKETS)):
        send(server.streaming_port if number % 50 == 0 else server.port, packets)
        sent += len(packets)
        if sent >= next_tick:
            now = world.tick()
            assert now > frame
            frame, next_tick = now, sent + PACKETS_A_TICK
    assert sent >= PACKETS
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
