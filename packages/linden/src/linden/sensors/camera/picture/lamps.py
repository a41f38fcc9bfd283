"""Lamps that light what is near them: street lamps, and the head and tail lamps of vehicles, found on their meshes.

Their strengths are chosen to go with the moonlight of ``atmosphere``, which is far brighter than the true one: no
picture of 8 bits could hold both.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.scenery.mesh import LampOf, Mesh
from linden.sensors.view import LINEAR, Seen
from linden.structured import StructuredArray

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

CELL_M = 8.0
CELLS = 40
_REACH_M = CELL_M * CELLS / 2.0

LAMPLIGHT = np.dtype(
    [
        ("place", "f4", 3),  # m, world
        ("towards", "f4", 3),  # direction of its middle, length 1
        ("light", "f4", 3),  # of a white surface square to it one metre away
        ("reach", "f4"),  # m; no light goes further
        ("low", "f4"),  # cosine from which it gives light, and
        ("high", "f4"),  # from which it gives all of it
        ("cut", "?"),  # whether it is a low beam, dimmed above its middle
    ],
    align=True,  # or a GPU could not read it
)

_STREET, _HEAD, _TAIL = int(LampOf.STREET), int(LampOf.HEAD), int(LampOf.TAIL)
_STRENGTH = {_STREET: 6.5, _HEAD: 17.0, _TAIL: 0.10}
_COLOUR = {_HEAD: (1.0, 0.95, 0.86), _TAIL: (1.0, 0.06, 0.03)}
_FORM = {_STREET: (26.0, 0.05, 0.75, False), _HEAD: (55.0, 0.70, 0.985, True), _TAIL: (6.0, 0.0, 0.8, False)}
_DIP = math.radians(1.5)


class LampGroup(NamedTuple):
    """One lamp of a mesh: what it is, its middle in the mesh's frame (m), and its object where it stands."""

    lamp: int
    middle_m: tuple[float, float, float]
    object: int


class StandingLamps(NamedTuple):
    """The lamps of what stands (L,), likewise."""

    lamp: NDArray[np.uint32]
    middle_m: F64  # (L, 3)
    object: NDArray[np.int64]


class LampGrid(NamedTuple):
    """Lamps near a camera, and which reach into each cell of a square around it."""

    west_m: float
    north_m: float
    first: I32  # (cells + 1,) rows of ``number``, cell after cell along x
    number: I32
    lamps: StructuredArray  # of LAMPLIGHT


def groups(mesh: Mesh, *, standing: bool) -> tuple[LampGroup, ...]:
    """Return the lamps of a mesh that light their surroundings.

    Faces of one kind belong together by their object where they stand, on a body by the side they are on.
    """
    found = []
    for lamp in (_STREET,) if standing else (_HEAD, _TAIL):
        rows = np.flatnonzero(mesh.faces["lamp"] == lamp)
        middles = mesh.vertices_m[mesh.triangles[rows]].mean(axis=1) if len(rows) else np.zeros((0, 3))
        keys = mesh.faces["object"][rows] if standing else np.sign(np.round(middles[:, 1], 1)).astype(np.int64)
        for key in np.unique(keys).tolist():
            x, y, z = middles[keys == key].mean(axis=0).tolist()
            found.append(LampGroup(lamp, (x, y, z), key if standing else -1))
    return tuple(found)


def standing_lamps(mesh: Mesh) -> StandingLamps:
    """Return the lamps of what stands; those of no object cannot be lit."""
    found = [group for group in groups(mesh, standing=True) if group.object >= 0]
    return StandingLamps(
        np.array([group.lamp for group in found], np.uint32),
        np.array([group.middle_m for group in found], np.float64).reshape(-1, 3),
        np.array([group.object for group in found], np.int64),
    )


def lamps_near(place_m: F64, seen: Seen, standing: StandingLamps, bodies: Sequence[Sequence[LampGroup]]) -> LampGrid:
    """Return the lamps that shine within reach of a camera at ``place_m`` (3,)."""
    rows: list[tuple[object, ...]] = []
    shining = seen.object_lights[standing.object] >> standing.lamp & np.uint32(1)
    away = standing.middle_m[:, :2] - place_m[:2]
    for row in np.flatnonzero(shining.astype(np.bool_) & (np.hypot(away[:, 0], away[:, 1]) < _REACH_M)).tolist():
        colour = LINEAR[seen.object_light_colour[standing.object[row]]]
        rows.append(_row(int(standing.lamp[row]), standing.middle_m[row], (0.0, 0.0, -1.0), colour))
    moving = seen.instances
    for body in np.flatnonzero(moving.lights).tolist():
        pose, lights = moving.pose[body], int(moving.lights[body])
        if abs(pose[:2, 3] - place_m[:2]).max() > _REACH_M:
            continue
        for group in bodies[moving.mesh[body]]:
            if lights >> group.lamp & 1:
                forward = pose[:, :3] @ ((math.cos(_DIP), 0.0, -math.sin(_DIP)) if group.lamp == _HEAD else (-1, 0, 0))
                middle = pose[:, :3] @ np.array(group.middle_m) + pose[:, 3]
                rows.append(_row(group.lamp, middle, forward, np.array(_COLOUR[group.lamp])))
    lamps = np.array(rows, LAMPLIGHT) if rows else np.zeros(0, LAMPLIGHT)
    west, north = (math.floor(value / CELL_M) * CELL_M - _REACH_M for value in place_m[:2].tolist())
    first, number = _sorted_into_cells(
        lamps["place"].astype(np.float64), lamps["reach"].astype(np.float64), west, north
    )
    return LampGrid(west, north, first, number, lamps)


def _row(lamp: int, place: Iterable[float], towards: Iterable[float], colour: Iterable[float]) -> tuple[object, ...]:
    """Return a row of LAMPLIGHT."""
    return (tuple(place), tuple(towards), tuple(_STRENGTH[lamp] * value for value in colour), *_FORM[lamp])


@kernel
def _sorted_into_cells(place: F64, reach: F64, west: float, north: float) -> tuple[I32, I32]:
    """Return which lamps reach into which cell, as ``LampGrid`` has it."""
    low, high = np.empty((len(place), 2), np.int64), np.empty((len(place), 2), np.int64)
    counts = np.zeros(CELLS * CELLS + 1, np.int32)
    for lamp in range(len(place)):
        for axis in range(2):
            middle = place[lamp, axis] - (west if axis == 0 else north)
            low[lamp, axis] = max(0, int((middle - reach[lamp]) // CELL_M))
            high[lamp, axis] = min(CELLS - 1, int((middle + reach[lamp]) // CELL_M))
        for y in range(low[lamp, 1], high[lamp, 1] + 1):
            for x in range(low[lamp, 0], high[lamp, 0] + 1):
                counts[y * CELLS + x + 1] += 1
    first = np.cumsum(counts).astype(np.int32)
    filled, number = first.copy(), np.empty(first[-1], np.int32)
    for lamp in range(len(place)):
        for y in range(low[lamp, 1], high[lamp, 1] + 1):
            for x in range(low[lamp, 0], high[lamp, 0] + 1):
                number[filled[y * CELLS + x]] = lamp
                filled[y * CELLS + x] += 1
    return first, number
