"""People: on foot with a mesh for each bone, or as one figure that sits on a saddle or in a chair."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import Blueprint
from linden.geometry import rotation_matrix
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Rotation
from linden.scenery.actors.posing import WALKER_FRAMES
from linden.scenery.mesh import Mesh, join
from linden_maps.models import limbs
from linden_maps.models.limbs import Build, Colour
from linden_maps.models.solids import Shape, moved, tagged, turned

F64 = NDArray[np.float64]

_SHIRTS: tuple[Colour, ...] = (
    (176, 58, 46), (44, 82, 140), (230, 226, 214), (58, 110, 74), (208, 160, 52), (62, 62, 66), (120, 70, 120),
    (90, 150, 170), (214, 120, 80), (150, 150, 148), (30, 46, 78),
)  # fmt: skip
_TROUSERS: tuple[Colour, ...] = (
    (46, 58, 90), (40, 40, 42), (96, 84, 66), (70, 78, 92), (130, 122, 104), (58, 46, 40), (34, 44, 60),
)  # fmt: skip
_SKINS: tuple[Colour, ...] = ((226, 184, 156), (198, 146, 112), (146, 98, 70), (96, 64, 48), (214, 168, 136))
_HAIR: tuple[Colour, ...] = ((44, 32, 26), (92, 62, 40), (164, 126, 76), (24, 22, 22), (130, 126, 122), (120, 58, 34))
_SHOES: tuple[Colour, ...] = ((36, 32, 32), (206, 204, 200), (92, 62, 44))

_APART = {"crl_arm": 0.129, "crl_foreArm": 0.129, "crl_thigh": 0.0955, "crl_leg": 0.0955, "crl_foot": 0.0955}
"""How far a joint is from the middle, in statures, as in data/skeleton.json."""

_CHILD_M = 1.4
"""Below this stature, heads are large for the body."""


class Outfit(NamedTuple):
    """A body and what it wears."""

    build: Build
    shirt: Colour
    trousers: Colour


def outfit(number: int, stature_m: float, *, female: bool, helmet: Colour | None = None) -> Outfit:
    """Return what the person of a number looks like; numbers next to each other look different."""
    skin = _SKINS[number * 2 % len(_SKINS)]
    skirt = female and number % 3 == 0 and helmet is None
    build = Build(
        stature_m=stature_m,
        female=female,
        child=stature_m < _CHILD_M,
        skin=skin,
        hair=_HAIR[number * 5 % len(_HAIR)],
        shoes=_SHOES[number % len(_SHOES)],
        bare_legs=skin if skirt else None,
        long_sleeves=number % 2 == 0,
        helmet=helmet,
    )
    return Outfit(build, _SHIRTS[number * 4 % len(_SHIRTS)], _TROUSERS[number * 3 % len(_TROUSERS)])


def walker(blueprint: Blueprint) -> list[Shape]:
    """Return the parts of someone on foot."""
    return [Shape(mesh, WALKER_FRAMES.index(bone), colour) for bone, mesh, colour in _parts(_outfit_of(blueprint))]


def in_wheelchair(blueprint: Blueprint, chair: Mesh) -> list[Shape]:
    """Return a person in a wheelchair as one part; the chair stands on the ground around the origin."""
    outfit = _outfit_of(blueprint)
    half_m = blueprint.box.extent.z
    seated = figure(outfit, hips_m=(-0.08, 0.56), lean_deg=-6.0, hand_m=(0.26, 0.72), feet_m=((0.5, 0.2), (0.5, 0.2)))
    made = tagged(join([seated, chair]), SemanticTag.PEDESTRIANS)
    return [Shape(moved(made, (0.0, 0.0, -half_m)), 0)]


def _outfit_of(blueprint: Blueprint) -> Outfit:
    gender = next(attribute.value for attribute in blueprint.definition.attributes if attribute.id == "gender")
    number = int(blueprint.definition.id.rsplit(".", maxsplit=1)[1])
    return outfit(number, 2.0 * blueprint.box.extent.z, female=gender == "female")


def _parts(outfit: Outfit) -> list[tuple[str, Mesh, Colour]]:
    """Return bone, mesh and the colour of the clothes on it."""
    build = outfit.build
    parts = [
        ("crl_hips__C", limbs.hips(build), outfit.trousers),
        ("crl_spine01__C", limbs.chest(build), outfit.shirt),
        ("crl_Head__C", limbs.head(build), outfit.shirt),
    ]
    for side, sign in (("L", -1.0), ("R", 1.0)):
        parts += [
            (f"crl_arm__{side}", limbs.arm(build, sign), outfit.shirt),
            (f"crl_foreArm__{side}", limbs.forearm(build, sign), outfit.shirt),
            (f"crl_thigh__{side}", limbs.thigh(build, sign), outfit.trousers),
            (f"crl_leg__{side}", limbs.shin(build, sign), outfit.trousers),
            (f"crl_foot__{side}", limbs.foot(build, sign), outfit.trousers),
        ]
    return parts


def figure(
    outfit: Outfit,
    *,
    hips_m: tuple[float, float],
    lean_deg: float,
    hand_m: tuple[float, float],
    feet_m: tuple[tuple[float, float], tuple[float, float]],
    hands_apart_m: float = 0.4,
) -> Mesh:
    """Return a person as one mesh in coloured clothes: hips at (x, z), leaning forward, limbs reaching.

    ``hand_m`` is where both hands are, ``feet_m`` where the left and the right ankle are, all (x, z).
    """
    size = outfit.build.stature_m
    hips = np.array(hips_m)
    up = np.array([math.sin(math.radians(lean_deg)), math.cos(math.radians(lean_deg))])
    spine, shoulder, crown = hips + 0.18 * size * up, hips + 0.288 * size * up, hips + 0.355 * size * up
    places = {
        "crl_hips__C": (hips, -0.5 * lean_deg),
        "crl_spine01__C": (spine, -lean_deg),
        "crl_Head__C": (crown, -0.2 * lean_deg),
    }
    for side, ankle in zip("LR", feet_m, strict=True):
        knee, thigh_deg, shin_deg = _reach(hips, np.array(ankle), 0.245 * size, 0.246 * size, knee=True)
        places |= {f"crl_thigh__{side}": (hips, thigh_deg), f"crl_leg__{side}": (knee, shin_deg)}
        places[f"crl_foot__{side}"] = (np.array(ankle), 0.0)
        elbow, arm_deg, lower_deg = _reach(shoulder, np.array(hand_m), 0.186 * size, 0.17 * size, knee=False)
        places |= {f"crl_arm__{side}": (shoulder, arm_deg), f"crl_foreArm__{side}": (elbow, lower_deg)}
    splay = 0.5 * hands_apart_m / size - _APART["crl_arm"] + limbs.ARMS_IN
    parts = [(bone, _splayed(dyed(mesh, colour), bone, splay, size)) for bone, mesh, colour in _parts(outfit)]
    return join([_placed(mesh, bone, *places[bone], size) for bone, mesh in parts])


def _splayed(mesh: Mesh, bone: str, splay: float, size: float) -> Mesh:
    """Return a limb of the arms slanted so that the hand is ``splay`` statures further out than the shoulder."""
    joint, side = bone.split("__")
    if joint not in ("crl_arm", "crl_foreArm"):
        return mesh
    outwards = splay * (1.0 if side == "R" else -1.0)
    share = np.clip(-mesh.vertices_m[:, 2] / (0.356 * size), 0.0, 1.0) + (
        0.186 / 0.356 if joint == "crl_foreArm" else 0.0
    )
    return mesh._replace(
        vertices_m=(mesh.vertices_m + np.outer(share * outwards * size, (0.0, 1.0, 0.0))).astype(np.float32)
    )


def _placed(mesh: Mesh, bone: str, at_m: F64, pitch_deg: float, size: float) -> Mesh:
    """Return a limb turned by its pitch and put where it is, at its bone's distance from the middle."""
    joint, side = bone.split("__")
    y = _APART.get(joint, 0.0) * size * {"L": -1.0, "R": 1.0, "C": 0.0}[side]
    return moved(turned(mesh, rotation_matrix(Rotation(pitch_deg, 0.0, 0.0))), (at_m[0], y, at_m[1]))


def _reach(
    start: F64,
    end: F64,
    upper_m: float,
    lower_m: float,
    *,
    knee: bool,
) -> tuple[F64, float, float]:
    """Return the joint (x, z) and the pitches, degrees, of two bones from ``start`` to ``end``, or as near as they get.

    A limb of pitch 0 hangs down, and nose up swings it forward. Knees bend forward, elbows back.
    """
    apart = end - start
    far_m = min(float(np.hypot(*apart)), 0.999 * (upper_m + lower_m))
    towards = math.atan2(apart[0], -apart[1])
    corner = math.acos(min(1.0, (upper_m**2 + far_m**2 - lower_m**2) / (2.0 * upper_m * far_m)))
    upper = towards + (corner if knee else -corner)
    joint = start + upper_m * np.array([math.sin(upper), -math.cos(upper)])
    rest = end - joint
    return joint, math.degrees(upper), math.degrees(math.atan2(rest[0], -rest[1]))


def dyed(mesh: Mesh, colour: Colour) -> Mesh:
    """Return the mesh with a colour of its own where it had that of its actor."""
    faces = mesh.faces.copy()
    faces["colour"][faces["painted"]] = colour
    faces["painted"] = False
    return mesh._replace(faces=faces)
