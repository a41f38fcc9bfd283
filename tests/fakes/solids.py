"""Meshes of plain shapes, and bodies made of them, for tests of what is seen."""

import numpy as np

from linden.blueprints.library import BlueprintLibrary
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.episode import CLEAR_NOON
from linden.protocol.values.space import Transform
from linden.scenery.mesh import NO_OBJECT, Material, Mesh, faces
from linden.sensors.casting.caster import Instances
from linden.sensors.casting.choose import caster_of
from linden.sensors.view import Seen, SensorLook, table_of

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
_SIDES = [
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
]  # fmt: skip


def box(half_m: tuple[float, float, float], *, centre_m=(0.0, 0.0, 0.0), tag: int = 3, thing: int = NO_OBJECT) -> Mesh:
    """A box, its sides looking outwards."""
    surface = faces(len(_SIDES), Material.PLAIN, tag, (200, 10, 10))
    surface["object"] = thing
    corners = _CORNERS * np.array(half_m, np.float32) + np.array(centre_m, np.float32)
    return Mesh(corners.astype(np.float32), np.array(_SIDES, np.uint32), surface)


def floor(half_m: float = 200.0, *, tag: int = 1) -> Mesh:
    """A square at z = 0 that looks up."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) * np.float32(half_m)
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), faces(2, Material.ASPHALT, tag, (90, 90, 90)))


def instances(*placed: tuple[int, int, np.ndarray], velocity=(0.0, 0.0, 0.0), turning=(0.0, 0.0, 0.0)) -> Instances:
    """Bodies as (mesh, actor id, pose (3, 4)), all of them moving alike."""
    count = len(placed)
    pose = np.array([where for _, _, where in placed], np.float32).reshape(-1, 3, 4)
    return Instances(
        np.array([mesh for mesh, _, _ in placed], np.int32),
        pose,
        pose,
        np.array([actor for _, actor, _ in placed], np.uint32),
        np.zeros((count, 3), np.uint8),
        np.zeros(count, np.uint32),
        np.tile(np.float32(velocity), (count, 1)),
        np.tile(np.float32(turning), (count, 1)),
    )


def at(x: float, y: float, z: float, turn: np.ndarray | None = None) -> np.ndarray:
    """The pose (3, 4) of a body there."""
    return np.column_stack([np.eye(3) if turn is None else turn, [x, y, z]])


def seen_of(standing: Mesh, bodies: list[Mesh], moving: Instances, *, object_id: tuple[int, ...] = ()) -> Seen:
    """A moment in a world of these meshes."""
    caster = caster_of(standing, bodies)
    caster.pose(moving)
    objects = len(object_id)
    return Seen(
        caster,
        standing,
        bodies,
        table_of(standing, bodies),
        moving,
        np.array(object_id, np.uint32),
        np.zeros(objects, np.uint32),
        np.zeros((objects, 3), np.uint8),
        CLEAR_NOON,
        0.0,
    )


def look_at(seen: Seen, pose: Transform, *, number: int = 0, interval_s: float = 0.1, **known) -> SensorLook:
    """One frame of a sensor at a pose, at rest and on its own unless told otherwise."""
    known = {"velocity_mps": np.zeros(3), "carrier_id": 0, **known}
    return SensorLook(seen, {}, pose, pose, number=number, interval_s=interval_s, **known)


def described(blueprint_id: str, **chosen: object) -> ActorDescription:
    """A complete description of what the library has, with some attributes chosen."""
    library = BlueprintLibrary.load()
    values = tuple(AttributeValue(name, 0, str(value)) for name, value in chosen.items())
    types = {item.id: item.type for item in library.find(blueprint_id).definition.attributes}
    values = tuple(value._replace(type=types[value.id]) for value in values)
    return library.validate(ActorDescription(0, blueprint_id, values))


def volume_m3(mesh: Mesh) -> float:
    """The volume that a closed mesh encloses (Gauss); positive where its triangles look outwards."""
    a, b, c = (mesh.vertices_m[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)
