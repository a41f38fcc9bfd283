"""A mesh and the frame that it follows: what an actor is made of."""

from typing import NamedTuple

from linden.meshes.mesh import Mesh


class Shape(NamedTuple):
    """A part of an actor's body; ``frame`` is a row of ``posing.VEHICLE_FRAMES`` or ``posing.WALKER_FRAMES``."""

    mesh: Mesh
    frame: int
    colour: tuple[int, int, int] | None = None  # of faces that are painted; None leaves them the actor's own
