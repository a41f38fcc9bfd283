"""The radar: rays at random within a cone, and how far and how fast away what they meet goes.

Source of meaning: CARLA 0.9.16, Radar.cpp. Three of its faults are left out: with a ``sensor_tick`` it reckons as many
points as one frame has, and its own speed as if the last measurement had been a frame ago; and what turns has the
velocity of its middle everywhere.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import rotation_matrix
from linden.protocol.values.actors import ActorDescription
from linden.sensors.casting.caster import Hits, Instances, Rays
from linden.sensors.devices.noise import dice_of
from linden.sensors.view import F64, SensorLook

F32 = NDArray[np.float32]


MOST_RAYS = 1024 * 1024
"""Of one measurement, whatever time it covers: a second of work."""


class RadarSpec(NamedTuple):
    """Degrees, m, points a second."""

    horizontal_deg: float
    vertical_deg: float
    range_m: float
    points_per_s: int
    seed: int


class Detections(NamedTuple):
    """What a radar measured, (N,) each: m/s, positive where it recedes; rad to the right and upwards; m."""

    velocity_mps: F32
    azimuth_rad: F32
    altitude_rad: F32
    depth_m: F32


def read_spec(description: ActorDescription) -> RadarSpec:
    """Read a complete description."""
    return RadarSpec(
        horizontal_deg=description.number("horizontal_fov"),
        vertical_deg=description.number("vertical_fov"),
        range_m=description.number("range"),
        points_per_s=int(description.attribute("points_per_second")),
        seed=int(description.attribute("noise_seed")),
    )


class Radar:
    """``sensor.other.radar``."""

    def __init__(self, description: ActorDescription) -> None:
        self._spec = read_spec(description)

    def skip(self, interval_s: float) -> None:
        """Do nothing: no measurement depends on another."""

    def measure(self, look: SensorLook) -> Detections:
        """Return what the rays of the time since the last measurement met, in their order."""
        spec = self._spec
        ahead = directions(spec, min(MOST_RAYS, int(spec.points_per_s * look.interval_s + 1e-6)), look.number)
        turn = rotation_matrix(look.pose.rotation)
        direction = (ahead @ turn.T).astype(np.float32)
        origin = np.broadcast_to(np.array(look.pose.location, np.float32), direction.shape)
        farthest_m = spec.range_m / float(ahead[:, 0].min(initial=1.0))
        hits = look.seen.caster.closest(Rays(origin, direction), farthest_m, outer=True)
        # CARLA's rays end on a plane across the cone
        met = np.isfinite(hits.distance_m) & (hits.distance_m * ahead[:, 0] <= spec.range_m)
        hits = Hits(hits.distance_m[met], hits.instance[met], hits.triangle[met], hits.normal[met])
        ahead, direction = ahead[met], direction[met]
        point_m = origin[met] + direction * hits.distance_m[:, None]
        apart = velocities(look.seen.instances, hits, point_m) - look.velocity_mps
        return Detections(
            np.einsum("ij,ij->i", apart, direction).astype(np.float32),
            np.arctan2(ahead[:, 1], ahead[:, 0]).astype(np.float32),
            np.arcsin(np.clip(ahead[:, 2], -1.0, 1.0)).astype(np.float32),
            hits.distance_m,
        )


def directions(spec: RadarSpec, count: int, number: int) -> F64:
    """Return unit vectors (count, 3) of measurement ``number`` in the sensor's frame: thickest in the middle."""
    dice = dice_of(spec.seed, number)
    radius, angle = dice.random(count), dice.random(count) * math.tau
    vectors = np.column_stack(
        [
            np.ones(count),
            math.tan(math.radians(0.5 * spec.horizontal_deg)) * radius * np.cos(angle),
            math.tan(math.radians(0.5 * spec.vertical_deg)) * radius * np.sin(angle),
        ]
    )
    unit: F64 = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit


def velocities(instances: Instances, hits: Hits, point_m: F32) -> F64:
    """Return how fast (N, 3) the surfaces move where they were met, m/s in the world; what stands, not at all."""
    velocity = np.zeros(point_m.shape)
    moving = hits.instance >= 0
    row = hits.instance[moving]
    arm_m = point_m[moving] - instances.pose[row, :, 3]
    velocity[moving] = instances.velocity_mps[row] + np.cross(instances.turning_radps[row], arm_m)
    return velocity
