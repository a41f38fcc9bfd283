"""The same commands give the same bytes: every snapshot of two servers, read off their streams, is compared."""

import socket
import struct

import carla
import pytest

from servers import RunningServer, running_server

TICKS = 400
VEHICLES = 30
WALKERS = 10


class Recording:
    """A subscriber to the world's snapshots that keeps what it gets, byte by byte."""

    def __init__(self, server: RunningServer) -> None:
        self._socket = socket.create_connection(("127.0.0.1", server.streaming_port), timeout=20.0)
        self._socket.sendall(struct.pack("<I", 1))
        self._file = self._socket.makefile("rb")

    def message(self) -> bytes:
        (size,) = struct.unpack("<I", self._file.read(4))
        return self._file.read(size)

    def until(self, frame: int) -> list[bytes]:
        found = []
        while not found or struct.unpack_from("<Q", found[-1], 8)[0] < frame:
            found.append(self.message())
        return found

    def close(self) -> None:
        self._file.close()
        self._socket.close()


def drive(*, throttle: float) -> list[bytes]:
    """Return every snapshot of a drive of many vehicles that bump into each other, walkers and changing lights."""
    with running_server("--sync") as server:
        client = carla.Client("127.0.0.1", server.port)
        client.set_timeout(20.0)
        world = client.get_world()
        recording = Recording(server)
        library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
        models = ("vehicle.tesla.model3", "vehicle.easymile.ez10", "vehicle.kawasaki.ninja")
        spawn = [
            carla.command.SpawnActor(library.find(models[number % 3]), point)
            for number, point in enumerate(points[:VEHICLES])
        ] + [
            carla.command.SpawnActor(library.find("walker.pedestrian.0001"), point)
            for point in points[VEHICLES : VEHICLES + WALKERS]
        ]
        ids = [answer.actor_id for answer in client.apply_batch_sync(spawn, True)]
        for tick in range(TICKS):
            steer = 0.4 * ((tick // 25) % 3 - 1)
            client.apply_batch(
                [
                    carla.command.ApplyVehicleControl(actor_id, carla.VehicleControl(throttle=throttle, steer=steer))
                    for actor_id in ids[:VEHICLES]
                ]
                + [
                    carla.command.ApplyWalkerControl(actor_id, carla.WalkerControl(carla.Vector3D(y=1.0), 1.2))
                    for actor_id in ids[VEHICLES:]
                ]
            )
            frame = world.tick()
        messages = recording.until(frame)
        recording.close()
        return messages


@pytest.fixture(scope="module")
def first() -> list[bytes]:
    return drive(throttle=0.7)


@pytest.mark.slow
def test_two_runs_are_equal_byte_by_byte(first: list[bytes]) -> None:
    second = drive(throttle=0.7)
    assert len(first) == len(second) > TICKS
    assert all(one == other for one, other in zip(first, second, strict=True))


@pytest.mark.slow
def test_another_command_gives_other_bytes(first: list[bytes]) -> None:
    assert first[-1] != drive(throttle=0.71)[-1]
