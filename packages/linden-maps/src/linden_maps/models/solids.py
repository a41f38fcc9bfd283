"""Closed solids as meshes, their common colours, and the frame that a part of an actor follows.

Solids are lofts, boxes, tubes and balls. Every solid is closed and its triangles point outwards, so that compounds of
them show their outside only.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.scenery.mesh import FACE, NO_OBJECT, LampOf, Material, Mesh
from linden.structured import StructuredArray

F64 = NDArray[np.float64]
Point = Sequence[float]

_NO_AREA_M2 = 1e-9
"""Triangles smaller than this have no direction: two of their corners coincide."""


class FaceLook(NamedTuple):
    """How a face meets light; ``colour`` is sRGB and, where ``painted``, stands in for the actor's own."""

    material: Material
    colour: tuple[int, int, int]
    lamp: LampOf = LampOf.NONE
    painted: bool = False


def faces_of(look: FaceLook, *shape: int) -> StructuredArray:
    """Return an array of faces that look so; the tag is given to the whole body at the end (:func:`tagged`)."""
    return np.full(shape, _face(look), FACE)


@lru_cache(maxsize=1024)
def _face(look: FaceLook) -> np.void:
    made = np.zeros(1, FACE)
    made["material"], made["colour"], made["lamp"], made["painted"], made["object"] = *look, NO_OBJECT
    face: np.void = made[0]
    return face


def tagged(mesh: Mesh, tag: int) -> Mesh:
    """Return the mesh with one semantic tag on all faces."""
    faces = mesh.faces.copy()
    faces["tag"] = tag
    return mesh._replace(faces=faces)


def _normals(vertices_m: F64, triangles: NDArray[np.integer]) -> tuple[F64, F64]:
    """Return the first corner and the normal (T, 3) of triangles, twice their area long."""
    a = vertices_m[triangles[:, 0]]
    (ux, uy, uz), (vx, vy, vz) = (vertices_m[triangles[:, 1]] - a).T, (vertices_m[triangles[:, 2]] - a).T
    return a, np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], 1)


def bounds(mesh: Mesh) -> tuple[F64, F64]:
    """Return the least and the greatest of each coordinate, m."""
    return mesh.vertices_m.min(0).astype(np.float64), mesh.vertices_m.max(0).astype(np.float64)


def closed(vertices_m: F64, triangles: NDArray[np.intp], faces: StructuredArray) -> Mesh:
    """Return a solid of triangles that all turn the same way round: outwards, without triangles of no area."""
    corner, normal = _normals(vertices_m, triangles)
    has_area = (normal * normal).sum(1) > (2.0 * _NO_AREA_M2) ** 2
    kept = triangles[has_area] if (corner * normal).sum() >= 0.0 else triangles[has_area, ::-1]
    return Mesh(vertices_m.astype(np.float32), kept.astype(np.uint32), faces[has_area])


def inside_out(mesh: Mesh) -> Mesh:
    """Return the mesh with every triangle turned round."""
    return mesh._replace(triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]))


def loft(
    rings_m: F64, look: FaceLook | StructuredArray, first: FaceLook | StructuredArray, last: FaceLook | StructuredArray
) -> Mesh:
    """Return the solid between rings (S, P, 3), each joined to the next; its ends are closed by strips.

    ``look`` may be an array (S - 1, P): the side between points p and p + 1 of rings s and s + 1. A strip of an end
    lies between points k, k + 1 and their partners counted from the ring's other end; arrays (P // 2,) tell them apart.
    """
    count, points, _ = rings_m.shape
    triangles = _lofted(count, points)
    sides, end = 2 * (count - 1) * points, len(_strips(points))
    faces = np.empty(len(triangles), FACE)
    for start, stop, looks in (
        (0, sides, look), (sides, sides + end, first), (sides + end, sides + 2 * end, last),
    ):  # fmt: skip
        faces[start:stop] = _face(looks) if isinstance(looks, FaceLook) else np.repeat(looks.reshape(-1), 2)
    return closed(rings_m.reshape(-1, 3), triangles, faces)


@lru_cache(maxsize=256)
def _lofted(count: int, points: int) -> NDArray[np.intp]:
    """Return the triangles (T, 3) of a loft: its sides, then its first end, then its last."""
    ring, point = np.divmod(np.arange((count - 1) * points), points)
    low, high = ring * points + point, ring * points + (point + 1) % points
    sides = np.stack([low, high, high + points, low, high + points, low + points], 1).reshape(-1, 3)
    end = _strips(points)
    return np.concatenate([sides, end[:, ::-1], end + (count - 1) * points])


@lru_cache(maxsize=64)
def _strips(points: int) -> NDArray[np.intp]:
    """Return triangles (points - 1 or more, 3) that close a ring by strips, two for each; those too many are empty."""
    strips = []
    for k in range(points // 2):
        below, partner = k + 1, points - 1 - k
        strips += [(k, below, partner), (below, max(partner - 1, below), partner)]
    return np.array(strips, np.intp)


def box(low_m: Point, high_m: Point, look: FaceLook) -> Mesh:
    """Return an upright box between two corners."""
    (x0, y0, z0), (x1, y1, z1) = low_m, high_m
    ring = [(y0, z0), (y1, z0), (y1, z1), (y0, z1)]
    return loft(np.array([[(x, y, z) for y, z in ring] for x in (x0, x1)]), look, look, look)


def wedge(low_m: Point, high_m: Point, look: FaceLook, *, top_x: tuple[float, float]) -> Mesh:
    """Return a box with an upper side from ``top_x[0]`` to ``top_x[1]``: a ramp, a leaning board."""
    (x0, y0, z0), (x1, y1, z1) = low_m, high_m
    rings = [[(x0, y, z0), (x1, y, z0), (top_x[1], y, z1), (top_x[0], y, z1)] for y in (y0, y1)]
    return loft(np.array(rings), look, look, look)


def tube(path_m: Sequence[Point], radii_m: Sequence[float], sides: int, look: FaceLook) -> Mesh:
    """Return a round rod along a path, a radius at each of its points; its ends are closed."""
    path = np.asarray(path_m, np.float64)
    along = np.gradient(path, axis=0) if len(path) > 1 else path
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    rings = []
    start = _across(along[0])
    for point, ahead, radius_m in zip(path, along, radii_m, strict=True):
        start = start - ahead * (start @ ahead)
        start /= math.sqrt(start @ start)
        rings.append(point + radius_m * _circle(start, _cross(ahead, start), sides))
    return loft(np.array(rings), look, look, look)


def rod(start_m: Point, end_m: Point, radius_m: float, look: FaceLook, *, sides: int = 6) -> Mesh:
    """Return a straight rod of one thickness."""
    return tube([start_m, end_m], [radius_m, radius_m], sides, look)


def lathe(
    heights_m: Sequence[float], radii_m: Sequence[float], sides: int, look: FaceLook | Sequence[FaceLook]
) -> Mesh:
    """Return what turns about the z axis: a radius at each height; ``look`` may differ from band to band."""
    rings = np.array([ring_of(radius_m, z, sides) for z, radius_m in zip(heights_m, radii_m, strict=True)])
    if isinstance(look, FaceLook):
        return loft(rings, look, look, look)
    return loft(rings, np.stack([faces_of(band, sides) for band in look]), look[0], look[-1])


def ring_of(radius_m: float, height_m: float, sides: int) -> F64:
    """Return a circle (sides, 3) about the z axis."""
    circle: F64 = radius_m * _circle(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), sides)
    circle[:, 2] = height_m
    return circle


def ball(centre_m: Point, radii_m: Point, look: FaceLook, *, sides: int = 8, bands: int = 6) -> Mesh:
    """Return an ellipsoid."""
    angles = np.linspace(-0.5 * math.pi, 0.5 * math.pi, bands + 1)
    made = lathe(np.sin(angles).tolist(), np.cos(angles).tolist(), sides, look)
    return stretched(made, radii_m, centre_m)


def prism(outline_m: Sequence[tuple[float, float]], low_m: float, high_m: float, look: FaceLook, *, along: int) -> Mesh:
    """Return an outline pulled along an axis (0, 1, 2) from ``low_m`` to ``high_m``; in the other two it lies.

    The outline must be such that strips between its points and their partners from its other end fill it.
    """
    flat = np.asarray(outline_m, np.float64)
    rings = np.empty((2, len(flat), 3))
    rings[:, :, [axis for axis in range(3) if axis != along]] = flat
    rings[0, :, along], rings[1, :, along] = low_m, high_m
    return loft(rings, look, look, look)


def _across(direction: F64) -> F64:
    """Return a unit vector square to a direction, level where it can be."""
    side = _cross(direction, np.array((0.0, 0.0, 1.0) if abs(direction[2]) < 0.9 else (1.0, 0.0, 0.0)))
    unit: F64 = side / math.sqrt(side @ side)
    return unit


def _cross(a: F64, b: F64) -> F64:
    """Return the cross product of two vectors; numpy's takes its time over single ones."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def _circle(first: F64, second: F64, sides: int) -> F64:
    cosine, sine = _round(sides)
    circle: F64 = cosine * first + sine * second
    return circle


@lru_cache(maxsize=64)
def _round(sides: int) -> tuple[F64, F64]:
    angles = (np.arange(sides)[:, None] + 0.5) * (math.tau / sides)
    return np.cos(angles), np.sin(angles)


def moved(mesh: Mesh, by_m: Point) -> Mesh:
    """Return the mesh elsewhere."""
    return mesh._replace(vertices_m=(mesh.vertices_m + np.asarray(by_m)).astype(np.float32))


def stretched(mesh: Mesh, factors: Point, by_m: Point = (0.0, 0.0, 0.0)) -> Mesh:
    """Return the mesh scaled along each axis (a negative factor mirrors it), then moved."""
    vertices = mesh.vertices_m.astype(np.float64) * np.asarray(factors) + np.asarray(by_m)
    made = mesh._replace(vertices_m=vertices.astype(np.float32))
    return made if math.prod(factors) > 0.0 else inside_out(made)


def turned(mesh: Mesh, rotation: F64, about_m: Point = (0.0, 0.0, 0.0)) -> Mesh:
    """Return the mesh turned by a (3, 3) rotation about a point."""
    about = np.asarray(about_m)
    return mesh._replace(vertices_m=((mesh.vertices_m - about) @ rotation.T + about).astype(np.float32))


def both_sides(mesh: Mesh) -> list[Mesh]:
    """Return the mesh and its mirror image on the other side of the xz plane, left where y is negative."""
    return [mesh, stretched(mesh, (1.0, -1.0, 1.0))]


PAINT = FaceLook(Material.CAR_PAINT, (190, 190, 190), painted=True)
GLASS = FaceLook(Material.GLASS, (28, 33, 38))
TRIM = FaceLook(Material.PLAIN, (32, 32, 34))
RUBBER = FaceLook(Material.RUBBER, (24, 24, 25))
RIM = FaceLook(Material.METAL, (165, 168, 172))
CHROME = FaceLook(Material.METAL, (200, 202, 205))
STEEL = FaceLook(Material.METAL, (120, 123, 126))
BLACK = FaceLook(Material.PLAIN, (18, 18, 19))
PLATE = FaceLook(Material.SIGN_FACE, (235, 235, 228))

HEAD = FaceLook(Material.LAMP, (225, 230, 235), LampOf.HEAD)
TAIL = FaceLook(Material.LAMP, (150, 14, 12), LampOf.TAIL)
BRAKE = FaceLook(Material.LAMP, (120, 12, 10), LampOf.BRAKE)
REVERSE = FaceLook(Material.LAMP, (215, 215, 215), LampOf.REVERSE)
BLINKER_LEFT = FaceLook(Material.LAMP, (205, 110, 15), LampOf.BLINKER_LEFT)
BLINKER_RIGHT = FaceLook(Material.LAMP, (205, 110, 15), LampOf.BLINKER_RIGHT)
BEACON_BLUE = FaceLook(Material.LAMP, (30, 60, 190), LampOf.BEACON)
BEACON_RED = FaceLook(Material.LAMP, (190, 25, 20), LampOf.BEACON)


class Shape(NamedTuple):
    """A part of an actor's body; ``frame`` is a row of ``posing.VEHICLE_FRAMES`` or ``posing.WALKER_FRAMES``."""

    mesh: Mesh
    frame: int
    colour: tuple[int, int, int] | None = None  # of faces that are painted; None leaves them the actor's own
