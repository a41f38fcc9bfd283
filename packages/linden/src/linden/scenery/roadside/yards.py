"""Triangle meshes of porches, hedges, fences, driveways, garden paths and doorsteps."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.maps.ground import Ground
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import PatchFrames, PatchLook, boxes, polygons
from linden.scenery.scene.neighbourhood import with_house
from linden.scenery.scene.objects import ObjectKind, Scene
from linden.scenery.scene.yard_layout import DRIVE_ASIDE_M, DRIVE_HALF_M, Drive, drives, has_porch
from linden.scenery.streets.road import CONCRETE
from linden.structured import StructuredArray

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_TRIM = (222, 220, 212)
_BOARDS = np.array([(150, 124, 94), (128, 108, 86), (206, 202, 194), (112, 96, 80)])
_HEDGE = np.array([(58, 88, 40), (70, 100, 46), (52, 78, 44)])
_ROOF = (86, 80, 76)
_FLOOR_M = 0.45
_POST_M = 0.07
_UP = (0.0, 0.0, 1.0)
_WALLS = ("left", "ahead", "right", "behind")
_SLAB_M = 0.02  # how far a drive rises above the lawn
_VERGE_M = (2.72, 1.48)  # from the lot's front back to the kerb, and to the pavement
_APRON_M = 3.15  # from the lot's front back to where the slope over the kerb meets the street
_STEP_HALF_M = (0.35, 0.75, 0.24)  # half of its height is in the ground
_PATH_HALF_M = 0.55
_HIGH_M = 1e6


def porches(frames: PatchFrames, half_m: F64, objects: I32) -> Mesh:
    """Return porches that fill boxes of these half sizes: a floor, posts, a rail, a roof that slopes to the street."""
    tag = SemanticTag.BUILDINGS
    trim = PatchLook(Material.WOOD, tag, _TRIM, objects)
    roof = PatchLook(Material.SHINGLES, tag, _ROOF, objects)
    x, y, top = half_m[:, 0], half_m[:, 1], 2.0 * half_m[:, 2]
    zero = np.zeros(len(frames))
    floor = boxes(
        frames,
        np.zeros(3),
        np.column_stack([x, y, np.full(len(x), _FLOOR_M)]),
        PatchLook(Material.CONCRETE, tag, CONCRETE, objects),
        ("top", "left", "right", "behind"),
    )
    parts = [floor]
    high = 0.5 * (top - 0.35 + _FLOOR_M)
    for share in (-1.0, 1.0):
        centre = np.column_stack([-x + _POST_M + 0.05, share * (y - _POST_M - 0.05), high])
        half = np.column_stack([zero + _POST_M, zero + _POST_M, high - _FLOOR_M])
        parts.append(boxes(frames, centre, half, trim, ("left", "behind", "right")))
    front, back = top - 0.35, top
    ends = [(-x, -y, front), (-x, y, front), (x, y, back), (x, -y, back)]
    slope = np.stack([np.column_stack(corner) for corner in ends], axis=1)
    under = slope - (0.0, 0.0, 0.14)
    parts.append(polygons(frames.world(slope), roof, _UP))
    parts.append(polygons(frames.world(under), trim, (0.0, 0.0, -1.0)))
    for a, b in ((0, 1), (1, 2), (3, 0)):
        edge = np.stack([under[:, a], under[:, b], slope[:, b], slope[:, a]], axis=1)
        middle = frames.turned((0.5 * (slope[:, a] + slope[:, b]) * (1.0, 1.0, 0.0))[:, None])[:, 0]
        parts.append(polygons(frames.world(edge), trim, middle))
    rail = np.column_stack([-x + 0.08, -0.55 * y, np.full(len(x), _FLOOR_M + 0.75)])
    parts.append(boxes(frames, rail, np.column_stack([zero + 0.03, 0.42 * y, zero + 0.04]), trim, ("top", "behind")))
    return join(parts)


def hedges(frames: PatchFrames, half_m: F64, draw: F64, objects: I32) -> Mesh:
    """Return clipped hedges, a little rounded on top."""
    look = PatchLook(
        Material.LEAVES, SemanticTag.VEGETATION, _HEDGE[(draw[:, 0] * 3).astype(int)].astype(np.uint8), objects
    )
    lower = boxes(frames, half_m * (0.0, 0.0, 0.8), half_m * (1.0, 1.0, 0.8), look, _WALLS)
    foot = np.array([(-1, -1, 1.6), (1, -1, 1.6), (1, 1, 1.6), (-1, 1, 1.6)], np.float64)
    crest = np.array([(-0.6, -0.94, 2.0), (0.6, -0.94, 2.0), (0.6, 0.94, 2.0), (-0.6, 0.94, 2.0)])
    parts = [lower, polygons(frames.world(half_m[:, None] * crest), look, _UP)]
    for k in range(4):
        n = (k + 1) % 4
        parts.append(
            polygons(frames.world(half_m[:, None] * np.stack([foot[k], foot[n], crest[n], crest[k]])), look, _UP)
        )
    return join(parts)


def fences(frames: PatchFrames, half_m: F64, draw: F64, objects: I32) -> Mesh:
    """Return fences: high ones of boards, low ones of pickets with gaps between."""
    colour = _BOARDS[(draw[:, 0] * len(_BOARDS)).astype(int)].astype(np.uint8)
    look = PatchLook(Material.WOOD, SemanticTag.FENCES, colour, objects)
    tall = half_m[:, 2] > 0.75
    parts = [_solid(frames.of(rows), half_m[rows], look.of(rows)) for rows in (np.flatnonzero(tall),)]
    low = np.flatnonzero(~tall)
    parts.append(_rails(frames.of(low), half_m[low], look.of(low)))
    return join(parts)


def _solid(frames: PatchFrames, half_m: F64, look: PatchLook) -> Mesh:
    return boxes(frames, half_m * (0.0, 0.0, 1.0), half_m, look)


def _rails(frames: PatchFrames, half_m: F64, look: PatchLook) -> Mesh:
    """Return two rails between posts, without their hidden faces."""
    parts = []
    for sides, rows in (
        (("top", "left", "right"), np.flatnonzero(half_m[:, 0] > half_m[:, 1])),
        (("top", "ahead", "behind"), np.flatnonzero(half_m[:, 0] <= half_m[:, 1])),
    ):
        for height in (0.8, 1.75):
            centre, half = half_m[rows] * (0.0, 0.0, height), half_m[rows] * (1.0, 1.0, 0.09)
            half[:, :2] = np.where(half[:, :2] < 0.1, 0.5 * half[:, :2], half[:, :2])
            parts.append(boxes(frames.of(rows), centre, half, look.of(rows), sides))
        for share in (-0.98, 0.0, 0.98):
            along = np.where(half_m[rows, :2] > 0.1, share * half_m[rows, :2], 0.0)
            centre = np.column_stack([along, half_m[rows, 2]])
            half = np.column_stack([np.full((len(rows), 2), 0.045), half_m[rows, 2]])
            parts.append(boxes(frames.of(rows), centre, half, look.of(rows), sides[1:]))
    return join(parts)


def paved_yards(lots: StructuredArray, scene: Scene, ground: Ground, lawn: Ground) -> Mesh:
    """Return drives from the kerb to the house and paths to front doors; they lie on the lawn and are no objects."""
    under = _Under(ground, lawn)
    drive = drives(lots, scene)
    house = with_house(lots)
    rows = np.searchsorted(scene.boxes["thing"], np.flatnonzero(scene.things["kind"] == ObjectKind.HOUSE))
    box = scene.boxes[rows]
    front = np.hypot(*(box["centre"][:, :2] - lots["front_m"][house]).T) - box["half"][:, 0]
    door = 0.5 * box["half"][:, 1]
    frames = PatchFrames(np.column_stack([lots["front_m"], np.zeros(len(lots))]), lots["yaw_rad"])
    plain = np.flatnonzero(~has_porch(lots)[house])
    return join(
        [
            *_bays(frames.of(drive.lot), drive, under),
            *_lengths(frames.of(house), (0.0 * front, front), (door - _PATH_HALF_M, door + _PATH_HALF_M), under),
            _steps(frames.of(house[plain]), front[plain], door[plain], under),
        ]
    )


def _steps(frames: PatchFrames, wall: F64, door: F64, under: "_Under") -> Mesh:
    """Return a step before each door, ``wall`` away from the lot's front and ``door`` to the right of its middle."""
    middle = np.column_stack([wall - _STEP_HALF_M[0], door, np.zeros(len(wall))])
    foot = frames.world(middle[:, None])[:, 0]
    foot[:, 2] = _HIGH_M
    foot[:, 2] = under.heights(foot)
    look = PatchLook(Material.CONCRETE, SemanticTag.BUILDINGS, CONCRETE)
    return boxes(PatchFrames(foot, frames.yaw_rad), np.zeros(3), _STEP_HALF_M, look, ("top", "left", "right", "behind"))


class _Under(NamedTuple):
    """What slabs lie on: the road's verge, and beyond it the lawn as it is seen."""

    roads: Ground
    lawn: Ground

    def heights(self, points_m: F64) -> F64:
        """Return the heights (N,) under points (N, 3)."""
        on_road, on_lawn = self.roads.surfaces_under(points_m), self.lawn.surfaces_under(points_m)
        return np.where((on_lawn[1] >= 0) & (on_road[1] < 0), on_lawn[0], on_road[0])


def _bays(frames: PatchFrames, drive: Drive, under: _Under) -> list[Mesh]:
    zero = np.zeros(len(frames))
    aside = drive.side * DRIVE_ASIDE_M
    across = (aside - DRIVE_HALF_M, aside + DRIVE_HALF_M)
    verge = _slab(frames, (zero - _VERGE_M[0], zero - _VERGE_M[1]), across, under)
    apron = _slab(frames, (zero - _VERGE_M[0], zero - _APRON_M), across, under)
    return [apron, verge, *_lengths(frames, (zero, drive.length_m), across, under)]


def _lengths(frames: PatchFrames, along: tuple[F64, F64], across: tuple[F64, F64], under: _Under) -> list[Mesh]:
    """Return slabs in two lengths, so that they follow the ground."""
    shares = (0.0, 0.5, 1.0)
    places = [along[0] + share * (along[1] - along[0]) for share in shares]
    return [_slab(frames, pair, across, under) for pair in pairwise(places)]


def _slab(frames: PatchFrames, along: tuple[F64, F64], across: tuple[F64, F64], under: _Under) -> Mesh:
    corners = np.stack(
        [np.column_stack([along[i], across[j], np.zeros(len(frames))]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))],
        axis=1,
    )
    world = frames.world(corners)
    world[..., 2] = _HIGH_M
    world[..., 2] = under.heights(world.reshape(-1, 3)).reshape(-1, 4) + _SLAB_M
    return polygons(world, PatchLook(Material.CONCRETE, SemanticTag.TERRAIN, CONCRETE), _UP)
