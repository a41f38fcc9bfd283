"""Meshes of posts: traffic lights, signs with letters, street lamps.

A letter is a skeleton of flat strokes on a field 4 wide and 6 tall, with a width for its lines. The faces of lights and
signs look along y of their objects, against the traffic that they control.
"""

import numpy as np
from numpy.typing import NDArray

from linden.maps.opendrive.roadside import SPEED_LIMIT_TYPE, STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.protocol.values.enums import SemanticTag
from linden.scenery.mesh import LampOf, Material, Mesh, join
from linden.scenery.patches import ALL_SIDES, PatchFrames, PatchLook, boxes, polygons, prisms
from linden.scenery.scene.neighbourhood import LAMP_ARM_HALF_M, LAMP_HALF_WIDTH_M, LAMP_HEIGHT_M
from linden.scenery.scene.posts import HEAD_HALF_M, PLATE_BOTTOM_M, PLATE_HALF_M, POST_HALF_WIDTH_M, POST_HEIGHT_M

F64 = NDArray[np.float64]

_BREADTH = 0.9
_ADVANCE = 5.2
_STROKES: dict[str, str] = {
    " ": "",
    "&": "40-04 04-06 06-26 26-24 24-01 01-00 00-20 20-42",
    "'": "26-24",
    "-": "13-33",
    ".": "20-21",
    "/": "00-46",
    "0": "00-40 40-46 46-06 06-00",
    "1": "20-26 26-15",
    "2": "06-46 46-43 43-03 03-00 00-40",
    "3": "06-46 46-40 40-00 03-43",
    "4": "06-03 03-43 46-40",
    "5": "46-06 06-03 03-43 43-40 40-00",
    "6": "46-06 06-00 00-40 40-43 43-03",
    "7": "06-46 46-10",
    "8": "00-40 40-46 46-06 06-00 03-43",
    "9": "43-03 03-06 06-46 46-40 40-00",
    "A": "00-26 26-40 12-32",
    "B": "00-06 06-36 36-45 45-44 44-33 33-03 33-42 42-41 41-30 30-00",
    "C": "45-36 36-16 16-05 05-01 01-10 10-30 30-41",
    "D": "00-06 06-36 36-45 45-41 41-30 30-00",
    "E": "00-06 06-46 03-33 00-40",
    "F": "00-06 06-46 03-33",
    "G": "45-36 36-16 16-05 05-01 01-10 10-30 30-41 41-43 43-23",
    "H": "00-06 40-46 03-43",
    "I": "20-26",
    "J": "46-41 41-30 30-10 10-01",
    "K": "00-06 46-03 03-40",
    "L": "06-00 00-40",
    "M": "00-06 06-23 23-46 46-40",
    "N": "00-06 06-40 40-46",
    "O": "10-30 30-41 41-45 45-36 36-16 16-05 05-01 01-10",
    "P": "00-06 06-46 46-43 43-03",
    "Q": "10-30 30-41 41-45 45-36 36-16 16-05 05-01 01-10 22-40",
    "R": "00-06 06-46 46-43 43-03 23-40",
    "S": "46-06 06-03 03-43 43-40 40-00",
    "T": "20-26 06-46",
    "U": "06-01 01-10 10-30 30-41 41-46",
    "V": "06-20 20-46",
    "W": "06-10 10-23 23-30 30-46",
    "X": "00-46 06-40",
    "Y": "06-23 46-23 23-20",
    "Z": "06-46 46-00 00-40",
}
"""Lines between points of the field, each named by its two coordinates."""
KNOWN_LETTERS = frozenset(_STROKES)


def letters(text: str, tall_m: float) -> list[F64]:
    """Return strokes (4, 2) of a line of text around its middle: x to the reader's right, y up, in m.

    Raises:
        KeyError: there is no such letter here.
    """
    unit = tall_m / (6.0 + _BREADTH)
    wide = _ADVANCE * (len(text) - 1) + 4.0
    found = []
    for nth, letter in enumerate(text):
        for line in _STROKES[letter].split():
            begin, end = (np.array([float(point[0]), float(point[1])]) for point in line.split("-"))
            along = (end - begin) / np.hypot(*(end - begin))
            side = np.array([-along[1], along[0]]) * 0.5 * _BREADTH
            begin, end = begin - 0.5 * _BREADTH * along, end + 0.5 * _BREADTH * along
            corners = np.stack([begin - side, end - side, end + side, begin + side])
            found.append((corners + np.array([_ADVANCE * nth - 0.5 * wide, -3.0])) * unit)
    return found


I32 = NDArray[np.int32]

_STEEL = (150, 154, 156)
_GALVANISED = (168, 170, 168)
_BLACK = (28, 30, 30)
_SIGN_RED = (170, 28, 34)
_SIGN_WHITE = (236, 236, 232)
_LENS_M = 0.1524  # 12 inches across, MUTCD 2009, section 4D.07
_LENSES = (
    (LampOf.TRAFFIC_RED, 0.345, (220, 36, 32)),
    (LampOf.TRAFFIC_YELLOW, 0.0, (240, 180, 32)),
    (LampOf.TRAFFIC_GREEN, -0.345, (36, 200, 110)),
)
_ROUND = 10
_FASTEST = 1000.0  # what has more digits is no limit, and would not fit
_PLATE_MIDDLE_M = PLATE_BOTTOM_M + PLATE_HALF_M[2]


def traffic_lights(frames: PatchFrames, poles: I32, heads: I32) -> Mesh:
    """Return traffic lights: a pole and a housing with its lenses, each under a visor; objects by part (N,)."""
    middle = POST_HEIGHT_M + HEAD_HALF_M[2]
    housing = PatchLook(Material.METAL, SemanticTag.TRAFFIC_LIGHT, _BLACK, heads)
    parts = [
        _upright(
            frames,
            POST_HALF_WIDTH_M,
            0.0,
            POST_HEIGHT_M,
            PatchLook(Material.METAL, SemanticTag.POLES, _GALVANISED, poles),
        ),
        boxes(
            frames, (0.0, -0.03, middle), (HEAD_HALF_M[0], HEAD_HALF_M[1] - 0.05, HEAD_HALF_M[2]), housing, ALL_SIDES
        ),
    ]
    face_y = HEAD_HALF_M[1] - 0.08
    for lamp, up, colour in _LENSES:
        look = PatchLook(Material.LAMP, SemanticTag.TRAFFIC_LIGHT, colour, heads, lamp)
        lens = _disc(_ROUND, _LENS_M) + np.array([0.0, face_y + 0.005, middle + up])
        parts.append(_facing(frames, lens, look))
        visor = _disc(_ROUND, _LENS_M + 0.012)[: _ROUND // 2 + 1] + np.array([0.0, face_y, middle + up])
        brim = visor + np.array([0.0, 0.07, 0.0])
        hood = np.stack([visor[:-1], visor[1:], brim[1:], brim[:-1]], axis=1)
        parts += [polygons(frames.world(quad), housing) for quad in hood]
    return join(parts)


def signs(frames: PatchFrames, kinds: list[tuple[str, float | None]], poles: I32, plates: I32) -> Mesh:
    """Return signs; ``kinds`` (N) are their OpenDRIVE type and value. What has no face of its own is a plain plate."""
    parts = [
        _upright(
            frames,
            POST_HALF_WIDTH_M * 0.7,
            0.0,
            PLATE_BOTTOM_M + 2.0 * PLATE_HALF_M[2] - 0.1,
            PatchLook(Material.METAL, SemanticTag.POLES, _STEEL, poles),
        )
    ]
    for kind, value in dict.fromkeys(kinds):
        rows = np.array([row for row, other in enumerate(kinds) if other == (kind, value)])
        parts.append(_plate(frames.of(rows), kind, value, plates[rows]))
    return join(parts)


def _plate(frames: PatchFrames, kind: str, value: float | None, objects: I32) -> Mesh:
    """Return the plates of one kind of sign."""
    half = PLATE_HALF_M[0]
    if kind == STOP_SIGN_TYPE:
        outer = _regular(8, half / np.cos(np.pi / 8.0), np.pi / 8.0)
        return _layers(
            frames, objects, [(outer, _SIGN_WHITE), (0.94 * outer, _SIGN_RED)], [("STOP", 0.2, 0.0, _SIGN_WHITE)]
        )
    if kind == YIELD_SIGN_TYPE:
        outer = np.array([(-half, 0.0, half * 0.85), (half, 0.0, half * 0.85), (0.0, 0.0, -half)])
        inner = (outer - outer.mean(axis=0)) * 0.52 + outer.mean(axis=0)
        return _layers(frames, objects, [(outer, _SIGN_RED), (inner, _SIGN_WHITE)], [("YIELD", 0.07, 0.12, _SIGN_RED)])
    outer = np.array([(-0.8, 0.0, -1.0), (0.8, 0.0, -1.0), (0.8, 0.0, 1.0), (-0.8, 0.0, 1.0)]) * half
    shows_speed = kind == SPEED_LIMIT_TYPE and value is not None and 0.0 <= value < _FASTEST
    text = [("SPEED", 0.1, 0.24, _BLACK), ("LIMIT", 0.1, 0.1, _BLACK), (str(round(value or 0.0)), 0.3, -0.17, _BLACK)]
    return _layers(frames, objects, [(outer, _BLACK), (0.94 * outer, _SIGN_WHITE)], text if shows_speed else [])


def _layers(
    frames: PatchFrames,
    objects: I32,
    sheets: list[tuple[F64, tuple[int, int, int]]],
    text: list[tuple[str, float, float, tuple[int, int, int]]],
) -> Mesh:
    """Return sheets, each 2 mm in front of the one before, a back of bare metal, and what is written in front."""
    tag = SemanticTag.TRAFFIC_SIGNS
    at = np.array([0.0, 0.0, _PLATE_MIDDLE_M])
    back = PatchLook(Material.METAL, tag, _STEEL, objects)
    front = frames.turned(np.broadcast_to(np.array([0.0, 1.0, 0.0]), (len(frames), 1, 3)))[:, 0]
    depth = POST_HALF_WIDTH_M
    parts = [polygons(frames.world(sheets[0][0] + at + (0.0, depth - 0.004, 0.0)), back, -front)]
    for nth, (corners, colour) in enumerate(sheets):
        look = PatchLook(Material.SIGN_FACE, tag, colour, objects)
        parts.append(polygons(frames.world(corners + at + (0.0, depth + 0.002 * nth, 0.0)), look, front))
    for words, tall, up, colour in text:
        strokes = letters(words, tall)  # (K, 4, 2), read from the front: x to the reader's right
        look = PatchLook(Material.SIGN_FACE, tag, colour, objects)
        for stroke in strokes:
            # y points south: seen against it, at the face, x is on the right
            corners = np.column_stack(
                [stroke[:, 0], np.full(len(stroke), depth + 0.002 * len(sheets)), stroke[:, 1] + up]
            )
            parts.append(polygons(frames.world(corners + at), look, front))
    return join(parts)


def street_lamps(frames: PatchFrames, poles: I32, arms: I32) -> Mesh:
    """Return street lamps: a tapering pole, an arm towards the street (against x), a lantern that shines downwards."""
    steel = PatchLook(Material.METAL, SemanticTag.POLES, _GALVANISED, poles)
    arm = steel._replace(object=arms)
    reach = 2.0 * LAMP_ARM_HALF_M[0]
    top = frames.world(np.broadcast_to(np.array([0.0, 0.0, LAMP_HEIGHT_M - 0.15]), (len(frames), 1, 3)))[:, 0]
    end = frames.world(np.broadcast_to(np.array([-reach + 0.5, 0.0, LAMP_HEIGHT_M]), (len(frames), 1, 3)))[:, 0]
    lantern = (-reach + 0.3, 0.0, LAMP_HEIGHT_M)
    glass = np.array([(x, y, 0.0) for x, y in ((-0.24, -0.1), (0.24, -0.1), (0.24, 0.1), (-0.24, 0.1))])
    shining = PatchLook(Material.LAMP, SemanticTag.POLES, (255, 236, 200), arms, LampOf.STREET)
    return join(
        [
            prisms(
                frames.base_m - (0.0, 0.0, 0.2), top, (LAMP_HALF_WIDTH_M, 0.6 * LAMP_HALF_WIDTH_M), 4, steel, lid=False
            ),
            prisms(top, end, (0.04, 0.03), 3, arm, lid=False),
            boxes(frames, lantern, (0.3, 0.12, 0.07), arm),
            polygons(frames.world(glass + lantern - (0.0, 0.0, 0.075)), shining, (0.0, 0.0, -1.0)),
        ]
    )


def _upright(frames: PatchFrames, radius_m: float, low_m: float, high_m: float, look: PatchLook) -> Mesh:
    up = np.array([0.0, 0.0, 1.0])
    return prisms(frames.base_m + (low_m - 0.2) * up, frames.base_m + high_m * up, (radius_m, radius_m), 6, look)


def _regular(sides: int, radius: float, first_rad: float) -> F64:
    """Return a regular polygon (sides, 3) in the plane of a face, y being 0."""
    angles = first_rad + np.arange(sides) * (2.0 * np.pi / sides)
    return np.stack([radius * np.cos(angles), np.zeros(sides), radius * np.sin(angles)], axis=1)


def _disc(sides: int, radius: float) -> F64:
    return _regular(sides, radius, 0.0)


def _facing(frames: PatchFrames, corners: F64, look: PatchLook) -> Mesh:
    front = frames.turned(np.broadcast_to(np.array([0.0, 1.0, 0.0]), (len(frames), 1, 3)))[:, 0]
    return polygons(frames.world(corners), look, front)
