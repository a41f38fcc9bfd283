"""Digests of all bytes that a session gets from the server, to compare the server before and after a change.

    python benchmarks/wire_bytes.py [--source src] [--ticks 200]
    python benchmarks/wire_bytes.py --against ../before/src

The official client drives the session: vehicles of four kinds, walkers, props, crashes, a car on its roof, changed
physics, rain, a friction trigger, and eight kinds of sensors. Each stream is read off its socket beside the client;
answers of calls are read by a client that keeps their bytes. ``--source`` names the folder of packages that the server
runs from. With ``--against`` the session runs twice, from two folders, and the
command ends with 1 if a digest differs.
"""

import argparse
import hashlib
import os
import re
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import carla
import msgpack

HERE = Path(__file__).parents[1] / "packages" / "linden" / "src"
TIMEOUT_S = 120.0
WORLD_OBSERVER, FIRST_SENSOR = 1, 2
KINDS = ("vehicle.tesla.model3", "vehicle.easymile.ez10", "vehicle.kawasaki.ninja", "vehicle.ford.ambulance")
SENSORS = {
    "sensor.lidar.ray_cast": {"channels": "16", "points_per_second": "40000", "range": "60"},
    "sensor.lidar.ray_cast_semantic": {"channels": "8", "points_per_second": "20000"},
    "sensor.camera.semantic_segmentation": {"image_size_x": "96", "image_size_y": "64"},
    "sensor.other.radar": {},
    "sensor.other.gnss": {},
    "sensor.other.imu": {},
    "sensor.other.collision": {},
    "sensor.other.obstacle": {},
}
QUESTIONS = (
    "get_physics_control",
    "get_telemetry_data",
    "get_actor_component_world_transform",
    "get_vehicle_light_states",
)


class Stream(threading.Thread):
    """Read one stream to its end and keep a digest of it."""

    def __init__(self, port: int, number: int) -> None:
        super().__init__(daemon=True)
        self._socket = socket.create_connection(("127.0.0.1", port), TIMEOUT_S)
        self._socket.sendall(struct.pack("<I", number))
        self.digest, self.messages = hashlib.sha256(), 0
        self.start()

    def run(self) -> None:
        """Read until the server closes the stream."""
        with self._socket.makefile("rb", buffering=1 << 20) as file:
            while len(head := file.read(4)) == 4:
                message = file.read(struct.unpack("<I", head)[0])
                self.digest.update(message)
                self.messages += 1


class Calls:
    """One connection of calls that keeps a digest of the answers."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection(("127.0.0.1", port), TIMEOUT_S)
        self._unpacker, self._number = msgpack.Unpacker(), 0
        self.digest = hashlib.sha256()

    def ask(self, method: str, *arguments: object) -> None:
        """Call a function, a refusal being an answer too."""
        self._number += 1
        self._socket.sendall(msgpack.packb([0, self._number, method, [[False], *arguments]]))
        while True:
            data = self._socket.recv(65536)
            self.digest.update(data)
            self._unpacker.feed(data)
            if any(True for _ in self._unpacker):
                return


@contextmanager
def server(source: Path) -> Iterator[tuple[int, int]]:
    """Yield the ports of a server that runs from a folder of packages."""
    arguments = [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--sync"]
    environment = {**os.environ, "PYTHONPATH": str(source.resolve())}
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        ready = next((line for line in process.stdout if line.startswith("linden: ready")), None)
        if ready is None:
            raise SystemExit(f"the server of {source} ended before it was ready")
        port, streaming_port = (int(number) for number in re.findall(r"port (\d+)", ready))
        yield port, streaming_port
    finally:
        process.terminate()
        process.wait()


def session(source: Path, ticks: int) -> dict[str, str]:
    """Return the digests of one session by the name of what was read."""
    with server(source) as (port, streaming_port):
        client = carla.Client("127.0.0.1", port)
        client.set_timeout(TIMEOUT_S)
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, 0.05
        world.apply_settings(settings)
        streams, calls = {"snapshots": Stream(streaming_port, WORLD_OBSERVER)}, Calls(port)
        vehicles, walkers = populate(world)
        for number, (name, chosen) in enumerate(SENSORS.items()):
            blueprint = world.get_blueprint_library().find(name)
            for attribute, value in chosen.items():
                blueprint.set_attribute(attribute, value)
            place = carla.Transform(carla.Location(x=1.5, z=2.2))
            world.spawn_actor(blueprint, place, attach_to=vehicles[0])
            streams[name] = Stream(streaming_port, FIRST_SENSOR + number)
        for tick in range(ticks):
            disturb(world, vehicles, tick)
            command(client, vehicles, walkers, tick)
            world.tick(TIMEOUT_S)
            if tick % 50 == 49:
                for vehicle in vehicles[:6]:
                    for question in QUESTIONS:
                        calls.ask(question, vehicle.id, *(("front_left",) if "component" in question else ()))
        calls.ask("get_environment_objects", 0)
    for stream in streams.values():
        stream.join(TIMEOUT_S)
    found = {name: f"{stream.messages:5} {stream.digest.hexdigest()}" for name, stream in streams.items()}
    return {**found, "answers": f"      {calls.digest.hexdigest()}"}


def populate(world: carla.World) -> tuple[list[carla.Vehicle], list[carla.Walker]]:
    """Spawn vehicles, walkers ahead of some of them, and cones ahead of others."""
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    vehicles, walkers = [], []
    for number, point in enumerate(points[:24]):
        vehicles.append(world.spawn_actor(library.find(KINDS[number % len(KINDS)]), point))
        ahead = point.transform(carla.Vector3D(9.0, 0.0, 0.6))
        place = carla.Transform(carla.Location(ahead), point.rotation)
        if number % 3 == 0 and (walker := world.try_spawn_actor(library.find("walker.pedestrian.0003"), place)):
            walkers.append(walker)
        elif number % 3 == 1:
            world.try_spawn_actor(library.find("static.prop.trafficcone01"), place)
    trigger = library.find("static.trigger.friction")
    for attribute, value in {"friction": 0.3, "extent_x": 900.0, "extent_y": 900.0, "extent_z": 300.0}.items():
        trigger.set_attribute(attribute, str(value))
    world.spawn_actor(trigger, points[5])
    return vehicles, walkers


def disturb(world: carla.World, vehicles: list[carla.Vehicle], tick: int) -> None:
    """Change weather, physics, pushes and actors at certain ticks."""
    if tick == 30:
        control = vehicles[1].get_physics_control()
        control.mass, control.drag_coefficient = 3000.0, 0.5
        vehicles[1].apply_physics_control(control)
    if tick == 50:
        vehicles[2].add_impulse(carla.Vector3D(0.0, 3000.0, 900.0))
        vehicles[4].add_impulse(carla.Vector3D(2000.0, 26000.0, 16000.0))
    if tick == 60:
        world.set_weather(carla.WeatherParameters.HardRainNoon)
    if tick == 80:
        vehicles[6].enable_constant_velocity(carla.Vector3D(4.0, 0.0, 0.0))
        vehicles[7].apply_ackermann_control(carla.VehicleAckermannControl(speed=6.0, acceleration=2.0))
    if tick == 100:
        vehicles.pop().destroy()
        pose = vehicles[3].get_transform()
        pose.location.z += 4.0
        pose.rotation.roll = 170.0
        vehicles[3].set_transform(pose)


def command(client: carla.Client, vehicles: list[carla.Vehicle], walkers: list[carla.Walker], tick: int) -> None:
    """Steer all vehicles but the one with a target of its own, and let the walkers walk."""
    steer = 0.5 * ((tick // 25) % 3 - 1)
    control = carla.VehicleControl(throttle=0.8, steer=steer, brake=1.0 if tick % 60 > 52 else 0.0)
    walk = carla.WalkerControl(carla.Vector3D(y=1.0), 1.4)
    client.apply_batch(
        [carla.command.ApplyVehicleControl(each.id, control) for n, each in enumerate(vehicles) if n != 7 or tick < 80]
        + [carla.command.ApplyWalkerControl(each.id, walk) for each in walkers]
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", type=Path, default=HERE, help="folder of packages (default: that of this checkout)")
    parser.add_argument("--against", type=Path, help="a second folder of packages")
    parser.add_argument("--ticks", type=int, default=200)
    options = parser.parse_args()
    found = session(options.source, options.ticks)
    other = found if options.against is None else session(options.against, options.ticks)
    for name, digest in found.items():
        print(f"{name:36} {digest} {'' if digest == other[name] else '  differs'}")
    raise SystemExit(0 if found == other else 1)


if __name__ == "__main__":
    main()
