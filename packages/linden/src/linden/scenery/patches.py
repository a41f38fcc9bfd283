"""Flat patches of which everything that stands is put together, many at once: quads, boxes, prisms, fans.

All arrays run over N like things; corners are (N, ..., 3) in m. The caller gives the direction of a
patch's front where it matters. Patches are turned round to face it, so the order of corners does not matter.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import FACE, NO_OBJECT, LampOf, Material, Mesh
from linden.structured import StructuredArray

F64 = NDArray[np.float64]


class PatchLook(NamedTuple):
    """What a patch is; colour and object may be given for each of N patches."""

    material: Material
    tag: SemanticTag | int
    colour: ArrayLike  # (3,) or (N, 3), sRGB
    object: ArrayLike = NO_OBJECT  # or (N,)
    lamp: LampOf = LampOf.NONE

    def of(self, rows: NDArray[np.intp]) -> "PatchLook":
        """Return the look of those of the patches."""
        colour, number = np.asarray(self.colour), np.asarray(self.object)
        return self._replace(
            colour=colour[rows] if colour.ndim == 2 else colour, object=number[rows] if number.ndim else number
        )


def polygons(corners_m: F64, look: PatchLook, towards: ArrayLike | None = None) -> Mesh:
    """Return convex polygons (N, K, 3) as fans, looking ``towards`` (3,) or (N, 3) if that is given."""
    count, sides = corners_m.shape[:2]
    if towards is not None:
        corners_m = _turned_round(corners_m, np.broadcast_to(np.asarray(towards, np.float64), (count, 3)))
    fan = np.array([(0, k, k + 1) for k in range(1, sides - 1)])
    triangles = (np.arange(count)[:, None, None] * sides + fan[None]).reshape(-1, 3)
    return Mesh(
        corners_m.reshape(-1, 3).astype(np.float32), triangles.astype(np.uint32), _faces(count, sides - 2, look)
    )


def _turned_round(corners_m: F64, towards: F64) -> F64:
    """Return polygons that all look to ``towards``: the others are wound the other way."""
    normal = np.zeros((len(corners_m), 3))
    for k in range(1, corners_m.shape[1] - 1):
        normal += np.cross(corners_m[:, k] - corners_m[:, 0], corners_m[:, k + 1] - corners_m[:, 0])
    away = np.einsum("ij,ij->i", normal, towards) < 0.0
    turned = corners_m.copy()
    turned[away] = corners_m[away, ::-1]
    return turned


def _faces(count: int, each: int, look: PatchLook) -> StructuredArray:
    """Return ``each`` faces for each of ``count`` patches."""
    made = np.zeros((count, each), FACE)
    made["material"], made["tag"], made["lamp"] = look.material, look.tag, look.lamp
    made["colour"] = np.broadcast_to(np.asarray(look.colour, np.uint8), (count, 3))[:, None, :]
    made["object"] = np.broadcast_to(np.asarray(look.object, np.int32), (count,))[:, None]
    return made.reshape(-1)


class PatchFrames(NamedTuple):
    """Where N things stand: the frame in which their parts are given, x ahead, y to the right, z up."""

    base_m: F64  # (N, 3), world
    yaw_rad: F64  # (N,)

    def __len__(self) -> int:
        """Return the number of patches."""
        return len(self.base_m)

    def world(self, points_m: ArrayLike) -> F64:
        """Return points of the things' own frames in the world: (K, 3), the same for all, or (N, K, 3) of each."""
        points = np.asarray(points_m, np.float64)
        if points.ndim < 3:
            points = np.broadcast_to(points, (len(self.base_m), *points.shape))
        return self.turned(points) + self.base_m.reshape(-1, *([1] * (points.ndim - 2)), 3)

    def turned(self, vectors: F64) -> F64:
        """Return vectors (N, ..., 3) of the things' own frames as the world has them."""
        shape = (-1, *([1] * (vectors.ndim - 2)))
        cosine, sine = np.cos(self.yaw_rad).reshape(shape), np.sin(self.yaw_rad).reshape(shape)
        x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
        return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=-1)

    def of(self, rows: NDArray[np.intp]) -> "PatchFrames":
        """Return the frames of those of the things."""
        return PatchFrames(self.base_m[rows], self.yaw_rad[rows])


_CORNERS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], np.float64)
_SIDES = {
    "bottom": (0, 3, 2, 1),
    "top": (4, 5, 6, 7),
    "left": (0, 1, 5, 4),
    "ahead": (1, 2, 6, 5),
    "right": (2, 3, 7, 6),
    "behind": (3, 0, 4, 7),
}
WALLS = ("left", "ahead", "right", "behind")
ABOVE_GROUND = ("top", *WALLS)
ALL_SIDES = tuple(_SIDES)


def boxes(
    frames: PatchFrames, centre_m: ArrayLike, half_m: ArrayLike, look: PatchLook, sides: tuple[str, ...] = ABOVE_GROUND
) -> Mesh:
    """Return boxes; ``centre_m`` and ``half_m`` are (3,) or (N, 3) in the things' own frames."""
    centre = np.broadcast_to(np.asarray(centre_m, np.float64), (len(frames), 3))
    half = np.broadcast_to(np.asarray(half_m, np.float64), (len(frames), 3))
    corners = frames.world(centre[:, None] + half[:, None] * _CORNERS)  # (N, 8, 3)
    numbers = np.array([_SIDES[side] for side in sides])
    fans = numbers[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    triangles = (np.arange(len(frames))[:, None, None] * 8 + fans[None]).reshape(-1, 3)
    return Mesh(
        corners.reshape(-1, 3).astype(np.float32), triangles.astype(np.uint32), _faces(len(frames), len(fans), look)
    )


def prisms(
    begin_m: F64, end_m: F64, radii_m: tuple[ArrayLike, ArrayLike], sides: int, look: PatchLook, *, lid: bool = True
) -> Mesh:
    """Return tubes with ``sides`` flat sides from ``begin_m`` to ``end_m`` (N, 3), closed there if they have a lid.

    ``radii_m`` at both ends are numbers or (N,).
    """
    count = len(begin_m)
    along = end_m - begin_m
    along = along / np.maximum(np.linalg.norm(along, axis=1), 1e-9)[:, None]
    other = np.where(np.abs(along[:, 2:]) > 0.7, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
    u = np.cross(other, along)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(along, u)
    angles = np.arange(sides) * (2.0 * np.pi / sides)
    ring = np.cos(angles)[None, :, None] * u[:, None] + np.sin(angles)[None, :, None] * v[:, None]
    first, second = (np.broadcast_to(np.asarray(radius, np.float64), (count,)) for radius in radii_m)
    corners = np.concatenate(
        [begin_m[:, None] + ring * first[:, None, None], end_m[:, None] + ring * second[:, None, None]], axis=1
    )
    around = np.arange(sides)
    after = (around + 1) % sides
    walls = np.concatenate(
        [np.stack([around, after, after + sides], 1), np.stack([around, after + sides, around + sides], 1)]
    )
    top = np.array([(sides, sides + k, sides + k + 1) for k in range(1, sides - 1)])
    pattern = np.concatenate([walls, top]) if lid else walls
    triangles = (np.arange(count)[:, None, None] * 2 * sides + pattern[None]).reshape(-1, 3)
    return Mesh(
        corners.reshape(-1, 3).astype(np.float32), triangles.astype(np.uint32), _faces(count, len(pattern), look)
    )


def strips(
    first_m: F64, second_m: F64, continues: NDArray[np.bool_], look: PatchLook, towards: F64 | None = None
) -> Mesh:
    """Return quads between two lines of places (P, 3); row k has one to row k + 1 where ``continues``.

    ``towards`` (P, 3) says where each looks.
    """
    rows = np.flatnonzero(continues)
    corners = np.stack([first_m[rows], first_m[rows + 1], second_m[rows + 1], second_m[rows]], axis=1)
    return polygons(corners, look.of(rows), None if towards is None else towards[rows])
