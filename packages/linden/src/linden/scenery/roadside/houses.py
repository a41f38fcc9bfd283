"""Houses of South Linden: frame houses with a gable to the street, bungalows, some of brick; porch, windows, chimney.

Each fills the box of its thing in the scene: the ridge is the box's top, the walls are its sides. Frame of a house: x
from the street into the lot, y to the right, z up, its origin at the middle of its foot.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import LampOf, Material, Mesh, join
from linden.scenery.patches import WALLS, PatchFrames, PatchLook, boxes, polygons

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_SIDING = np.array(
    [
        (214, 210, 198),
        (196, 188, 160),
        (150, 164, 170),
        (176, 190, 172),
        (204, 196, 178),
        (132, 142, 150),
        (188, 160, 128),
        (226, 222, 214),
        (160, 132, 112),
        (120, 140, 124),
    ]
)
_BRICKS = np.array([(142, 78, 60), (126, 68, 54), (156, 96, 72), (116, 72, 62)])
_ROOFS = np.array([(74, 70, 68), (92, 80, 72), (66, 72, 78), (104, 76, 62), (84, 84, 82)])
_DOORS = np.array([(96, 44, 38), (52, 62, 82), (70, 52, 38), (58, 78, 62), (210, 206, 196)])
_TRIM = (224, 222, 214)
_PANE = (52, 62, 72)
_STONE = (132, 128, 122)
_BRICK_SHARE = 0.22
_FOUNDATION_M = 0.45
_OVERHANG_M = 0.35
_ATTIC_M = 1.75  # of gable, for a window in it
_CLOSE_M = 4.0
_TAG = SemanticTag.BUILDINGS


class HousePlan(NamedTuple):
    """Measures of N houses, m."""

    half_x: F64
    half_y: F64
    height: F64
    eaves: F64
    storeys: NDArray[np.int64]
    gable_ahead: NDArray[np.bool_]  # the ridge runs away from the street
    draw: F64  # (N, 8)
    objects: I32

    def of(self, rows: NDArray[np.intp]) -> "HousePlan":
        """Return the measures of those of the houses."""
        return HousePlan(
            self.half_x[rows],
            self.half_y[rows],
            self.height[rows],
            self.eaves[rows],
            self.storeys[rows],
            self.gable_ahead[rows],
            self.draw[rows],
            self.objects[rows],
        )


def plans(half_m: F64, draw: F64, objects: I32) -> HousePlan:
    """Return what houses that fill boxes of these half sizes (N, 3) look like; ``draw`` (N, 8) in [0, 1)."""
    height = 2.0 * half_m[:, 2]
    storeys = np.where(height > 5.3, 2, 1)
    pitch = np.where(storeys == 2, 0.30 + 0.10 * draw[:, 0], 0.34 + 0.06 * draw[:, 0])
    return HousePlan(
        half_m[:, 0], half_m[:, 1], height, height * (1.0 - pitch), storeys, draw[:, 1] < 0.62, draw, objects
    )


def houses(frames: PatchFrames, plan: HousePlan) -> Mesh:
    """Return houses."""
    return join([_walls(frames, plan), _roofs(frames, plan), _windows(frames, plan), _doors(frames, plan)])


def _wall_look(plan: HousePlan) -> tuple[NDArray[np.bool_], NDArray[np.uint8]]:
    brick = plan.draw[:, 2] < _BRICK_SHARE
    siding = (plan.draw[:, 3] * len(_SIDING)).astype(int)
    for row in np.flatnonzero(siding[1:] == siding[:-1]) + 1:  # neighbours have different colours
        siding[row] = (siding[row - 1] + 3) % len(_SIDING)
    colour = np.where(brick[:, None], _BRICKS[(plan.draw[:, 3] * len(_BRICKS)).astype(int)], _SIDING[siding])
    return brick, colour.astype(np.uint8)


def _walls(frames: PatchFrames, plan: HousePlan) -> Mesh:
    """Return foundations, walls up to the eaves, and gables."""
    brick, colour = _wall_look(plan)
    parts = []
    zero = np.zeros(len(frames))
    middle = 0.5 * (_FOUNDATION_M + plan.eaves)
    for material, rows in ((Material.BRICK, np.flatnonzero(brick)), (Material.SIDING, np.flatnonzero(~brick))):
        look = PatchLook(material, _TAG, colour, plan.objects).of(rows)
        centre = np.column_stack([zero, zero, middle])[rows]
        half = np.column_stack([plan.half_x, plan.half_y, middle - _FOUNDATION_M])[rows]
        parts.append(boxes(frames.of(rows), centre, half, look, WALLS))
        parts.append(_gables(frames.of(rows), plan.of(rows), look))
    deep = np.column_stack([zero, zero, np.full(len(frames), 0.0)])
    half = np.column_stack([plan.half_x + 0.01, plan.half_y + 0.01, np.full(len(frames), _FOUNDATION_M)])
    stone = PatchLook(Material.CONCRETE, _TAG, _STONE, plan.objects)
    parts.append(boxes(frames, deep, half, stone, WALLS))
    return join(parts)


def _gables(frames: PatchFrames, plan: HousePlan, look: PatchLook) -> Mesh:
    """Return the triangles under the ridge at both of its ends."""
    along, across = _sides(plan)
    zero = np.zeros(len(frames))
    parts = []
    for end in (-1.0, 1.0):
        corners = [
            _point(plan, end * along, -across, plan.eaves),
            _point(plan, end * along, across, plan.eaves),
            _point(plan, end * along, zero, plan.height - 0.05),
        ]
        towards = frames.turned(_point(plan, np.full(len(frames), end), zero, zero)[:, None])[:, 0]
        parts.append(polygons(frames.world(np.stack(corners, axis=1)), look, towards))
    return join(parts)


def _sides(plan: HousePlan) -> tuple[F64, F64]:
    """Return half the length along the ridge and half the length across it."""
    return (
        np.where(plan.gable_ahead, plan.half_x, plan.half_y),
        np.where(plan.gable_ahead, plan.half_y, plan.half_x),
    )


def _point(plan: HousePlan, along: F64, across: F64, up: F64) -> F64:
    """Return points (N, 3) of the houses' frames, given along and across their ridges."""
    x = np.where(plan.gable_ahead, along, across)
    y = np.where(plan.gable_ahead, across, along)
    return np.column_stack([x, y, up])


def _roofs(frames: PatchFrames, plan: HousePlan) -> Mesh:
    """Return two slopes with eaves that stand out, their undersides, and a chimney."""
    along, across = _sides(plan)
    slope = (plan.height - plan.eaves) / across
    out, low = across + _OVERHANG_M, plan.eaves - _OVERHANG_M * slope
    length = along + _OVERHANG_M
    colour = _ROOFS[(plan.draw[:, 4] * len(_ROOFS)).astype(int)].astype(np.uint8)
    look = PatchLook(Material.SHINGLES, _TAG, colour, plan.objects)
    under = PatchLook(Material.WOOD, _TAG, _TRIM, plan.objects)
    zero = np.zeros(len(frames))
    parts = []
    for side in (-1.0, 1.0):
        corners = np.stack(
            [
                _point(plan, -length, zero, plan.height),
                _point(plan, length, zero, plan.height),
                _point(plan, length, side * out, low),
                _point(plan, -length, side * out, low),
            ],
            axis=1,
        )
        parts.append(polygons(frames.world(corners), look, (0.0, 0.0, 1.0)))
        parts.append(polygons(frames.world(corners - (0.0, 0.0, 0.12)), under, (0.0, 0.0, -1.0)))
    with_chimney = np.flatnonzero(plan.draw[:, 5] < 0.6)
    some = plan.of(with_chimney)
    along_c, across_c = _sides(some)
    at = _point(some, 0.5 * along_c, 0.25 * across_c, some.height - 0.1)
    brick = PatchLook(Material.BRICK, _TAG, _BRICKS[0].astype(np.uint8), some.objects)
    parts.append(boxes(frames.of(with_chimney), at, (0.32, 0.32, 0.75), brick))
    return join(parts)


def _windows(frames: PatchFrames, plan: HousePlan) -> Mesh:
    """Return windows: two a storey on each side, the door in place of one, and one more in gables to the street.

    Where the next house stands close by there is one, and frames are hidden there and behind.
    """
    parts = []
    close = {"back": np.ones(len(frames), bool), **_neighbours(frames, plan)}
    for storey in (1, 2):
        rows = np.flatnonzero(plan.storeys >= storey)
        some, at = plan.of(rows), frames.of(rows)
        sill = np.full(len(rows), 1.15) if storey == 1 else np.maximum(3.1, some.eaves - 1.65)
        tall = np.minimum(1.35, some.eaves - sill - 0.25)
        for side, half_run in (
            ("front", some.half_y),
            ("back", some.half_y),
            ("left", some.half_x),
            ("right", some.half_x),
        ):
            framed = ~close[side][rows] if side in close else np.ones(len(rows), bool)
            for share in (-0.5, 0.5):
                if side == "front" and storey == 1 and share > 0.0:
                    continue  # the door
                seen = framed if side in ("left", "right") and share > 0.0 else np.ones(len(rows), bool)
                parts.append(_panes(at, some, side, share * half_run, (sill, np.where(seen, tall, 0.0)), framed))
    attic = np.flatnonzero(plan.gable_ahead & (plan.storeys == 2) & (plan.height - plan.eaves > _ATTIC_M))
    some = plan.of(attic)
    sill, tall = some.eaves + 0.35, np.full(len(attic), 0.75)
    parts.append(_panes(frames.of(attic), some, "front", np.zeros(len(attic)), (sill, tall), tall > 0.0))
    return join(parts)


def _neighbours(frames: PatchFrames, plan: HousePlan) -> dict[str, NDArray[np.bool_]]:
    """Return for the left and the right of each house whether the one before or after it in the row stands close."""
    close: dict[str, NDArray[np.bool_]] = {side: np.zeros(len(frames), np.bool_) for side in ("left", "right")}
    for step in (-1, 1):
        away = np.roll(frames.base_m, -step, axis=0) - frames.base_m
        cosine, sine = np.cos(frames.yaw_rad), np.sin(frames.yaw_rad)
        deep, aside = cosine * away[:, 0] + sine * away[:, 1], cosine * away[:, 1] - sine * away[:, 0]
        gap = np.abs(aside) - plan.half_y - np.roll(plan.half_y, -step)
        beside = (np.abs(deep) < plan.half_x) & (gap < _CLOSE_M)
        close["left"] |= beside & (aside < 0.0)
        close["right"] |= beside & (aside > 0.0)
    return close


_FACING = {"front": (-1.0, 0.0), "back": (1.0, 0.0), "left": (0.0, -1.0), "right": (0.0, 1.0)}


def _panes(
    frames: PatchFrames, plan: HousePlan, side: str, run: F64, upright: tuple[F64, F64], framed: NDArray[np.bool_]
) -> Mesh:
    """Return one window of each house, a pane before its frame; ``upright`` is sill and height."""
    sill, tall = upright
    fits = np.flatnonzero(tall > 0.5)
    pane = PatchLook(Material.GLASS, _TAG, _PANE, plan.objects, LampOf.WINDOW).of(fits)
    parts = [_on(frames, plan, side, fits, (run, sill, sill + tall, 0.48, 0.035), pane)]
    fits = np.flatnonzero((tall > 0.5) & framed)
    frame = PatchLook(Material.WOOD, _TAG, _TRIM, plan.objects).of(fits)
    parts.append(_on(frames, plan, side, fits, (run, sill - 0.1, sill + tall + 0.1, 0.6, 0.025), frame))
    return join(parts)


def _on(
    frames: PatchFrames,
    plan: HousePlan,
    side: str,
    rows: NDArray[np.intp],
    place: tuple[F64, F64, F64, float, float],
    look: PatchLook,
) -> Mesh:
    """Return rectangles on a wall of those of the houses, ``place`` as :func:`_on_wall` takes it."""
    run, low, high, half, off = place
    some = frames.of(rows)
    corners = _on_wall(some, plan.of(rows), side, run[rows], low[rows], high[rows], half, off)
    return polygons(corners, look, _out(some, side))


def _out(frames: PatchFrames, side: str) -> F64:
    x, y = _FACING[side]
    return frames.turned(np.broadcast_to(np.array([x, y, 0.0]), (len(frames), 1, 3)))[:, 0]


def _on_wall(
    frames: PatchFrames, plan: HousePlan, side: str, run: F64, low: F64, high: F64, half: float, off: float
) -> F64:
    """Return upright rectangles (N, 4, 3) on a wall, ``run`` from its middle, ``off`` in front of it."""
    x, y = _FACING[side]
    corners = []
    for aside, up in ((-half, low), (half, low), (half, high), (-half, high)):
        along = run + aside
        depth = np.where(abs(x) > 0.0, plan.half_x, plan.half_y) + off
        corners.append(np.column_stack([x * depth + abs(y) * along, y * depth + abs(x) * along, up]))
    return frames.world(np.stack(corners, axis=1))


def _doors(frames: PatchFrames, plan: HousePlan) -> Mesh:
    """Return front doors with their steps."""
    colour = _DOORS[(plan.draw[:, 6] * len(_DOORS)).astype(int)].astype(np.uint8)
    low, high = np.full(len(frames), _FOUNDATION_M), np.full(len(frames), _FOUNDATION_M + 2.05)
    frame = _on_wall(frames, plan, "front", 0.5 * plan.half_y, low, high + 0.12, 0.58, 0.03)
    leaf = _on_wall(frames, plan, "front", 0.5 * plan.half_y, low, high, 0.46, 0.04)
    return join(
        [
            polygons(frame, PatchLook(Material.WOOD, _TAG, _TRIM, plan.objects), _out(frames, "front")),
            polygons(leaf, PatchLook(Material.WOOD, _TAG, colour, plan.objects), _out(frames, "front")),
        ]
    )
