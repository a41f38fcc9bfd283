"""Trees and bushes: a trunk, and a crown of one of a few shapes, turned and stretched for each tree."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from linden.meshes.mesh import Material, Mesh, join
from linden.meshes.patches import Frames, Look, polygons, prisms
from linden.values.enums import SemanticTag

F64 = NDArray[np.float64]

_LEAVES = np.array([(74, 104, 44), (88, 118, 48), (62, 92, 40), (104, 124, 52), (82, 108, 62), (112, 116, 50)])
_NEEDLES = np.array([(44, 74, 48), (52, 82, 56), (38, 66, 50)])
_BARK = np.array([(84, 68, 54), (96, 82, 68), (70, 58, 48)])
_CROWNS = 6
_CONIFERS = 0.14


def trees(frames: Frames, trunk_half_m: F64, trunk_height_m: F64, draw: F64, objects: NDArray[np.int32]) -> Mesh:
    """Return trees; ``draw`` (N, 6) in [0, 1) decides what kind, how tall and how wide each is."""
    conifer = draw[:, 0] < _CONIFERS
    bark = _BARK[(draw[:, 1] * len(_BARK)).astype(int)]
    foot = frames.base_m - (0.0, 0.0, 0.3)
    rows = np.arange(len(frames))
    trunk = prisms(
        foot,
        frames.base_m + np.column_stack([0.3 * (draw[:, 2:4] - 0.5), trunk_height_m + 0.2]),
        (1.2 * trunk_half_m, 0.8 * trunk_half_m),
        6,
        Look(Material.BARK, SemanticTag.VEGETATION, bark, objects),
    )
    parts = [trunk]
    shape = (draw[:, 5] * _CROWNS).astype(int)
    for number in range(_CROWNS):
        chosen = rows[~conifer & (shape == number)]
        parts.append(
            _crowns(
                number, frames.of(chosen), trunk_half_m[chosen], trunk_height_m[chosen], draw[chosen], objects[chosen]
            )
        )
    chosen = rows[conifer]
    parts.append(_cones(frames.of(chosen), draw[chosen], objects[chosen]))
    return join(parts)


def _crowns(number: int, frames: Frames, half_m: F64, height_m: F64, draw: F64, objects: NDArray[np.int32]) -> Mesh:
    """Return crowns of one shape: the thicker the trunk the wider the crown."""
    corners, triangles = _blob(number)
    wide = 9.0 * half_m + 1.1 + 0.8 * draw[:, 3]
    tall = wide * (0.85 + 0.45 * draw[:, 4])
    stretch = np.column_stack([wide, wide * (0.9 + 0.2 * draw[:, 2]), tall])
    points = corners[None] * stretch[:, None]
    points[..., 2] += (height_m - 1.2 + 0.8 * tall)[:, None]
    world = Frames(frames.base_m, frames.yaw_rad + 6.3 * draw[:, 1]).world(points)
    leaves = _LEAVES[(draw[:, 2] * len(_LEAVES)).astype(int)]
    shade = (0.85 + 0.3 * draw[:, 4])[:, None]
    look = Look(Material.LEAVES, SemanticTag.VEGETATION, np.clip(leaves * shade, 0, 255).astype(np.uint8), objects)
    return _from_shape(world, triangles, look)


def _from_shape(world: F64, triangles: NDArray[np.int64], look: Look) -> Mesh:
    """Return one mesh of N copies (N, K, 3) of a shape, corners shared within each."""
    count, each = world.shape[:2]
    flat = polygons(np.zeros((count * len(triangles), 3, 3)), look.of(np.repeat(np.arange(count), len(triangles))))
    numbers = (np.arange(count)[:, None, None] * each + triangles[None]).reshape(-1, 3)
    return Mesh(world.reshape(-1, 3).astype(np.float32), numbers.astype(np.uint32), flat.faces)


def _cones(frames: Frames, draw: F64, objects: NDArray[np.int32]) -> Mesh:
    """Return conifers: three skirts of branches one above the other."""
    height = 6.5 + 6.0 * draw[:, 4]
    look = Look(Material.LEAVES, SemanticTag.VEGETATION, _NEEDLES[(draw[:, 2] * 3).astype(int)], objects)
    parts = []
    for begin, end, width in ((0.12, 0.55, 0.26), (0.36, 0.8, 0.2), (0.62, 1.0, 0.13)):
        up = np.array([0.0, 0.0, 1.0])
        low = frames.base_m + up * (begin * height)[:, None]
        parts.append(prisms(low, frames.base_m + up * (end * height)[:, None], (width * height, 0.01), 8, look))
    return join(parts)


@cache
def _blob(number: int) -> tuple[F64, NDArray[np.int64]]:
    """Return a lumpy ball: an icosahedron whose faces are cut in four, its corners moved in and out."""
    corners, triangles = _icosahedron()
    corners, triangles = _finer(corners, triangles)
    rng = np.random.default_rng([7, number])
    lumps = rng.normal(size=(5, 3))
    lumps /= np.linalg.norm(lumps, axis=1)[:, None]
    swell = np.exp(3.0 * (corners @ lumps.T - 1.0)).sum(axis=1)
    radius = 0.72 + 0.28 * swell + rng.uniform(-0.15, 0.15, len(corners))
    shaped = corners * radius[:, None]
    shaped[:, 2] = np.where(shaped[:, 2] < 0.0, 0.75 * shaped[:, 2], shaped[:, 2])
    return shaped, triangles


def _icosahedron() -> tuple[F64, NDArray[np.int64]]:
    """Return 12 corners at distance 1 and 20 triangles that look outwards."""
    golden = (1.0 + 5.0**0.5) / 2.0
    corners = np.array(
        [(0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
        + [(a, b * golden, 0) for a in (-1, 1) for b in (-1, 1)]
        + [(b * golden, 0, a) for a in (-1, 1) for b in (-1, 1)]
    )
    corners /= np.linalg.norm(corners[0])
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    near = apart < 1.2 * np.sort(apart[0])[1]
    found = [
        (i, j, k) if np.cross(corners[j] - corners[i], corners[k] - corners[i]) @ corners[i] > 0 else (i, k, j)
        for i in range(12)
        for j in range(i + 1, 12)
        for k in range(j + 1, 12)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    return corners, np.array(found)


def _finer(corners: F64, triangles: NDArray[np.int64]) -> tuple[F64, NDArray[np.int64]]:
    """Cut every triangle of a ball in four."""
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, of_side = np.unique(sides, axis=0, return_inverse=True)
    middles = corners[unique].mean(axis=1)
    middles /= np.linalg.norm(middles, axis=1)[:, None]
    ab, bc, ca = of_side.reshape(3, -1) + len(corners)
    a, b, c = triangles.T
    cut = [np.stack(corner, axis=1) for corner in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.concatenate([corners, middles]), np.concatenate(cut)
