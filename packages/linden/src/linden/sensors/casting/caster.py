"""Abstract `Caster` (nearest hit, occlusion, poses of bodies) and its data types: `Rays`, `Instances`, `Hits`."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from linden.scenery.mesh import Mesh

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]

CPU = "cpu"
"""``Caster.device`` of casters without a GPU."""

STATIC = -1
"""``Hits.instance`` of what stands."""
NOTHING = -2
"""``Hits.instance`` of a ray that meets nothing."""

INNER_SIDES = 16
"""How many inner sides of bodies a ray goes out through where a caster has to send it again behind each: those of the
car it starts in, its seats, a rider."""
ON_M = np.float32(1e-3)
"""How far behind an inner side it goes on."""


class Rays(NamedTuple):
    """Rays in the world, m; directions of length 1, so that distances are metres."""

    origin_m: F32  # (N, 3)
    direction: F32  # (N, 3)


class Instances(NamedTuple):
    """The bodies that move, a row each; an actor may have several (a walker's legs)."""

    mesh: I32  # (K,) number of the mesh among those the caster was made with
    pose: F32  # (K, 3, 4) from the mesh's frame to the world, m
    before: F32  # (K, 3, 4) the same one frame earlier
    actor_id: NDArray[np.uint32]  # (K,)
    colour: NDArray[np.uint8]  # (K, 3) sRGB, for faces that are painted
    lights: NDArray[np.uint32]  # (K,) LampOf bits that shine: 1 << LampOf
    velocity_mps: F32  # (K, 3) in the world, of the body's origin
    turning_radps: F32  # (K, 3) angular velocity in the world


class Hits(NamedTuple):
    """The nearest surface along each ray."""

    distance_m: F32  # (N,) infinite where there is none
    instance: I32  # (N,) row of Instances, STATIC or NOTHING
    triangle: I32  # (N,) row of that mesh's triangles, -1 where there is none
    normal: F32  # (N, 3) of the triangle, in the world, length 1, pointing outwards


class Caster(Protocol):
    """Answers rays; made with what stands and the meshes that bodies may have."""

    device: str  # CPU, or a GPU as Warp names it

    def __init__(self, standing: Mesh, bodies: list[Mesh]) -> None:
        """Build the search structures."""
        ...

    def pose(self, instances: Instances) -> None:
        """Move the bodies to their present poses; other bodies are hidden."""
        ...

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        """Return the nearest surface of each ray; faces count from either side.

        Args:
            rays: as many as there are.
            farthest_m: nothing is met beyond.
            coherent: whether neighbours go side by side, as a camera's; changes no answer, only how fast it comes.
            outer: whether rays go out through the inner sides of bodies, as if those were not there. A sensor
                inside a car then sees out of it, as in Unreal, which draws one side of a face.
        """
        ...

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False) -> NDArray[np.bool_]:
        """Return (N,) whether anything is met at all, whichever its side."""
        ...
