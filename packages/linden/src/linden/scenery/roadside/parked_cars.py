"""Parked cars: of fewer triangles than driven cars, because there are a thousand; each fills its box."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import PatchFrames, PatchLook, polygons

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_COLOURS = np.array([
    (188, 190, 192), (32, 34, 38), (226, 226, 224), (96, 100, 106),
    (118, 26, 30), (34, 52, 92), (60, 74, 62), (150, 132, 104),
])  # fmt: skip
_PANE, _TYRE, _RIM = (34, 42, 50), (26, 26, 27), (150, 152, 156)
_HEAD, _TAIL = (230, 232, 226), (150, 24, 24)
_TAG = SemanticTag.CAR
_WHEEL_SIDES = 8
_CAP = [0, 1, 3, 4, 5, 7]
_TREADS = (5, 6)  # the sides of a wheel that look down; the others are in its arch


class _Outline(NamedTuple):
    """A car from the side, in shares of its box: x from -1 (rear) to 1, z from 0 to 1."""

    lower: tuple[tuple[float, float], ...]  # the body's upper edge from rear to front
    roof: tuple[tuple[float, float], ...]  # foot of the rear window, roof's rear, roof's front, foot of the windscreen


_OUTLINES = {
    "saloon": _Outline(
        ((-1.0, 0.30), (-0.99, 0.62), (-0.62, 0.66), (0.38, 0.64), (0.92, 0.52), (1.0, 0.40), (1.0, 0.28)),
        ((-0.66, 0.65), (-0.36, 0.98), (0.06, 1.0), (0.42, 0.63)),
    ),
    "utility": _Outline(
        ((-1.0, 0.30), (-0.99, 0.60), (-0.94, 0.63), (0.42, 0.62), (0.95, 0.55), (1.0, 0.42), (1.0, 0.28)),
        ((-0.95, 0.62), (-0.84, 0.98), (0.08, 1.0), (0.46, 0.61)),
    ),
    "hatchback": _Outline(
        ((-1.0, 0.28), (-0.99, 0.60), (-0.92, 0.64), (0.42, 0.62), (0.93, 0.50), (1.0, 0.40), (1.0, 0.28)),
        ((-0.93, 0.63), (-0.72, 0.97), (0.10, 1.0), (0.48, 0.61)),
    ),
}
_BELLY, _SILL = 0.14, 0.30  # heights of underside and sills, shares of the box
_INSET = 0.97  # of the body within the box; the mirrors reach its sides
_ROOF_IN = 0.74  # half the width of the roof, in shares of the body's


def parked_cars(frames: PatchFrames, half_m: F64, draw: F64, objects: I32) -> Mesh:
    """Return cars in boxes of these half sizes (N, 3); ``draw`` (N, 8) gives their colours."""
    kind = np.where(half_m[:, 2] > 0.8, 1, np.where(half_m[:, 0] < 2.1, 2, 0))
    paint = _COLOURS[(draw[:, 0] * len(_COLOURS)).astype(int)].astype(np.uint8)
    parts = []
    for number, outline in enumerate(_OUTLINES.values()):
        rows = np.flatnonzero(kind == number)
        if len(rows):
            parts.append(_cars(frames.of(rows), half_m[rows], outline, paint[rows], objects[rows]))
    return join(parts)


def _cars(frames: PatchFrames, half_m: F64, outline: _Outline, paint: NDArray[np.uint8], objects: I32) -> Mesh:
    painted = PatchLook(Material.CAR_PAINT, _TAG, paint, objects)
    glass = PatchLook(Material.GLASS, _TAG, _PANE, objects)
    dark = PatchLook(Material.RUBBER, _TAG, _TYRE, objects)
    put = _Put(frames, half_m)
    parts = []
    lower = [(-0.98, _BELLY), *outline.lower, (0.98, _BELLY)]
    for (x0, z0), (x1, z1) in pairwise(lower):
        y0, y1 = _INSET * _taper(x0), _INSET * _taper(x1)
        parts.append(
            put.patch(
                [(x0, -y0, z0), (x0, y0, z0), (x1, y1, z1), (x1, -y1, z1)], painted, (x0 + x1, 0.0, z0 + z1 - 0.9)
            )
        )
    for side in (-1.0, 1.0):
        flank = [(x, side * _INSET * _taper(x), z) for x, z in outline.lower]
        parts.append(put.patch(flank, painted, (0.0, side, 0.0)))
    parts.append(
        put.patch(
            [(-0.98, -0.9, _BELLY), (-0.98, 0.9, _BELLY), (0.98, 0.9, _BELLY), (0.98, -0.9, _BELLY)],
            dark,
            (0.0, 0.0, -1.0),
        )
    )
    for side in (-1.0, 1.0):
        ends = [(x, side * y, z) for x, y, z in ((-0.98, 0.9, _BELLY), (-0.98, 0.93, _SILL))]
        sill = [*ends, *((-x, y, z) for x, y, z in reversed(ends))]
        parts += [put.patch(sill, dark, (0.0, side, 0.0))]
    parts += _cabin(put, outline, painted, glass)
    parts += _lamps(put, outline, objects)
    parts += [_wheel(frames, half_m, x, side, objects) for x in (-0.6, 0.62) for side in (-1.0, 1.0)]
    return join(parts)


def _taper(x: float) -> float:
    """Return how wide a body is there, in shares: its ends are rounded."""
    return 1.0 - 0.12 * max(0.0, abs(x) - 0.7) / 0.3


def _cabin(put: "_Put", outline: _Outline, painted: PatchLook, glass: PatchLook) -> list[Mesh]:
    """Return windows all round and the roof, with pillars in between."""
    (rx, rz), (ax, az), (bx, bz), (fx, fz) = outline.roof
    low, high = 0.93 * _INSET, _ROOF_IN * _INSET
    parts = [
        put.patch([(ax, -high, az), (ax, high, az), (bx, high, bz), (bx, -high, bz)], painted, (0.0, 0.0, 1.0)),
        put.patch([(rx, -low, rz), (rx, low, rz), (ax, high, az), (ax, -high, az)], glass, (-1.0, 0.0, 0.6)),
        put.patch([(fx, -low, fz), (fx, low, fz), (bx, high, bz), (bx, -high, bz)], glass, (1.0, 0.0, 0.6)),
    ]
    for side in (-1.0, 1.0):
        wall = [(rx, side * low, rz), (fx, side * low, fz), (bx, side * high, bz), (ax, side * high, az)]
        parts.append(put.patch(wall, painted, (0.0, side, 0.2)))
        middle = 0.5 * (ax + bx)
        for x0, x1, t0, t1 in (
            (rx + 0.08, middle - 0.03, ax + 0.02, middle - 0.03),
            (middle + 0.03, fx - 0.1, middle + 0.03, bx - 0.03),
        ):
            y0, y1, z0, z1 = low - 0.01, high + 0.02, 0.04 + max(rz, fz), min(az, bz) - 0.04
            pane = [
                (x0, side * (y0 + 0.01), z0),
                (x1, side * (y0 + 0.01), z0),
                (t1, side * (y1 + 0.01), z1),
                (t0, side * (y1 + 0.01), z1),
            ]
            parts.append(put.patch(pane, glass, (0.0, side, 0.2)))
    return parts


def _lamps(put: "_Put", outline: _Outline, objects: I32) -> list[Mesh]:
    front, rear = outline.lower[-2][1], outline.lower[1][1]
    parts = []
    for side in (-1.0, 1.0):
        for x, z, colour, way in ((1.002, front, _HEAD, 1.0), (-1.002, rear, _TAIL, -1.0)):
            look = PatchLook(Material.GLASS, _TAG, colour, objects)
            y0, y1 = side * 0.42, side * 0.8
            parts.append(
                put.patch(
                    [(x, y0, z - 0.02), (x, y1, z - 0.02), (x, y1, z - 0.11), (x, y0, z - 0.11)], look, (way, 0.0, 0.0)
                )
            )
    return parts


def _wheel(frames: PatchFrames, half_m: F64, x: float, side: float, objects: I32) -> Mesh:
    """Return one wheel of each car: a disc with its tread, half hidden in the body."""
    radius = 0.225 * 2.0 * half_m[:, 2]
    angles = np.arange(_WHEEL_SIDES) * (2.0 * np.pi / _WHEEL_SIDES)
    ring = np.stack([np.cos(angles), np.zeros(_WHEEL_SIDES), np.sin(angles)], axis=1)
    hub = np.stack([x * half_m[:, 0], side * (half_m[:, 1] - 0.02), radius], axis=1)
    outer = hub[:, None] + ring * radius[:, None, None]
    inner = outer - (0.0, side * 0.2, 0.0)
    tyre, rim = PatchLook(Material.RUBBER, _TAG, _TYRE, objects), PatchLook(Material.METAL, _TAG, _RIM, objects)
    out = frames.turned(np.broadcast_to(np.array([0.0, side, 0.0]), (len(frames), 1, 3)))[:, 0]
    parts = [polygons(frames.world(outer), tyre, out)]
    cap = hub[:, None] + 0.6 * ring[_CAP] * radius[:, None, None] + (0.0, side * 0.006, 0.0)
    parts.append(polygons(frames.world(cap), rim, out))
    for k in _TREADS:
        n = (k + 1) % _WHEEL_SIDES
        tread = np.stack([outer[:, k], outer[:, n], inner[:, n], inner[:, k]], axis=1)
        away = frames.turned((ring[k] + ring[n])[None, None] * np.ones((len(frames), 1, 1)))[:, 0]
        parts.append(polygons(frames.world(tread), tyre, away))
    return join(parts)


class _Put:
    """Puts patches given in shares of the boxes into the world."""

    def __init__(self, frames: PatchFrames, half_m: F64) -> None:
        self._frames = frames
        self._size = half_m * (1.0, 1.0, 2.0)

    def patch(
        self, shares: list[tuple[float, float, float]], look: PatchLook, towards: tuple[float, float, float]
    ) -> Mesh:
        """Return one patch of each car, looking ``towards`` (in the car's frame)."""
        corners = np.array(shares)[None] * self._size[:, None]
        way = self._frames.turned(np.broadcast_to(np.array(towards), (len(self._frames), 1, 3)))[:, 0]
        return polygons(self._frames.world(corners), look, way)
