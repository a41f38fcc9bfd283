"""A street to look at: a level road of 200 m, a wall across it, and a car of a plain box that moves."""

import numpy as np

from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.episode import CLEAR_NOON, WeatherParameters
from linden.scenery.mesh import LampOf, Material, Mesh, faces, join
from linden.sensors.casting.caster import Instances
from linden.sensors.casting.choose import caster_of
from linden.sensors.view import Seen, table_of

WALL_M = 40.0
"""Where the wall stands along x."""
WALL = 0
"""Row of the wall among the objects, and"""
WALL_ID = 0x8001
CAR_ID = 77

_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)], np.float32)
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def box(half_m: tuple[float, float, float], middle_m: tuple[float, float, float], kind: np.ndarray) -> Mesh:
    """Return a box whose faces look outwards; ``kind`` is one face, of which it gets twelve."""
    triangles = [corner for a, b, c, d in _SIDES for corner in ((a, b, c), (a, c, d))]
    return Mesh((_CORNERS * half_m + middle_m).astype(np.float32), np.array(triangles, np.uint32), np.repeat(kind, 12))


def street(
    car_m: tuple[float, float, float] = (20.0, 0.0, 0.8),
    before_m: tuple[float, float, float] | None = None,
    weather: WeatherParameters = CLEAR_NOON,
    lights: int = 0,
) -> Seen:
    """Return the street with the middle of its car at a place, where it was a frame before, and the weather."""
    road = faces(2, Material.ASPHALT, SemanticTag.ROADS, (90, 90, 90))
    ground = Mesh(
        np.array([(-100, -50, 0), (100, -50, 0), (100, 50, 0), (-100, 50, 0)], np.float32),
        np.array([(0, 1, 2), (0, 2, 3)], np.uint32),
        road,
    )
    brick = faces(1, Material.BRICK, SemanticTag.BUILDINGS, (150, 60, 50))
    brick["object"] = WALL
    standing = join([ground, box((0.5, 30.0, 4.0), (WALL_M + 0.5, 0.0, 4.0), brick)])
    paint = faces(1, Material.CAR_PAINT, SemanticTag.CAR, (1, 2, 3))
    paint["painted"] = True
    head = faces(1, Material.LAMP, SemanticTag.CAR, (255, 255, 255))
    head["lamp"] = LampOf.HEAD
    lamp = box((0.01, 0.2, 0.1), (2.0, 0.0, 0.0), head)
    lamp = Mesh(lamp.vertices_m, lamp.triangles[2:4], lamp.faces[2:4])  # its front
    car = join([box((2.0, 0.9, 0.7), (0.0, 0.0, 0.0), paint), lamp])
    poses = np.tile(np.eye(3, 4, dtype=np.float32), (2, 1, 1))
    poses[0, :, 3], poses[1, :, 3] = car_m, before_m or car_m
    moved = (poses[0, :, 3] - poses[1, :, 3])[None] / np.float32(0.05)
    instances = Instances(
        np.zeros(1, np.int32), poses[:1], poses[1:], np.array([CAR_ID], np.uint32),
        np.array([[200, 30, 20]], np.uint8), np.array([lights], np.uint32), moved, np.zeros((1, 3), np.float32),
    )  # fmt: skip
    bodies = [car]
    caster = caster_of(standing, bodies)
    caster.pose(instances)
    return Seen(
        caster, standing, bodies, table_of(standing, bodies), instances, np.array([WALL_ID], np.uint32),
        np.zeros(1, np.uint32), np.zeros((1, 3), np.uint8), weather, 1.0,
    )  # fmt: skip
