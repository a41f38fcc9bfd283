"""Trees far from any street, by the dozen: what closes the view where the streets end. Nothing runs into them."""

import numpy as np
from numpy.typing import NDArray

from linden.ground import Ground
from linden.meshes.mesh import Mesh
from linden.meshes.patches import Frames
from linden.meshes.trees import clumps
from linden.scene.objects import Scene

F64 = NDArray[np.float64]
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
    return clumps(Frames(np.column_stack([places, height]), 6.0 * drawn[:, 7]), drawn)


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
