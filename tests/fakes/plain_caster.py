"""The obvious caster: every ray against every triangle, in double precision. Casters have to agree with it."""

import numpy as np

from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import CPU, NOTHING, STATIC, Hits, Instances, Rays


class PlainCaster:
    """See ``linden.sensors.casting.caster.Caster``."""

    device = CPU

    def __init__(self, standing: Mesh, bodies: list[Mesh]) -> None:
        self._standing, self._bodies = standing, bodies
        self._posed = [self._placed(STATIC, standing, np.eye(3, 4))]

    @staticmethod
    def _placed(row: int, mesh: Mesh, pose: np.ndarray) -> tuple[int, np.ndarray]:
        corners = mesh.vertices_m.astype(float) @ pose[:, :3].T.astype(float) + pose[:, 3]
        return row, corners[mesh.triangles]

    def pose(self, instances: Instances) -> None:
        self._posed = [self._placed(STATIC, self._standing, np.eye(3, 4))]
        for row, (number, pose) in enumerate(zip(instances.mesh.tolist(), instances.pose, strict=True)):
            self._posed.append(self._placed(row, self._bodies[number], pose))

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        count = len(rays.origin_m)
        best = Hits(
            np.full(count, np.inf, np.float32),
            np.full(count, NOTHING, np.int32),
            np.full(count, -1, np.int32),
            np.zeros((count, 3), np.float32),
        )
        for ray in range(count):
            origin, direction = rays.origin_m[ray].astype(float), rays.direction[ray].astype(float)
            for row, corners in self._posed:
                normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                at = meets(origin, direction, corners)
                if outer and row != STATIC:
                    at = np.where(normal @ direction > 0.0, np.inf, at)
                if len(at) and (nearest := int(np.argmin(at))) >= 0 and at[nearest] < best.distance_m[ray]:
                    if at[nearest] > farthest_m:
                        continue
                    best.distance_m[ray], best.instance[ray], best.triangle[ray] = at[nearest], row, nearest
                    best.normal[ray] = normal[nearest] / np.linalg.norm(normal[nearest])
        return best

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False) -> np.ndarray:
        return self.closest(rays, farthest_m).instance != NOTHING


def meets(origin: np.ndarray, direction: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return how far along a ray each triangle (T, 3, 3) is met, inf where it is not.

    Möller and Trumbore 1997, "Fast, Minimum Storage Ray-Triangle Intersection".
    """
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, second)
    scale = np.einsum("ij,ij->i", first, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = origin - corners[:, 0]
        u = np.einsum("ij,ij->i", apart, across) / scale
        turned = np.cross(apart, first)
        v = turned @ direction / scale
        at = np.einsum("ij,ij->i", second, turned) / scale
        return np.where((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (at >= 0.0), at, np.inf)
