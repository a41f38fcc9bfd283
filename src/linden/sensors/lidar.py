"""Lidars: rays in a fan that turns, and what they meet, as points in the sensor's frame.

Source of meaning: CARLA 0.9.16, RayCastSemanticLidar.cpp and RayCastLidar.cpp. One of their faults is left out: with a
``sensor_tick`` they fire the points of a frame where those of the whole time since the last measurement are due.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.casting.rays import Rays
from linden.geometry import rotation_matrix
from linden.sensors.looking import Look
from linden.sensors.seen import first_of_places, id_of_places
from linden.values.actors import ActorDescription

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
U32 = NDArray[np.uint32]

SEMANTIC_POINT = np.dtype([("xyz", "<f4", (3,)), ("cos_incidence", "<f4"), ("object_id", "<u4"), ("tag", "<u4")])
"""A detection of the semantic lidar: m in the sensor's frame, 0 to 1, the actor's id or 0, values.enums.SemanticTag."""

_NO_ACTOR_FROM = 0x8000_0000
"""Ids in ``Seen.object_id`` from here on are no actors'."""


class Fan(NamedTuple):
    """Where a lidar fires: degrees, turns a second, points a second, m."""

    channels: int
    upper_deg: float
    lower_deg: float
    horizontal_deg: float
    rotation_hz: float
    points_per_s: int
    range_m: float


class Losses(NamedTuple):
    """What a lidar misses and how it errs; see CARLA's manual."""

    attenuation_per_m: float
    general_rate: float
    intensity_limit: float
    zero_intensity: float
    deviation_m: float
    seed: int


class Sweep(NamedTuple):
    """What a lidar measured: points channel by channel, the uppermost first."""

    horizontal_rad: float  # where the next sweep begins
    count: U32  # (channels,) points of each
    points: F32  # (N, 4): x, y, z in the sensor's frame, m, and the intensity from 0 to 1


class SemanticSweep(NamedTuple):
    """What a semantic lidar measured, likewise."""

    horizontal_rad: float
    count: U32
    points: NDArray[np.void]  # (N,) of SEMANTIC_POINT


class Fired(NamedTuple):
    """The rays of a sweep, channel by channel."""

    channel: I32  # (N,)
    direction: F32  # (N, 3) in the sensor's frame, length 1


def read_fan(description: ActorDescription) -> Fan:
    """Read a complete description."""

    def number(name: str) -> float:
        return float(description.attribute(name))

    return Fan(
        channels=max(1, int(description.attribute("channels"))),
        upper_deg=number("upper_fov"),
        lower_deg=number("lower_fov"),
        horizontal_deg=number("horizontal_fov"),
        rotation_hz=number("rotation_frequency"),
        points_per_s=int(description.attribute("points_per_second")),
        range_m=number("range"),
    )


def read_losses(description: ActorDescription) -> Losses:
    """Read a complete description."""
    return Losses(
        attenuation_per_m=float(description.attribute("atmosphere_attenuation_rate")),
        general_rate=float(description.attribute("dropoff_general_rate")),
        intensity_limit=float(description.attribute("dropoff_intensity_limit")),
        zero_intensity=float(description.attribute("dropoff_zero_intensity")),
        deviation_m=float(description.attribute("noise_stddev")),
        seed=int(description.attribute("noise_seed")),
    )


def points_a_channel(fan: Fan, interval_s: float) -> int:
    """Return how many points each channel fires in a time; a half counts as one."""
    return max(0, math.floor(fan.points_per_s * interval_s / fan.channels + 0.5))


def fire(fan: Fan, start_deg: float, interval_s: float) -> F32:
    """Return the directions (channels, P, 3) of a sweep that begins at an angle, in the sensor's frame."""
    count = points_a_channel(fan, interval_s)
    step_deg = fan.rotation_hz * fan.horizontal_deg * interval_s / max(1, count)
    turned = np.fmod(start_deg + step_deg * np.arange(count), fan.horizontal_deg) - 0.5 * fan.horizontal_deg
    yaw = np.radians(turned)
    up, level = _channels(fan.channels, fan.upper_deg, fan.lower_deg)
    made = np.empty((fan.channels, count, 3), np.float32)
    made[:, :, 0], made[:, :, 1] = level[:, None] * np.cos(yaw), level[:, None] * np.sin(yaw)
    made[:, :, 2] = up[:, None]
    return made


@lru_cache(maxsize=64)
def _channels(count: int, upper_deg: float, lower_deg: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return sine and cosine (count,) of the channels' pitch; one channel alone looks along the upper edge."""
    pitch = np.radians(np.linspace(upper_deg, lower_deg, count))
    return np.sin(pitch), np.cos(pitch)


def turned_on(fan: Fan, start_deg: float, interval_s: float) -> float:
    """Return the angle at which the sweep after one from ``start_deg`` begins."""
    if not fan.horizontal_deg:
        return 0.0
    return math.fmod(start_deg + fan.rotation_hz * fan.horizontal_deg * interval_s, fan.horizontal_deg)


def draws(seed: int, number: int) -> np.random.Generator:
    """Return the dice of measurement ``number``, which nothing but it and the sensor's seed decide."""
    word = 0xFFFF_FFFF_FFFF_FFFF
    return np.random.Generator(np.random.Philox(key=np.array([seed & word, number & word], np.uint64)))


class Lidar:
    """``sensor.lidar.ray_cast``."""

    def __init__(self, description: ActorDescription) -> None:
        self._fan, self._losses = read_fan(description), read_losses(description)
        self._angle_deg = 0.0

    def skip(self, interval_s: float) -> None:
        """Turn on unheard."""
        self._angle_deg = turned_on(self._fan, self._angle_deg, interval_s)

    def measure(self, look: Look) -> Sweep:
        """Return the points of the time since the last measurement."""
        fan, losses, dice = self._fan, self._losses, draws(self._losses.seed, look.number)
        fired = fire(fan, self._angle_deg, look.interval_s)
        self.skip(look.interval_s)
        channel = np.repeat(np.arange(fan.channels, dtype=np.int32), fired.shape[1])
        direction = fired.reshape(-1, 3)
        if losses.general_rate > 0.0:
            heard = dice.random(len(direction), np.float32) >= losses.general_rate
            channel, direction = channel[heard], direction[heard]
        hits = look.seen.caster.closest(aimed(look, direction), fan.range_m, coherent=True, outer=True)
        back = np.isfinite(hits.distance_m)
        distance, direction, channel = hits.distance_m[back], direction[back], channel[back]
        intensity = np.exp(np.float32(-losses.attenuation_per_m) * distance)
        kept = heard_again(losses, intensity, dice)
        if losses.deviation_m > 0.0:
            distance = distance + np.float32(losses.deviation_m) * dice.standard_normal(len(distance), np.float32)
        points = np.empty((int(np.count_nonzero(kept)), 4), np.float32)
        points[:, :3] = direction[kept] * distance[kept, None]
        points[:, 3] = intensity[kept]
        return Sweep(math.radians(self._angle_deg), counts(channel[kept], fan.channels), points)


def heard_again(losses: Losses, intensity: F32, dice: np.random.Generator) -> NDArray[np.bool_]:
    """Return which (N,) points are not lost for want of light; below the limit, ever more are."""
    if losses.intensity_limit <= 0.0 or losses.zero_intensity <= 0.0:
        return np.ones(len(intensity), np.bool_)
    share = losses.zero_intensity / losses.intensity_limit * intensity + (1.0 - losses.zero_intensity)
    heard: NDArray[np.bool_] = (intensity > losses.intensity_limit) | (dice.random(len(intensity), np.float32) < share)
    return heard


def counts(channel: I32, channels: int) -> U32:
    """Return how many points each channel has."""
    return np.bincount(channel, minlength=channels).astype(np.uint32)


def aimed(look: Look, direction: F32) -> Rays:
    """Return rays in the world from directions (N, 3) in the sensor's frame."""
    turn = rotation_matrix(look.pose.rotation).astype(np.float32)
    origin = np.broadcast_to(np.array(look.pose.location, np.float32), direction.shape)
    return Rays(origin, direction @ turn.T)


class SemanticLidar:
    """``sensor.lidar.ray_cast_semantic``: nothing lost, and of each point whose it is."""

    def __init__(self, description: ActorDescription) -> None:
        self._fan = read_fan(description)
        self._angle_deg = 0.0

    def skip(self, interval_s: float) -> None:
        """Turn on unheard."""
        self._angle_deg = turned_on(self._fan, self._angle_deg, interval_s)

    def measure(self, look: Look) -> SemanticSweep:
        """Return the points of the time since the last measurement."""
        fired = fire(self._fan, self._angle_deg, look.interval_s)
        self.skip(look.interval_s)
        direction, seen = fired.reshape(-1, 3), look.seen
        rays = aimed(look, direction)
        hits = seen.caster.closest(rays, self._fan.range_m, coherent=True, outer=True)
        back = np.flatnonzero(np.isfinite(hits.distance_m))
        place, faces = hits.instance[back] + 1, seen.faces
        face = first_of_places(faces, seen.instances)[place] + hits.triangle[back]
        points = np.empty(len(back), SEMANTIC_POINT)
        points["xyz"] = direction[back] * hits.distance_m[back, None]
        points["cos_incidence"] = np.abs(np.einsum("ij,ij->i", rays.direction[back], hits.normal[back]))
        points["tag"] = faces.tag[face]
        thing = faces.object[face]
        of_thing = np.append(seen.object_id, np.uint32(0))[thing]  # NO_OBJECT takes the last
        of_thing[of_thing >= _NO_ACTOR_FROM] = 0
        points["object_id"] = np.where(place > 0, id_of_places(seen.instances)[place], of_thing)
        channel = (back // max(1, fired.shape[1])).astype(np.int32)
        return SemanticSweep(math.radians(self._angle_deg), counts(channel, self._fan.channels), points)
