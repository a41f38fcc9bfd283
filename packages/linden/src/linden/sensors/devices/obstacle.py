"""The obstacle detector: a ball sent straight ahead, and the first thing that it touches.

Source of meaning: CARLA 0.9.16, ObstacleDetectionSensor.cpp. The ball is a bundle of rays side by side, each of which
counts from the ball's surface on; they are so close that the distance is right to a few centimetres at an edge, and to
millimetres on a wall. What carries the sensor is looked through.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.geometry import rotation_matrix
from linden.protocol.values.actors import ActorDescription
from linden.sensors.casting.caster import NOTHING, STATIC, Hits, Rays
from linden.sensors.view import F64, Seen, SensorLook, actor_of_objects

F32 = NDArray[np.float32]

RINGS = 16
"""Of rays about the middle one."""
_ON_M = 1e-3
"""How far behind what is looked through a ray goes on."""


class ObstacleSpec(NamedTuple):
    """m; ``only_dynamics`` where what stands is looked through."""

    distance_m: float
    radius_m: float
    only_dynamics: bool


class Obstacle(NamedTuple):
    """What is in the way: an actor, or scenery (``actor_id`` 0) with its tag; and how far the ball gets, m."""

    actor_id: int
    tag: int
    distance_m: float


def read_spec(description: ActorDescription) -> ObstacleSpec:
    """Read a complete description."""
    return ObstacleSpec(
        distance_m=max(0.0, description.number("distance")),
        radius_m=max(0.0, description.number("hit_radius")),
        only_dynamics=description.flag("only_dynamics"),
    )


class ObstacleDetector:
    """``sensor.other.obstacle``."""

    def __init__(self, description: ActorDescription) -> None:
        self._spec = read_spec(description)

    def skip(self, interval_s: float) -> None:
        """Do nothing: no measurement depends on another."""

    def measure(self, look: SensorLook) -> Obstacle | None:
        """Return the nearest obstacle, None where the way is free."""
        spec = self._spec
        across, ahead_m = bundle(spec.radius_m)
        turn = rotation_matrix(look.pose.rotation)
        origin = np.asarray(look.pose.location) + across @ turn[:, 1:].T
        direction = np.broadcast_to(turn[:, 0], origin.shape)
        ignored = np.append(look.seen.instances.actor_id == look.carrier_id, spec.only_dynamics)
        touched = _first(look.seen, _rays(np.broadcast_to(origin[0], SPOKES.shape), SPOKES), spec.radius_m, ignored)
        nearest = int(np.argmin(touched.distance_m))
        if touched.instance[nearest] != NOTHING:  # before it goes anywhere
            return Obstacle(*_identity(look.seen, touched, nearest), 0.0)
        hits = _first(look.seen, _rays(origin, direction), spec.distance_m + spec.radius_m, ignored)
        way_m = np.where(hits.instance == NOTHING, np.inf, np.maximum(0.0, hits.distance_m - ahead_m))
        nearest = int(np.argmin(way_m))
        if way_m[nearest] > spec.distance_m:
            return None
        return Obstacle(*_identity(look.seen, hits, nearest), float(way_m[nearest]))


@lru_cache(maxsize=16)
def bundle(radius_m: float) -> tuple[F64, F64]:
    """Return where rays (N, 2) lie beside the middle (to the right, upwards), and how far ahead the ball is there."""
    rings: list[F64] = [np.zeros((1, 2))]
    for ring in range(1, RINGS + 1):
        angle = math.tau * np.arange(6 * ring) / (6 * ring)
        rings.append(np.column_stack([np.cos(angle), np.sin(angle)]) * radius_m * ring / RINGS)
    across = np.concatenate(rings)
    return across, np.sqrt(np.maximum(0.0, radius_m**2 - (across**2).sum(1)))


def _spread(count: int) -> F64:
    """Return unit vectors (count, 3) all over a sphere: Saff and Kuijlaars 1997, "Distributing Many Points"."""
    height = np.linspace(-1.0, 1.0, count)
    angle = np.arange(count) * math.pi * (3.0 - math.sqrt(5.0))
    level = np.sqrt(1.0 - height**2)
    return np.column_stack([level * np.cos(angle), level * np.sin(angle), height])


SPOKES = _spread(400)
"""From the middle of the ball outwards, straight up and down among them."""


def _rays(origin: F64, direction: F64) -> Rays:
    return Rays(origin.astype(np.float32), direction.astype(np.float32))


def _first(seen: Seen, rays: Rays, reach_m: float, ignored: NDArray[np.bool_]) -> Hits:
    """Return what the rays meet first that is not ``ignored`` (K + 1,): the last says whether what stands is."""
    hits = seen.caster.closest(rays, reach_m)
    passed_m = np.zeros(len(rays.origin_m), np.float32)
    while len(rows := np.flatnonzero((hits.instance != NOTHING) & ignored[np.maximum(hits.instance, STATIC)])):
        passed_m[rows] = hits.distance_m[rows] + np.float32(_ON_M)
        origin, direction = rays.origin_m[rows], rays.direction[rows]
        beyond = seen.caster.closest(Rays(origin + direction * passed_m[rows, None], direction), reach_m)
        for column, found in zip(hits, beyond, strict=True):
            column[rows] = found
        hits.distance_m[rows] += passed_m[rows]
    hits.instance[hits.distance_m > reach_m] = NOTHING
    return hits


def _identity(seen: Seen, hits: Hits, ray: int) -> tuple[int, int]:
    """Return the id of the actor that a ray met, 0 where it is none, and the tag of the face."""
    instance = int(hits.instance[ray])
    first = seen.faces.first[0] if instance == STATIC else seen.faces.first[1 + seen.instances.mesh[instance]]
    face = int(first) + int(hits.triangle[ray])
    tag, thing = int(seen.faces.tag[face]), int(seen.faces.object[face])
    if instance != STATIC:
        return int(seen.instances.actor_id[instance]), tag
    return int(actor_of_objects(seen)[thing]), tag
