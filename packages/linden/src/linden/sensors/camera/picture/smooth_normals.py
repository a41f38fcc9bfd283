"""Which faces are round: normals at the corners of faces of a curved surface, made once for all meshes.

Two faces that share a vertex (by its row) and meet at less than a crease's angle are taken for one curved surface.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.scenery.mesh import Material, Mesh

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

FLAT = -1

_CREASE = 0.72  # cosine of 44 degrees
_LEAVES_CREASE = -0.5
_ALIKE = 0.9999

_EVEN = np.zeros(max(Material) + 1, np.bool_)
"""Materials of which nothing round is made, by their number: most of a street's faces need not be looked at."""
_EVEN[[Material.ASPHALT, Material.CONCRETE, Material.PAINT, Material.BRICK, Material.SIDING, Material.SHINGLES]] = True
_EVEN[[Material.GRAVEL, Material.GRASS, Material.WOOD, Material.SIGN_FACE]] = True


class Relief(NamedTuple):
    """Rounded faces of all meshes, in the order of ``Faces``; corners in the frame of their mesh."""

    row: I32  # (F,) row of the other two, FLAT where a face is flat
    corner_m: F32  # (R, 3, 3)
    normal: F32  # (R, 3, 3) of length 1


def relief(meshes: Sequence[Mesh]) -> Relief:
    """Return which faces of the meshes are rounded."""
    return joined([_relief_of(mesh) for mesh in meshes])


def _relief_of(mesh: Mesh) -> Relief:
    """Return which faces of one mesh are rounded."""
    curved = np.flatnonzero(~_EVEN[mesh.faces["material"]])
    triangles = mesh.triangles[curved].astype(np.int64)
    leaves = mesh.faces["material"][curved] == Material.LEAVES
    crease = np.where(leaves, _LEAVES_CREASE, _CREASE).astype(np.float32)
    vertices = np.ascontiguousarray(mesh.vertices_m, np.float32)
    made = _corner_normals(vertices, triangles, crease)
    bent = np.flatnonzero(_differ(made))
    row = np.full(len(mesh.triangles), FLAT, np.int32)
    row[curved[bent]] = np.arange(len(bent))
    return Relief(row, vertices[triangles[bent]], made[bent])


def joined(parts: Sequence[Relief]) -> Relief:
    """Return the rounded faces of some meshes and of others after them."""
    before = np.cumsum([0, *(len(part.normal) for part in parts)])
    rows = [np.where(part.row == FLAT, FLAT, part.row + count) for part, count in zip(parts, before[:-1], strict=True)]
    return Relief(
        np.concatenate(rows).astype(np.int32),
        _in_one([part.corner_m for part in parts]),
        _in_one([part.normal for part in parts]),
    )


def without_first(whole: Relief, faces: int) -> Relief:
    """Return the rounded faces of all meshes but the first, which has so many ``faces``."""
    row = whole.row[faces:]
    rounded = np.count_nonzero(whole.row[:faces] != FLAT)
    return Relief(np.where(row == FLAT, FLAT, row - rounded), whole.corner_m[rounded:], whole.normal[rounded:])


def _in_one(parts: list[F32]) -> F32:
    return np.ascontiguousarray(np.concatenate([np.zeros((0, 3, 3), np.float32), *parts]), np.float32)


def _differ(normals: F32) -> NDArray[np.bool_]:
    """Return which faces (F,) have corners (F, 3, 3) that look in different directions."""
    first, second, third = normals[:, 0], normals[:, 1], normals[:, 2]
    one = np.einsum("ij,ij->i", first, second) < _ALIKE
    other = np.einsum("ij,ij->i", first, third) < _ALIKE
    either: NDArray[np.bool_] = one | other
    return either


@unlocked
def _corner_normals(vertices: F32, triangles: NDArray[np.int64], crease: F32) -> F32:
    count = len(triangles)
    flat = np.empty((count, 3), np.float32)
    counts = np.zeros(len(vertices) + 1, np.int64)
    for i in range(count):
        a, b, c = vertices[triangles[i, 0]], vertices[triangles[i, 1]], vertices[triangles[i, 2]]
        x = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
        y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
        z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        length = math.sqrt(x * x + y * y + z * z) + 1e-20
        flat[i, 0], flat[i, 1], flat[i, 2] = x / length, y / length, z / length
        for k in range(3):
            counts[triangles[i, k] + 1] += 1
    around = np.cumsum(counts)
    filled, faces = around.copy(), np.empty(3 * count, np.int64)
    for i in range(count):
        for k in range(3):
            faces[filled[triangles[i, k]]] = i
            filled[triangles[i, k]] += 1
    normals = np.empty((count, 3, 3), np.float32)
    for i in range(count):
        for k in range(3):
            x, y, z = 0.0, 0.0, 0.0
            for place in range(around[triangles[i, k]], around[triangles[i, k] + 1]):
                other = flat[faces[place]]
                if flat[i, 0] * other[0] + flat[i, 1] * other[1] + flat[i, 2] * other[2] > crease[i]:
                    x, y, z = x + other[0], y + other[1], z + other[2]
            length = math.sqrt(x * x + y * y + z * z)
            if length < 1e-6:  # a face without an area
                x, y, z, length = flat[i, 0], flat[i, 1], flat[i, 2], 1.0
            normals[i, k, 0], normals[i, k, 1], normals[i, k, 2] = x / length, y / length, z / length
    return normals
