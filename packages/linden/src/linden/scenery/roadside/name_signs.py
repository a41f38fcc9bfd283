"""Meshes of street-name signs: a post, and on it blades with the name of a street on both faces.

Names are written in capitals, white on green (Manual on Uniform Traffic Control Devices, section 2D.43).
"""

import unicodedata

import numpy as np
from numpy.typing import NDArray

from linden.maps.records import BLADE_LETTER_M
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import Material, Mesh, join
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes, polygons, prisms
from linden.scenery.roadside.signal_posts import KNOWN_LETTERS, letters

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

_STEEL, _GREEN, _WHITE = (130, 134, 136), (0, 107, 84), (236, 236, 232)
_PROUD_M = 0.002  # of the blade


def posts(frames: PatchFrames, half_m: F64, objects: I32) -> Mesh:
    """Return round posts that fill boxes of these half sizes (N, 3), rooted in the ground."""
    top = frames.base_m + np.array([0.0, 0.0, 2.0]) * half_m
    steel = PatchLook(Material.METAL, SemanticTag.POLES, _STEEL, objects)
    return prisms(frames.base_m - (0.0, 0.0, 0.2), top, (half_m[:, 0], half_m[:, 0]), 6, steel)


def blades_with_names(blades: PatchFrames, half_m: F64, objects: I32, names: list[str]) -> Mesh:
    """Return blades of half sizes (N, 3) about their frames, each with its name on both faces."""
    sheet = PatchLook(Material.SIGN_FACE, SemanticTag.TRAFFIC_SIGNS, _GREEN, objects)
    parts = [boxes(blades, (0.0, 0.0, 0.0), half_m, sheet, ALL_SIDES)]
    for row, name in enumerate(names):
        strokes = letters(capitals(name), BLADE_LETTER_M)  # read from the front, x to the reader's right
        if not strokes:
            continue
        look = PatchLook(Material.SIGN_FACE, SemanticTag.TRAFFIC_SIGNS, _WHITE, objects[row])
        for side in (1.0, -1.0):  # y points to the right of x: a reader there looks against it and has x on the right
            face = np.array([(side * x, side * (half_m[row, 1] + _PROUD_M), up) for x, up in np.concatenate(strokes)])
            corners = blades.of(np.array([row])).world(face[None])[0].reshape(-1, 4, 3)
            front = blades.of(np.array([row])).turned(np.array([[[0.0, side, 0.0]]]))[0, 0]
            parts.append(polygons(corners, look, front))
    return join(parts)


def capitals(name: str) -> str:
    """Return a name in capitals without accents; a letter that cannot be drawn becomes a gap."""
    plain = unicodedata.normalize("NFKD", name).upper()
    kept = [letter for letter in plain if not unicodedata.combining(letter)]
    return "".join(letter if letter in KNOWN_LETTERS else " " for letter in kept)
