"""Meshes of trees, near the streets and far from them.

A tree is a trunk and a crown of a few clumps of leaves, turned and stretched for each tree; some are conifers. Trees
along the streets have more clumps. Trees far from any street close the view where the streets end, and have no contact.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import FACE, NO_OBJECT, Material, Mesh, join
from linden.scenery.patches import PatchFrames, PatchLook, prisms
from linden.scenery.scene.objects import Scene

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_LEAVES = np.array([(82, 104, 52), (92, 114, 56), (72, 96, 50), (104, 118, 60), (86, 106, 66), (110, 112, 58)])
_NEEDLES = np.array([(52, 76, 54), (58, 82, 60), (46, 68, 54)])
_BARK = np.array([(84, 68, 54), (96, 82, 68), (70, 58, 48)])
_SHAPES = 6
_CONIFERS = 0.14
_CLUMPS, _CLUMPS_BEHIND = 3, 2
_TWIGS = 24
"""Of a crown that is seen from near: single sprays of leaves that stand out of its clumps."""
_ROOT_M = 0.3  # how far a trunk reaches into the ground
_SKIRTS = ((0.10, 0.50, 0.26), (0.32, 0.76, 0.20), (0.58, 1.0, 0.13))
"""Of a conifer: where a skirt of branches begins and ends, and how wide it is, in shares of the height."""


class Planted(NamedTuple):
    """N trees: where they stand, half the thickness and the height of their trunks, what was drawn for each."""

    frames: PatchFrames
    trunk_half_m: F64
    trunk_height_m: F64
    draw: F64  # (N, 6) in [0, 1): decides what kind, how tall and how wide each is
    objects: I32

    def of(self, rows: NDArray[np.intp]) -> "Planted":
        """Return those of the trees."""
        return Planted(
            self.frames.of(rows),
            self.trunk_half_m[rows],
            self.trunk_height_m[rows],
            self.draw[rows],
            self.objects[rows],
        )


def trees(planted: Planted, by_street: NDArray[np.bool_]) -> Mesh:
    """Return trees; those ``by_street`` (N,) are seen from near."""
    conifer = planted.draw[:, 0] < _CONIFERS
    shape = (planted.draw[:, 5] * _SHAPES).astype(int)
    parts = [_trunks(planted), _cones(planted.of(np.flatnonzero(conifer)))]
    for clumps, twigs, chosen in ((_CLUMPS, _TWIGS, by_street), (_CLUMPS_BEHIND, 0, ~by_street)):
        for number in range(_SHAPES):
            rows = np.flatnonzero(~conifer & chosen & (shape == number))
            parts.append(_crowns(_crown(number, clumps, twigs), planted.of(rows)))
    return join(parts)


def _trunks(planted: Planted) -> Mesh:
    base, half, draw = planted.frames.base_m, planted.trunk_half_m, planted.draw
    bark = _BARK[(draw[:, 1] * len(_BARK)).astype(int)]
    top = base + np.column_stack([0.3 * (draw[:, 2:4] - 0.5), planted.trunk_height_m + 0.2])
    look = PatchLook(Material.BARK, SemanticTag.VEGETATION, bark, planted.objects)
    return prisms(base - (0.0, 0.0, _ROOT_M), top, (1.25 * half, 0.7 * half), 5, look, lid=False)


class _Crown(NamedTuple):
    """A crown about its middle, a metre in radius, roughly."""

    corners: F64  # (K, 3)
    triangles: NDArray[np.int64]
    light: F64  # of each triangle: what lies low or within is darker


def _crowns(crown: _Crown, planted: Planted) -> Mesh:
    """Return crowns of one shape: the thicker the trunk the wider the crown."""
    draw = planted.draw
    wide = 9.0 * planted.trunk_half_m + 1.1 + 0.8 * draw[:, 3]
    tall = wide * (0.85 + 0.45 * draw[:, 4])
    size = np.column_stack([wide, wide * (0.9 + 0.2 * draw[:, 2]), tall])
    return _shaped(crown, planted.frames, size, planted.trunk_height_m - 1.2 + 0.8 * tall, draw, planted.objects)


def clumps(frames: PatchFrames, draw: F64) -> Mesh:
    """Return trees so close to each other, and so far away, that each clump is one round body down to the grass."""
    size = np.column_stack([8.0 + 5.0 * draw[:, 3], 8.0 + 5.0 * draw[:, 4], 7.0 + 4.0 * draw[:, 5]])
    nothing = np.full(len(frames), NO_OBJECT, np.int32)
    shape = (draw[:, 0] * _SHAPES).astype(int)
    parts = []
    for number in range(_SHAPES):
        rows = np.flatnonzero(shape == number)
        up_m = 0.3 * size[rows, 2]
        parts.append(_shaped(_crown(number, 1, 0), frames.of(rows), size[rows], up_m, draw[rows], nothing[rows]))
    return join(parts)


def _shaped(crown: _Crown, frames: PatchFrames, size_m: F64, up_m: F64, draw: F64, objects: I32) -> Mesh:
    """Return crowns of one shape, stretched to ``size_m`` (N, 3), their middles so far up."""
    count = len(frames)
    points = crown.corners[None] * size_m[:, None]
    points[..., 2] += up_m[:, None]
    world = PatchFrames(frames.base_m, frames.yaw_rad + 6.3 * draw[:, 1]).world(points)
    faces = np.zeros((count, len(crown.triangles)), FACE)
    faces["material"], faces["tag"] = Material.LEAVES, SemanticTag.VEGETATION
    faces["object"] = objects[:, None]
    colour = _LEAVES[(draw[:, 2] * len(_LEAVES)).astype(int)] * (0.85 + 0.3 * draw[:, 4])[:, None]
    faces["colour"] = np.clip(colour[:, None] * crown.light[None, :, None], 0.0, 255.0)
    numbers = np.arange(count)[:, None, None] * len(crown.corners) + crown.triangles[None]
    return Mesh(world.reshape(-1, 3).astype(np.float32), numbers.reshape(-1, 3).astype(np.uint32), faces.reshape(-1))


def _cones(planted: Planted) -> Mesh:
    """Return conifers: skirts of branches one above the other."""
    height = 6.5 + 6.0 * planted.draw[:, 4]
    needles = _NEEDLES[(planted.draw[:, 2] * len(_NEEDLES)).astype(int)]
    look = PatchLook(Material.LEAVES, SemanticTag.VEGETATION, needles, planted.objects)
    up = np.array([0.0, 0.0, 1.0])
    ends = [(planted.frames.base_m + up * (share * height)[:, None] for share in skirt[:2]) for skirt in _SKIRTS]
    return join(
        [
            prisms(low, high, (width * height, 0.01), 8, look, lid=False)
            for (low, high), (_, _, width) in zip(ends, _SKIRTS, strict=True)
        ]
    )


@cache
def _crown(number: int, clumps: int, twigs: int) -> _Crown:
    """Return a crown of so many clumps: one in the middle, the others leaning out of it all round, the last on top."""
    rng = np.random.default_rng([7, number, clumps])
    ball, triangles = _icosahedron()
    turn = rng.uniform(0.0, 2.0 * np.pi)
    corners, lights = [], []
    for nth in range(clumps):
        if nth == 0:
            centre, radius = np.array([0.0, 0.0, -0.05]), 0.86
        elif nth == clumps - 1:
            centre, radius = np.array([*rng.uniform(-0.25, 0.25, 2), 0.42]), rng.uniform(0.55, 0.66)
        else:
            angle = turn + nth * 2.0 * np.pi / max(clumps - 2, 1) + rng.uniform(-0.4, 0.4)
            centre = np.array([0.42 * np.cos(angle), 0.42 * np.sin(angle), rng.uniform(-0.25, 0.1)])
            radius = rng.uniform(0.56, 0.68)
        lumpy = _turned(ball, rng) * (radius * rng.uniform(0.88, 1.12, (len(ball), 1)))
        lumpy[:, 2] *= 0.85
        corners.append(centre + lumpy)
        middle = corners[-1][triangles].mean(axis=1)
        lights.append(np.clip(0.98 + 0.22 * middle[:, 2], 0.78, 1.15))
    fans = (np.arange(clumps)[:, None, None] * len(ball) + triangles[None]).reshape(-1, 3)
    solid = np.concatenate(corners)
    sprays = _sprays(solid, twigs, rng)
    loose = len(solid) + np.arange(3 * twigs).reshape(-1, 3)
    light = np.clip(1.04 + 0.2 * sprays[:, :, 2].mean(axis=1), 0.84, 1.2)
    return _Crown(
        np.concatenate([solid, sprays.reshape(-1, 3)]), np.concatenate([fans, loose]), np.concatenate([*lights, light])
    )


def _sprays(solid: F64, count: int, rng: np.random.Generator) -> F64:
    """Return triangles (count, 3, 3) on the outside of a crown with these corners, each turned a little out of it."""
    golden_rad = np.pi * (3.0 - 5.0**0.5)
    up = 1.0 - 1.7 * (np.arange(count) + 0.5) / max(count, 1)
    angle = golden_rad * np.arange(count)
    level = np.sqrt(1.0 - up * up)
    out = np.column_stack([level * np.cos(angle), level * np.sin(angle), up])
    # the crown reaches as far as the farthest corner that lies that way
    reach = (solid[:, None] * out).sum(axis=2).max(axis=0, initial=0.0)
    middle = out * (reach * rng.uniform(0.8, 0.92, count))[:, None]
    u = np.cross(out, rng.normal(size=(count, 3)))
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(out, u) + 0.9 * rng.uniform(0.3, 1.0, (count, 1)) * out
    size = rng.uniform(0.15, 0.27, (count, 1))
    corners = [middle - size * u - 0.5 * size * v, middle + size * u - 0.5 * size * v, middle + 1.1 * size * v]
    return np.stack(corners, axis=1)


def _turned(points: F64, rng: np.random.Generator) -> F64:
    """Return points turned about the origin, any way: by a quaternion of length 1, drawn evenly."""
    drawn = rng.normal(size=4)
    w, x, y, z = (drawn / np.sqrt((drawn * drawn).sum())).tolist()
    turn = np.array(
        [
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        ]
    )
    turned: F64 = (points[:, None] * turn).sum(axis=2)
    return turned


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


Flags = NDArray[np.bool_]

_SEED = 41
_CELL_M = 20.0
_NEAREST, _OUTER, _FARTHEST = 3, 6, 12  # cells from the next road
_SHARE, _OUTER_SHARE = 0.012, 0.038
"""How many cells have trees, between the streets and beyond the outermost."""
_HIGH_M = 1e6


def woods(scene: Scene, ground: Ground) -> Mesh:
    """Return clumps of trees wherever neither a road nor a thing is near, around the streets and some way beyond."""
    corners = np.concatenate([ground.planes[:, :2], scene.boxes["centre"][:, :2]])
    low = np.floor(corners.min(axis=0) / _CELL_M).astype(np.int64) - _FARTHEST
    at = np.floor(corners / _CELL_M).astype(np.int64) - low
    taken = np.zeros(at.max(axis=0) + _FARTHEST + 1, bool)
    taken[at[:, 0], at[:, 1]] = True
    away = _steps_away(taken)
    rng = np.random.default_rng(_SEED)
    draw, shift = rng.random(taken.shape), rng.random((*taken.shape, 2))
    share = np.where(away >= _OUTER, _OUTER_SHARE, np.where(away >= _NEAREST, _SHARE, 0.0))
    cells = np.argwhere(draw < share)
    places = (cells + low + shift[cells[:, 0], cells[:, 1]]) * _CELL_M
    height, _ = ground.surfaces_under(np.column_stack([places, np.full(len(places), _HIGH_M)]))
    drawn = rng.random((len(places), 8))
    return clumps(PatchFrames(np.column_stack([places, height]), 6.0 * drawn[:, 7]), drawn)


def _steps_away(taken: Flags) -> NDArray[np.int64]:
    """Return how many cells each cell is away from those taken, ``_FARTHEST`` at most."""
    away = np.where(taken, 0, _FARTHEST)
    reached = taken
    for step in range(1, _FARTHEST):
        wider = reached.copy()
        for axis in (0, 1):
            for back in (slice(1, None), slice(None, -1)):
                ahead = slice(None, -1) if back.start else slice(1, None)
                one, other = [slice(None), slice(None)], [slice(None), slice(None)]
                one[axis], other[axis] = back, ahead
                wider[tuple(one)] |= reached[tuple(other)]
        away[wider & ~reached] = step
        reached = wider
    return away
