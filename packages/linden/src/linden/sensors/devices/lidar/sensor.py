"""The two lidars of CARLA.

Source of meaning: CARLA 0.9.16, RayCastSemanticLidar.cpp and RayCastLidar.cpp. One of their faults is left out: with a
``sensor_tick`` they fire the points of a frame where those of the whole time since the last measurement are due.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Transform
from linden.sensors.casting.caster import Caster
from linden.sensors.devices.lidar.firing_pattern import F32, I32, Fan, Fired, aim, fire, read_fan, turned_on
from linden.sensors.devices.lidar.sweep import (
    Chances,
    Losses,
    Owners,
    SemanticSweep,
    Sweep,
    points_of,
    semantic_points_of,
)
from linden.sensors.devices.noise import dice_of
from linden.sensors.view import Seen, SensorLook, actor_of_objects, first_of_places, id_of_places


class Lidar:
    """``sensor.lidar.ray_cast``."""

    def __init__(self, description: ActorDescription) -> None:
        self._fan, self._losses = read_fan(description), read_losses(description)
        self._angle_deg = 0.0

    def skip(self, interval_s: float) -> None:
        """Advance the rotation by ``interval_s`` without a measurement."""
        self._angle_deg = turned_on(self._fan, self._angle_deg, interval_s)

    def measure(self, look: SensorLook) -> Sweep:
        """Return the points of the time since the last measurement."""
        fired = fire(self._fan, self._angle_deg, look.interval_s)
        self.skip(look.interval_s)
        count, points, _ = scan(self._fan, self._losses, fired, look.number, look.pose, look.seen.caster)
        return Sweep(math.radians(self._angle_deg), count, points)


def scan(
    fan: Fan, losses: Losses, fired: Fired, number: int, pose: Transform, caster: Caster
) -> tuple[NDArray[np.uint32], F32, I32]:
    """Cast the rays of a sweep, the sensor's measurement ``number``.

    Returns how many points each channel has, the points (M, 4), and the ray (M,) of each.
    """
    rays, chances = draw(losses, fired.rays, number)
    hits = caster.closest(aim(fired, rays, pose), fan.range_m, coherent=True, outer=True)
    return points_of(fired, rays, hits.distance_m, losses, chances)


def draw(losses: Losses, count: int, number: int) -> tuple[I32, Chances]:
    """Return which of ``count`` rays (N,) measurement ``number`` fires, and what chance does to each of them."""
    dice = dice_of(losses.seed, number)
    rays: I32 = np.arange(count, dtype=np.int32)
    if losses.general_rate > 0.0:
        rays = rays[dice.random(len(rays), np.float32) >= losses.general_rate]
    error_m: F32 = np.zeros(len(rays), np.float32)
    if losses.deviation_m > 0.0:
        error_m = np.float32(losses.deviation_m) * dice.standard_normal(len(rays), np.float32)
    return rays, Chances(dice.random(len(rays), np.float32), error_m)


def read_losses(description: ActorDescription) -> Losses:
    """Read a complete description."""
    return Losses(
        attenuation_per_m=description.number("atmosphere_attenuation_rate"),
        general_rate=description.number("dropoff_general_rate"),
        intensity_limit=description.number("dropoff_intensity_limit"),
        zero_intensity=description.number("dropoff_zero_intensity"),
        deviation_m=description.number("noise_stddev"),
        seed=int(description.attribute("noise_seed")),
    )


class SemanticLidar:
    """``sensor.lidar.ray_cast_semantic``: no losses; each point has the actor and the tag of its face."""

    def __init__(self, description: ActorDescription) -> None:
        self._fan = read_fan(description)
        self._angle_deg = 0.0

    def skip(self, interval_s: float) -> None:
        """Advance the rotation by ``interval_s`` without a measurement."""
        self._angle_deg = turned_on(self._fan, self._angle_deg, interval_s)

    def measure(self, look: SensorLook) -> SemanticSweep:
        """Return the points of the time since the last measurement."""
        fired = fire(self._fan, self._angle_deg, look.interval_s)
        self.skip(look.interval_s)
        rays = aim(fired, np.arange(fired.rays, dtype=np.int32), look.pose)
        hits = look.seen.caster.closest(rays, self._fan.range_m, coherent=True, outer=True)
        found = semantic_points_of(fired, rays.direction, hits, owners_of(look.seen))
        return SemanticSweep(math.radians(self._angle_deg), *found)


def owners_of(seen: Seen) -> Owners:
    """Return the owner of each face; scenery has the id 0, as in CARLA."""
    faces = seen.faces
    first, actor = first_of_places(faces, seen.instances), id_of_places(seen.instances)
    return Owners(first, actor, faces.tag, faces.object, actor_of_objects(seen))
