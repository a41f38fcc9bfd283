"""The input of a ray-casting sensor: the scene at one moment, and the pose of the sensor.

``Seen`` holds the faces of all meshes in one table and their poses. ``Look`` adds the pose of one sensor.
"""

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.episode import WeatherParameters
from linden.protocol.values.space import Transform
from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import Caster, Instances

if TYPE_CHECKING:
    from linden.sensors.camera.strokes import Strokes

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]

STREETS = 0
"""What cameras and lidars call the object of a face that belongs to none."""

NO_ACTOR_FROM = 0x8000_0000
"""``Seen.object_id`` from here on are no actors'."""


class Faces(NamedTuple):
    """Columns of the faces (F,) of what stands and then of each body's mesh, in the order of their numbers.

    The face of a hit is ``first[instance's place] + triangle``; see :func:`first_of_places`.
    """

    tag: U8
    material: U8
    lamp: U8
    painted: NDArray[np.bool_]
    colour: F32  # (F, 3), linear light, 0 to 1
    object: NDArray[np.int32]  # row of the scene's boxes, or NO_OBJECT
    first: I64  # (1 + number of bodies' meshes,) where each mesh begins; what stands is the first


class Seen(NamedTuple):
    """One moment of a world as it is seen. Made once a frame, for all sensors that look."""

    caster: Caster  # with the bodies posed
    standing: Mesh
    bodies: Sequence[Mesh]
    faces: Faces
    instances: Instances
    object_id: NDArray[np.uint32]  # (O,) of each of the scene's boxes: its actor's id, or a number above all actors'
    object_lights: NDArray[np.uint32]  # (O,) LampOf bits that shine: 1 << LampOf
    object_light_colour: U8  # (O, 3) sRGB of what a street lamp shines with
    weather: WeatherParameters
    now_s: float  # since the episode began


def table_of(standing: Mesh, bodies: Sequence[Mesh]) -> Faces:
    """Return the faces of all meshes as columns."""
    meshes = (standing, *bodies)
    faces = np.concatenate([mesh.faces for mesh in meshes])
    return Faces(
        np.ascontiguousarray(faces["tag"]),
        np.ascontiguousarray(faces["material"]),
        np.ascontiguousarray(faces["lamp"]),
        np.ascontiguousarray(faces["painted"]),
        LINEAR[faces["colour"]],
        np.ascontiguousarray(faces["object"]),
        np.cumsum([0, *(len(mesh.faces) for mesh in meshes)])[:-1].astype(np.int64),
    )


def first_of_places(faces: Faces, instances: Instances) -> I64:
    """Return (1 + K,) the first face of what stands, then of each instance: entry ``instance + 1`` belongs to a hit."""
    return np.concatenate([faces.first[:1], faces.first[1 + instances.mesh]])


def id_of_places(instances: Instances) -> NDArray[np.uint32]:
    """Return (1 + K,) the actor of each place, in the order of :func:`first_of_places`; 0 for what stands."""
    return np.concatenate([np.zeros(1, np.uint32), instances.actor_id])


def actor_of_objects(seen: Seen) -> NDArray[np.uint32]:
    """Return (O + 1,) the actor of each object, 0 where it is none; the last is for NO_OBJECT."""
    actors = np.append(seen.object_id, np.uint32(0))
    actors[actors >= NO_ACTOR_FROM] = 0
    return actors


def _linear() -> F32:
    """Return the light of each of sRGB's 256 steps (IEC 61966-2-1)."""
    encoded = np.arange(256) / 255.0
    light = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return light.astype(np.float32)


LINEAR = _linear()
"""Linear light of an sRGB byte, 0 to 1."""


F64 = NDArray[np.float64]


class SensorLook(NamedTuple):
    """One sensor in one frame."""

    seen: Seen
    shared: dict[Hashable, object]
    """What sensors of this frame have found already and others may want too, under keys of their own making."""
    pose: Transform
    """Of the sensor, in the world."""
    before: Transform
    """Where it was one frame earlier; the same place in its first frame."""
    velocity_mps: F64
    """(3,) of the sensor's place, in the world, as its carrier moves it."""
    carrier_id: int
    """The actor it is attached to, 0 where there is none."""
    number: int
    """Of the measurement, counted from the sensor's first, which is 0."""
    interval_s: float
    """Time since the last measurement; that of the frame for the first."""
    strokes: "Callable[[frozenset[int]], Strokes] | None" = None
    """Returns what a camera of lines draws without the actors given; None where there is no episode."""


class LookingSensor(Protocol):
    """A sensor over time."""

    def measure(self, look: SensorLook) -> object | None:
        """Return a reading, None where there is nothing to tell."""
        ...

    def skip(self, interval_s: float) -> None:
        """Skip a measurement without subscribers; later readings must be the same as after a measurement."""
        ...


@runtime_checkable
class AsynchronousSensor(Protocol):
    """A sensor with asynchronous measurements: those of a frame all begin before the first is read."""

    def expect(self, look: SensorLook) -> None:
        """Begin the measurement that ``measure`` returns for the same look."""
        ...
