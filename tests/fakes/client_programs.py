"""Clients in processes of their own, which print a number after every step and can be killed at any moment.

Each is given the server's port and, if it drives, the number of the spawn point where it begins.
"""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

BEGIN = """
import carla, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
world = client.get_world()
points = world.get_map().get_spawn_points()
library = world.get_blueprint_library()
first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
def car(place):
    return world.try_spawn_actor(library.find("vehicle.tesla.model3"), points[place % len(points)])
"""
TICKING = BEGIN + "while True: print(world.tick(), flush=True)\n"
RELOADING = BEGIN + "while True: client.reload_world(False); print(world.tick(), flush=True)\n"
LISTENING = (
    BEGIN
    + """
ego = car(first)
sensors = [world.spawn_actor(library.find("sensor.other." + kind), carla.Transform(), attach_to=ego)
           for kind in ("imu", "gnss", "collision")]
for sensor in sensors:
    sensor.listen(lambda event: None)
while True: print(world.tick(), flush=True)
"""
)
TRAFFIC = (
    BEGIN
    + """
manager = client.get_trafficmanager(0)
manager.set_synchronous_mode(True)
world.tick()
for place in range(10):
    vehicle = car(place)
    if vehicle is not None:
        vehicle.set_autopilot(True, manager.get_port())
print(manager.get_port(), flush=True)
while True: print(world.tick(), flush=True)
"""
)
LATE = """
import carla, os, sys, time
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(1.0)
world = client.get_world()
def late(snapshot):
    os.write(1, b"1\\n")
    time.sleep(0.4)
world.on_tick(late)
os.write(1, b"0\\n")
time.sleep(3.0)
"""
"""It ticks nothing, and its thread takes 0.4 s for each snapshot. A call without an answer fails after 1 s."""


@contextmanager
def client_program(port: int, text: str, first: int = 0) -> Iterator["subprocess.Popen[str]"]:
    """Such a client, killed at the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", text, str(port), str(first)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def numbers(process: "subprocess.Popen[str]", count: int) -> list[int]:
    """The next numbers that it prints; waits for them."""
    assert process.stdout is not None
    return [int(process.stdout.readline()) for _ in range(count)]
