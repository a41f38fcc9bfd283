"""Compile what sensors that look around need, at a moment of one's own choosing: not when a client waits for a picture.

Each step measures once in a world of two triangles; a kernel that is in the cache is only read.
"""

from collections.abc import Callable

import numpy as np

from linden.casting.choose import caster_of
from linden.casting.rays import Instances, Rays
from linden.meshes.mesh import Material, Mesh, faces
from linden.scene.weather import CLEAR_NOON
from linden.sensors.lidar.fan import Fan, aim, fire
from linden.sensors.lidar.sensor import whose
from linden.sensors.lidar.sweep import Chances, Losses, points_of, semantic_points_of
from linden.sensors.seen import Seen, table_of
from linden.values.enums import SemanticTag
from linden.values.space import Transform

_FAN = Fan(2, 0.0, -90.0, 360.0, 10.0, 80, 10.0)
_LOSSES = Losses(0.004, 0.45, 0.8, 0.4, 0.0, 0)


def two_triangles() -> Seen:
    """Return a moment in a world of a triangle that stands and one that moves."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], np.float32)
    mesh = Mesh(corners, np.array([[0, 1, 2]], np.uint32), faces(1, Material.PLAIN, SemanticTag.ROADS, (90, 90, 90)))
    caster, pose = caster_of(mesh, [mesh]), np.eye(3, 4, dtype=np.float32)[None]
    none = np.zeros((1, 3), np.float32)
    one = np.ones(1, np.uint32)
    instances = Instances(np.zeros(1, np.int32), pose, pose, one, np.zeros((1, 3), np.uint8), one, none, none)
    caster.pose(instances)
    no_objects = np.zeros(0, np.uint32), np.zeros(0, np.uint32), np.zeros((0, 3), np.uint8)
    return Seen(caster, mesh, [mesh], table_of(mesh, [mesh]), instances, *no_objects, CLEAR_NOON, 0.0)


def warm_rays() -> None:
    """Compile, or load from the cache, the caster and what lidars, radars and obstacle detectors do with it."""
    seen = two_triangles()
    fired = fire(_FAN, 0.0, 0.1)
    number = np.arange(fired.rays, dtype=np.int32)
    rays = aim(fired, number, Transform())
    hits = seen.caster.closest(rays, _FAN.range_m, coherent=True, outer=True)
    zero = np.zeros(fired.rays, np.float32)
    points_of(fired, number, hits, _LOSSES, Chances(zero, zero))
    semantic_points_of(fired, rays.direction, hits, whose(seen))
    seen.caster.blocked(Rays(*rays), _FAN.range_m)


STEPS: tuple[Callable[[], None], ...] = (warm_rays,)
"""What can be compiled side by side."""


def warm_up() -> None:
    """Take all steps, one after the other."""
    for step in STEPS:
        step()
