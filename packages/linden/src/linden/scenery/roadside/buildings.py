"""Buildings on the footprints that a map gives, with flat roofs, and the furniture beside streets."""

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.scenery.actors.actor_meshes import actor_meshes
from linden.scenery.mesh import LampOf, Material, Mesh, join
from linden.scenery.patches import WALLS, PatchFrames, PatchLook, boxes

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_WALLS = np.array([(142, 78, 60), (168, 150, 128), (126, 68, 54), (150, 146, 140), (184, 172, 150)])
_ROOF, _PANE = (84, 84, 82), (52, 62, 72)
_STOREY_M = 3.2
_MOST_STOREYS = 40
_SILL_M, _PANE_M = 1.0, 1.3  # of a window: how far above its floor, how high
_PROUD_M = 0.02  # of the wall
_MARGIN = 0.85  # of a wall's length that its row of windows takes
_FURNITURE = {"bench": "static.prop.bench01", "bin": "static.prop.bin", "mailbox": "static.prop.mailbox"}
"""The prop that stands for each kind of furniture."""


def buildings(parts: PatchFrames, half_m: F64, building: NDArray[np.intp], objects: I32) -> Mesh:
    """Return buildings of upright boxes: walls with rows of windows, and flat roofs.

    ``parts`` stand at the feet of the boxes. ``half_m`` (N, 3) are their half sizes. ``building`` (N,) is the number of
    each box's building.
    """
    centre = half_m * (0.0, 0.0, 1.0)
    colour = _WALLS[building % len(_WALLS)].astype(np.uint8)
    walls = PatchLook(Material.BRICK, SemanticTag.BUILDINGS, colour, objects)
    roof = PatchLook(Material.SHINGLES, SemanticTag.BUILDINGS, _ROOF, objects)
    made = [boxes(parts, centre, half_m, walls, WALLS), boxes(parts, centre, half_m, roof, ("top",))]
    made += _windows(parts, half_m, objects)
    return join(made)


def _windows(parts: PatchFrames, half_m: F64, objects: I32) -> list[Mesh]:
    """Return a row of windows on each side of each storey."""
    pane = PatchLook(Material.GLASS, SemanticTag.BUILDINGS, _PANE, objects, LampOf.WINDOW)
    storeys = np.clip(2.0 * half_m[:, 2] // _STOREY_M, 1, _MOST_STOREYS).astype(int)
    made = []
    for storey in range(int(storeys.max(initial=0))):
        rows = np.flatnonzero((storeys > storey) & (2.0 * half_m[:, 2] > _SILL_M + _PANE_M + 0.2))
        up = storey * _STOREY_M + _SILL_M + 0.5 * _PANE_M
        for along, across in ((0, 1), (1, 0)):
            half = np.empty((len(rows), 3))
            half[:, along] = _MARGIN * half_m[rows, along]
            half[:, across] = half_m[rows, across] + _PROUD_M
            half[:, 2] = 0.5 * _PANE_M
            sides = ("left", "right") if along == 0 else ("ahead", "behind")
            made.append(boxes(parts.of(rows), (0.0, 0.0, up), half, pane.of(rows), sides))
    return made


def furniture(kind: str, frames: PatchFrames, half_m: F64, objects: I32) -> Mesh:
    """Return benches, bins or mailboxes that fill boxes of these half sizes (N, 3)."""
    models = actor_meshes()
    [part] = models.all_parts[_FURNITURE[kind], ""]
    model = models.meshes[part.mesh]
    low, high = model.vertices_m.min(0), model.vertices_m.max(0)
    foot = 0.5 * (low + high) * (1.0, 1.0, 0.0) + low * (0.0, 0.0, 1.0)
    shares = (model.vertices_m - foot) / (high - low)  # of the model's size
    placed = frames.world(2.0 * half_m[:, None] * shares).astype(np.float32)
    faces = np.tile(model.faces, (len(placed), 1))
    faces["object"], faces["tag"] = objects[:, None], SemanticTag.STATIC
    return join([Mesh(vertices_m, model.triangles, each) for vertices_m, each in zip(placed, faces, strict=True)])
