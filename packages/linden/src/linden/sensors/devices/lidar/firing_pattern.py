"""Firing pattern of a lidar: its channels, how far it turns in a time, and the rays of a sweep.

Source of meaning: CARLA 0.9.16, RayCastSemanticLidar.cpp.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform
from linden.sensors.casting.caster import Rays
from linden.sensors.casting.thread_pool import in_stretches

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]


MOST_RAYS = 4 * 1024 * 1024
"""Of one measurement, whatever time it covers: some seconds of work. Those of a longer time lie further apart."""


class Fan(NamedTuple):
    """Degrees, turns a second, points a second, m."""

    channels: int
    upper_deg: float
    lower_deg: float
    horizontal_deg: float
    rotation_hz: float
    points_per_s: int
    range_m: float


class Fired(NamedTuple):
    """The directions of a sweep in the sensor's frame; ray ``channel * P + step`` goes (level c, level s, up)."""

    up: F32  # (channels,) sine of the pitch
    level: F32  # (channels,) cosine
    cosine: F32  # (P,) of the yaw
    sine: F32  # (P,)

    @property
    def rays(self) -> int:
        """Return the number of rays."""
        return len(self.up) * len(self.sine)


def read_fan(description: ActorDescription) -> Fan:
    """Read a complete description."""
    return Fan(
        channels=max(1, int(description.attribute("channels"))),
        upper_deg=description.number("upper_fov"),
        lower_deg=description.number("lower_fov"),
        horizontal_deg=description.number("horizontal_fov"),
        rotation_hz=description.number("rotation_frequency"),
        points_per_s=int(description.attribute("points_per_second")),
        range_m=description.number("range"),
    )


def points_a_channel(fan: Fan, interval_s: float) -> int:
    """Return how many points each channel fires in a time; a half counts as one, and :data:`MOST_RAYS` are the most."""
    wanted = math.floor(fan.points_per_s * interval_s / fan.channels + 0.5)
    return max(0, min(wanted, MOST_RAYS // fan.channels))


def turned_on(fan: Fan, start_deg: float, interval_s: float) -> float:
    """Return the angle at which the sweep after one from ``start_deg`` begins; 0 is the left edge, which lies behind.

    The last digits are rounded away, so that whole turns end where they began.
    """
    if not fan.horizontal_deg:
        return 0.0
    end_deg = math.fmod(start_deg + fan.rotation_hz * fan.horizontal_deg * interval_s, fan.horizontal_deg)
    return 0.0 if math.isclose(end_deg, fan.horizontal_deg, rel_tol=1e-9) else round(end_deg, 9)


def fire(fan: Fan, start_deg: float, interval_s: float) -> Fired:
    """Return the rays of a sweep that begins at an angle and takes a time."""
    count = points_a_channel(fan, interval_s)
    step_deg = fan.rotation_hz * fan.horizontal_deg * interval_s / max(1, count)
    at_deg = start_deg + step_deg * np.arange(count)
    if fan.horizontal_deg:
        at_deg = np.fmod(at_deg, fan.horizontal_deg)
    yaw = np.radians(at_deg - 0.5 * fan.horizontal_deg)
    return Fired(
        *_channels(fan.channels, fan.upper_deg, fan.lower_deg),
        np.cos(yaw).astype(np.float32),
        np.sin(yaw).astype(np.float32),
    )


@lru_cache(maxsize=64)
def _channels(count: int, upper_deg: float, lower_deg: float) -> tuple[F32, F32]:
    """Return sine and cosine (count,) of the channels' pitch; one channel alone looks along the upper edge."""
    pitch = np.radians(np.linspace(upper_deg, lower_deg, count))
    return np.sin(pitch).astype(np.float32), np.cos(pitch).astype(np.float32)


def aim(fired: Fired, number: I32, pose: Transform) -> Rays:
    """Return the rays of these numbers (N,) in the world, for a lidar at a pose."""
    turn, place = rotation_matrix(pose.rotation).astype(np.float32), np.array(pose.location, np.float32)
    origin, direction = np.empty((len(number), 3), np.float32), np.empty((len(number), 3), np.float32)

    def work(start: int, stop: int) -> None:
        _aim(*fired, number, turn, place, origin, direction, start, stop)

    in_stretches(len(number), work, multiple=16)
    return Rays(origin, direction)


@unlocked
def _aim(
    up: F32,
    level: F32,
    cosine: F32,
    sine: F32,
    number: I32,
    turn: F32,
    place: F32,
    origin: F32,
    direction: F32,
    start: int,
    stop: int,
) -> None:  # pragma: no cover - compiled
    for ray in range(start, stop):
        channel, step = number[ray] // len(sine), number[ray] % len(sine)
        x, y, z = level[channel] * cosine[step], level[channel] * sine[step], up[channel]
        for axis in range(3):
            origin[ray, axis] = place[axis]
            direction[ray, axis] = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z
