"""Triangles with what is known of each: a material, a semantic tag, a colour and the object it belongs to."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.structured import StructuredArray

F32 = NDArray[np.float32]
U32 = NDArray[np.uint32]

NO_OBJECT = -1


class Material(IntEnum):
    """What a surface is made of, as light meets it; each has a pattern and a gloss of its own in ``sensors.camera``."""

    PLAIN = 0
    ASPHALT = 1
    CONCRETE = 2
    PAINT = 3  # of lines and arrows on the road
    GRASS = 4
    LEAVES = 5
    BARK = 6
    BRICK = 7
    SIDING = 8  # painted boards
    SHINGLES = 9
    GLASS = 10
    CAR_PAINT = 11
    RUBBER = 12
    METAL = 13
    CLOTH = 14
    SKIN = 15
    GRAVEL = 16
    WOOD = 17
    SIGN_FACE = 18  # retro-reflecting sheet
    LAMP = 19  # shines by itself where its light is on: see ``LampOf``


class LampOf(IntEnum):
    """Which light a face of material LAMP is; it is kept in the face's ``lamp``."""

    NONE = 0
    STREET = 1
    TRAFFIC_RED = 2
    TRAFFIC_YELLOW = 3
    TRAFFIC_GREEN = 4
    HEAD = 5
    TAIL = 6  # position light and brake light
    BLINKER_LEFT = 7
    BLINKER_RIGHT = 8
    REVERSE = 9
    WINDOW = 10  # of a house, at night
    BRAKE = 11  # shines while braking alone: the third light, in the rear window
    BEACON = 12  # of police cars, ambulances and fire trucks: VehicleLightState.Special1


FACE = np.dtype(
    [
        ("material", "u1"),  # of Material
        ("tag", "u1"),  # of values.enums.SemanticTag
        ("lamp", "u1"),  # of LampOf
        ("painted", "?"),  # its colour is the actor's own, not the one given here
        ("colour", "u1", 3),  # red, green, blue, sRGB
        ("object", "i4"),  # row of the scene's boxes (scene.objects.BOX), NO_OBJECT for streets and actors
    ]
)


class Mesh(NamedTuple):
    """Triangles of one body, in its own frame or in the world: CARLA's axes, metres."""

    vertices_m: F32  # (V, 3)
    triangles: U32  # (T, 3) rows of vertices; (b - a) x (c - a), reckoned as for right-handed axes, points outwards
    faces: StructuredArray  # (T,) of FACE


def faces(count: int, material: Material, tag: int, colour: tuple[int, int, int]) -> StructuredArray:
    """Return ``count`` faces of one kind that belong to no object."""
    made = np.zeros(count, FACE)
    made["material"], made["tag"], made["colour"], made["object"] = material, tag, colour, NO_OBJECT
    return made


def join(meshes: "list[Mesh]") -> Mesh:
    """Return one mesh of several, in their order."""
    before = np.cumsum([0, *(len(mesh.vertices_m) for mesh in meshes)])[:-1]
    return Mesh(
        np.concatenate([np.zeros((0, 3), np.float32), *(mesh.vertices_m for mesh in meshes)]),
        np.concatenate(
            [
                np.zeros((0, 3), np.uint32),
                *(mesh.triangles + np.uint32(start) for mesh, start in zip(meshes, before, strict=True)),
            ]
        ),
        _as_bytes(meshes).view(FACE),
    )


def _as_bytes(meshes: "list[Mesh]") -> NDArray[np.uint8]:
    """Return the bytes of all meshes' faces, concatenated; numpy would compare the types of records each time."""
    return np.concatenate(
        [np.zeros(0, np.uint8), *(np.ascontiguousarray(mesh.faces).view(np.uint8) for mesh in meshes)]
    )
