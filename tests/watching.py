"""Sensors of the official client, heard frame by frame: what they tell becomes plain values at once.

The client's own objects must not outlive their episode, and a sensor that listens must not end before its last message
is there: hence the ticks at the end.
"""

import queue
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple

import carla
import numpy as np
import pytest
from numpy.typing import NDArray

TIMEOUT_S = 60.0
"""Who looks first waits for the scene."""
PARTING_TICKS = 3
IN_WORDS = ("latitude", "longitude", "altitude", "accelerometer", "gyroscope", "compass")
"""What GNSS and IMU tell; their measurements have no raw data."""
SEMANTIC = np.dtype([("xyz", "<f4", (3,)), ("cosine", "<f4"), ("id", "<u4"), ("tag", "<u4")])


class Reading(NamedTuple):
    """What one sensor measured: the matrix (4, 4) from its frame to the world, and its bytes."""

    frame: int
    world_from_sensor: NDArray[np.float64]
    raw: bytes
    shape: tuple[int, ...]
    """Of a picture: height and width. Of a lidar: how many points each channel has."""

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 4): B, G, R, A."""
        return np.frombuffer(self.raw, np.uint8).reshape(*self.shape, 4)

    def flow(self) -> NDArray[np.float32]:
        """(height, width, 2)."""
        return np.frombuffer(self.raw, np.float32).reshape(*self.shape, 2)

    def columns(self) -> NDArray[np.float32]:
        """(N, 4): points of a lidar with their intensity, or a radar's speed, azimuth, altitude, depth."""
        return np.frombuffer(self.raw, np.float32).reshape(-1, 4)

    def detections(self) -> NDArray[np.void]:
        """(N,) of SEMANTIC."""
        return np.frombuffer(self.raw, SEMANTIC)

    def depth_m(self) -> NDArray[np.float64]:
        """(height, width), along the camera's axis."""
        blue, green, red = (self.pixels()[:, :, channel].astype(np.float64) for channel in range(3))
        return 1000.0 * (red + 256.0 * green + 65536.0 * blue) / (2.0**24 - 1.0)


def reading_of(data: carla.SensorData) -> Reading:
    """Copy what a sensor tells."""
    shape = tuple[int, ...]()
    if hasattr(data, "raw_data"):
        raw = bytes(data.raw_data)
    else:
        raw = repr([str(getattr(data, name)) for name in IN_WORDS if hasattr(data, name)]).encode()
    if hasattr(data, "height"):
        shape = data.height, data.width
    elif hasattr(data, "channels"):
        shape = tuple(data.get_point_count(channel) for channel in range(data.channels))
    return Reading(data.frame, np.array(data.transform.get_matrix()), raw, shape)


def made(
    world: carla.World,
    type_id: str,
    pose: carla.Transform,
    *,
    on: carla.Actor | None = None,
    chosen: Mapping[str, object] | None = None,
) -> carla.Sensor:
    """Spawn a sensor with these attributes, free or on an actor."""
    blueprint = world.get_blueprint_library().find(type_id)
    for name, value in (chosen or {}).items():
        blueprint.set_attribute(name, str(value))
    return world.spawn_actor(blueprint, pose, attach_to=on)


@contextmanager
def watching(world: carla.World, sensors: Mapping[str, carla.Sensor]) -> Iterator[Callable[[], dict[str, Reading]]]:
    """Listen to sensors; what is yielded ticks once and returns what all of them measured in that frame.

    The first time it ticks until all of them are heard. At the end the sensors are destroyed.
    """
    arrived: queue.Queue[tuple[str, Reading]] = queue.Queue()
    for name, sensor in sensors.items():
        sensor.listen(lambda data, name=name: arrived.put((name, reading_of(data))))
    heard = False

    def next_frame() -> dict[str, Reading]:
        nonlocal heard
        frame, found = world.tick(TIMEOUT_S), dict[str, Reading]()
        for _ in range(100 * len(sensors)):
            if len(found) == len(sensors):
                heard = True
                return found
            try:
                name, reading = arrived.get(timeout=TIMEOUT_S if heard else 1.0)
            except queue.Empty:
                frame, found = world.tick(TIMEOUT_S), {}
                continue
            if reading.frame == frame:
                found[name] = reading
        pytest.fail(f"frame {frame}: only {sorted(found)} of {sorted(sensors)} were heard")

    try:
        yield next_frame
    finally:
        for sensor in sensors.values():
            sensor.stop()
        for _ in range(PARTING_TICKS):
            world.tick(TIMEOUT_S)
        for sensor in sensors.values():
            sensor.destroy()
