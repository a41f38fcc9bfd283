"""The caster where Embree cannot be called from compiled code: embreex's own call, a fifth as fast.

It knows no instances, so the triangles of all bodies are put into the world anew each time they are posed.
"""

from typing import Any

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import CPU, F32, INNER_SIDES, NOTHING, ON_M, STATIC, Hits, Instances, Rays


class EmbreexCaster:
    """Answers rays by embreex; see ``linden.sensors.casting.caster.Caster``."""

    device = CPU

    def __init__(self, standing: Mesh, bodies: list[Mesh]) -> None:
        """Build the tree of what stands."""
        self._bodies = bodies
        self._standing = EmbreeScene()
        _add(self._standing, standing.vertices_m, standing)
        self._moving = EmbreeScene()

    def pose(self, instances: Instances) -> None:
        """Move the bodies to their present poses; other bodies are hidden."""
        self._moving = EmbreeScene()
        for number, pose in zip(instances.mesh.tolist(), instances.pose, strict=True):
            mesh = self._bodies[number]
            _add(self._moving, mesh.vertices_m @ pose[:, :3].T + pose[:, 3], mesh)

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        """Return the nearest surface of each ray."""
        del coherent  # embreex has one way
        hits = self._nearest(rays, farthest_m)
        for _ in range(INNER_SIDES if outer else 0):
            along = np.einsum("ij,ij->i", rays.direction, hits.normal)
            if not len(inner := np.flatnonzero((hits.instance >= 0) & (along > 0.0))):
                break
            passed_m = hits.distance_m[inner] + ON_M
            origin = rays.origin_m[inner] + rays.direction[inner] * passed_m[:, None]
            beyond = self._nearest(Rays(origin, rays.direction[inner]), farthest_m)
            beyond = beyond._replace(distance_m=beyond.distance_m + passed_m)
            for column, found in zip(hits, beyond, strict=True):
                column[inner] = found
        too_far = hits.distance_m > farthest_m
        hits.distance_m[too_far], hits.instance[too_far], hits.triangle[too_far] = np.inf, NOTHING, -1
        hits.normal[too_far] = 0.0
        return hits

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False) -> NDArray[np.bool_]:
        """Return (N,) whether anything is met at all, whichever its side."""
        blocked: NDArray[np.bool_] = self.closest(rays, farthest_m, coherent=coherent).instance != NOTHING
        return blocked

    def _nearest(self, rays: Rays, farthest_m: float) -> Hits:
        standing, moving = _run(self._standing, rays, farthest_m), _run(self._moving, rays, farthest_m)
        moves = moving["tfar"] < standing["tfar"]
        found = {name: np.where(moves, moving[name], standing[name]) for name in ("tfar", "primID", "geomID")}
        normal = np.where(moves[:, None], moving["Ng"], standing["Ng"])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        nothing = found["geomID"] == -1
        return Hits(
            np.where(nothing, np.inf, found["tfar"]).astype(np.float32),
            np.where(nothing, NOTHING, np.where(moves, moving["geomID"], STATIC)).astype(np.int32),
            np.where(nothing, -1, found["primID"]).astype(np.int32),
            np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0),
        )


def _add(scene: EmbreeScene, vertices_m: F32, mesh: Mesh) -> None:
    TriangleMesh(scene, np.ascontiguousarray(vertices_m, np.float32), mesh.triangles.astype(np.int32))


def _run(scene: EmbreeScene, rays: Rays, farthest_m: float) -> dict[str, NDArray[Any]]:
    """Return embreex's columns; geomID is -1 where nothing is met."""
    count = len(rays.origin_m)
    found: dict[str, NDArray[Any]] = scene.run(
        np.ascontiguousarray(rays.origin_m, np.float32),
        np.ascontiguousarray(rays.direction, np.float32),
        dists=np.full(count, farthest_m, np.float32),
        output=1,
    )
    return found
