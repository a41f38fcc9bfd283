"""Compile what sensors that look around need, at a moment of one's own choosing: not when a client waits for a picture.

Each step measures once in a world of two triangles; a kernel that is in the cache is only read.
"""

from collections.abc import Callable

import numpy as np

from linden.blueprints.library import BlueprintLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType, SemanticTag
from linden.protocol.values.episode import CLEAR_NOON
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import Material, Mesh, faces
from linden.sensors.camera.cameras import CAMERAS
from linden.sensors.casting.caster import Instances, Rays
from linden.sensors.casting.choose import caster_of
from linden.sensors.devices.lidar.firing_pattern import Fan, aim, fire
from linden.sensors.devices.lidar.sensor import owners_of
from linden.sensors.devices.lidar.sweep import Chances, Losses, points_of, semantic_points_of
from linden.sensors.view import Seen, SensorLook, table_of

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
    points_of(fired, number, hits.distance_m, _LOSSES, Chances(zero, zero))
    semantic_points_of(fired, rays.direction, hits, owners_of(seen))
    seen.caster.blocked(Rays(*rays), _FAN.range_m)


def warm_cameras() -> None:
    """Compile, or load from the cache, all that cameras need: each takes two pictures, downwards and small.

    Takes about half a minute of one processor where nothing is cached.
    """
    seen, library = two_triangles(), BlueprintLibrary.load()
    seen = seen._replace(weather=CLEAR_NOON._replace(precipitation=50.0))
    pose = Transform(Vector3D(0.0, 0.0, 2.0), Rotation(-60.0, 0.0, 0.0))
    size = tuple(AttributeValue(f"image_size_{axis}", AttributeType.INT, "16") for axis in "xy")
    for blueprint, make in CAMERAS.items():
        camera = make(library.validate(ActorDescription(0, blueprint, size)))
        for number in range(2):
            camera.measure(SensorLook(seen, {}, pose, pose, np.zeros(3), 0, number, 0.05))


STEPS: tuple[Callable[[], None], ...] = (warm_rays, warm_cameras)
"""What can be compiled side by side."""


def warm_up() -> None:
    """Take all steps, one after the other."""
    for step in STEPS:
        step()
