"""GPU ray caster on NVIDIA Warp: the `Caster` interface, and ray queries on arrays that stay on the GPU (extra `gpu`).

What stands is one mesh. All bodies together are another; its corners are moved each tick and its tree is then
refitted, for Warp knows no instances. Of two surfaces at one distance what stands answers.
"""

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import Hits, Instances, Rays
from linden.sensors.casting.gpu_memory import Gpu

AGAIN = 200
"""Poses after which the tree of the bodies is built anew: refitted ever again, it would fit worse and worse."""

_SIDES = 16  # rays.INNER_SIDES
_TREE, _LEAF = "cubql", 1
"""How trees are built on a GPU: rays over Linden take less than half as long as by Warp's default."""
_THREADS = 64
"""Of a block: a few rays that graze the ground as far as the eye sees take longer than all others, and hold up less."""

wp.config.quiet = True
wp.config.enable_backward = False


@wp.kernel  # type: ignore[untyped-decorator]
def _place(
    local: wp.array(dtype=wp.vec3),  # type: ignore[valid-type] # Warp's types are values
    owner: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    pose: wp.array(dtype=wp.mat44),  # type: ignore[valid-type]
    points: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    points[i] = wp.transform_point(pose[owner[i]], local[i])


@wp.kernel  # type: ignore[untyped-decorator]
def _closest(
    standing: wp.uint64,
    moving: wp.uint64,
    owner: wp.array(dtype=wp.int32),  # type: ignore[valid-type] # of the triangles of the bodies
    first: wp.array(dtype=wp.int32),  # type: ignore[valid-type] # where the triangles of each instance begin
    origin: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    direction: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    asked: wp.array(dtype=wp.int32),  # type: ignore[valid-type] # (1,) how many rays there are
    far_m: float,
    inner_sides: int,
    distance: wp.array(dtype=float),  # type: ignore[valid-type]
    instance: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    triangle: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    normal: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    if i >= asked[0]:
        return
    o = origin[i]
    d = direction[i]
    distance[i] = wp.inf
    instance[i] = -2
    triangle[i] = -1
    normal[i] = wp.vec3(0.0, 0.0, 0.0)
    nearest = float(far_m)
    if standing != wp.uint64(0):
        hit = wp.mesh_query_ray(standing, o, d, far_m)
        if hit.result:
            nearest = hit.t
            distance[i] = hit.t
            instance[i] = -1
            triangle[i] = hit.face
            normal[i] = wp.mesh_eval_face_normal(standing, hit.face)
    if moving == wp.uint64(0):
        return
    passed = float(0.0)  # noqa: UP018 - so Warp knows a variable from a constant
    tries = int(0)  # noqa: UP018, RUF046 - likewise
    while tries <= inner_sides and passed < nearest:
        tries += 1
        met = wp.mesh_query_ray(moving, o + d * passed, d, nearest - passed)
        if not met.result:
            return
        side = wp.mesh_eval_face_normal(moving, met.face)
        if tries <= inner_sides and wp.dot(side, d) > 0.0:
            passed += met.t + 1.0e-3  # rays.ON_M
            continue
        body = owner[met.face]
        distance[i] = passed + met.t
        instance[i] = body
        triangle[i] = met.face - first[body]
        normal[i] = side
        return


@wp.kernel  # type: ignore[untyped-decorator]
def _blocked(
    standing: wp.uint64,
    moving: wp.uint64,
    origin: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    direction: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    far_m: float,
    hit: wp.array(dtype=wp.bool),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    met = False
    if standing != wp.uint64(0):
        met = wp.mesh_query_ray_anyhit(standing, origin[i], direction[i], far_m)
    if moving != wp.uint64(0) and not met:
        met = wp.mesh_query_ray_anyhit(moving, origin[i], direction[i], far_m)
    hit[i] = met


@wp.kernel  # type: ignore[untyped-decorator]
def _sunny(
    standing: wp.uint64,
    moving: wp.uint64,
    origin: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    direction: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    facing: wp.array(dtype=wp.bool),  # type: ignore[valid-type]
    asked: wp.array(dtype=wp.int32),  # type: ignore[valid-type] # (1,) how many rays there are
    far_m: float,
    sunny: wp.array(dtype=float),  # type: ignore[valid-type]
) -> None:
    i = wp.tid()
    if i >= asked[0]:
        return
    reached = facing[i]
    if reached and standing != wp.uint64(0):
        reached = not wp.mesh_query_ray_anyhit(standing, origin[i], direction[i], far_m)
    if reached and moving != wp.uint64(0):
        reached = not wp.mesh_query_ray_anyhit(moving, origin[i], direction[i], far_m)
    sunny[i] = wp.where(reached, 1.0, 0.0)


class DeviceRays(NamedTuple):
    """Rays on the device, in arrays of Warp's."""

    room: int
    rays: list[Any]  # origins and directions
    count: Any  # (1,) how many there are, at most ``room``


class WarpCaster:
    """Answers rays by Warp; see ``linden.sensors.casting.caster.Caster``.

    Attributes:
        bodies: the meshes that bodies may have.
        trees: how often a tree was built; work captured before another was built would ask one that is gone.
    """

    def __init__(self, standing: Mesh, bodies: list[Mesh], device: str = "cuda") -> None:
        """Build the tree of what stands, on a device of Warp's: "cuda", "cuda:1" or, slowly, "cpu"."""
        self.device = device
        self.bodies, self.trees = bodies, 0
        self._standing = self._tree(self._vectors(standing.vertices_m), standing.triangles)
        self._mesh: NDArray[np.int32] = np.zeros(0, np.int32)
        self._poses = 0
        self._assemble(self._mesh)

    @cached_property
    def gpu(self) -> Gpu:
        """The device, as kernels of numba's use it beside this caster; there is none where the device is CPU."""
        return Gpu(self.device)

    @property
    def standing_id(self) -> int:
        """Number by which a kernel asks the tree of what stands; 0 where nothing stands."""
        return 0 if self._standing is None else int(self._standing.id)

    def tree_of(self, mesh: Mesh) -> Any:  # noqa: ANN401 - Warp's
        """Return the tree of a mesh in its own frame, None where it has no triangles."""
        return self._tree(self._vectors(mesh.vertices_m), mesh.triangles)

    def _vectors(self, values: NDArray[Any]) -> Any:  # noqa: ANN401 - an array of Warp's
        return wp.array(np.ascontiguousarray(values, np.float32), dtype=wp.vec3, device=self.device)

    def _whole(self, values: NDArray[Any]) -> Any:  # noqa: ANN401 - an array of Warp's
        return wp.array(np.ascontiguousarray(values, np.int32), dtype=wp.int32, device=self.device)

    def _tree(self, points: Any, triangles: NDArray[np.uint32]) -> Any:  # noqa: ANN401 - Warp's
        """Return a mesh of Warp's, None where there are no triangles."""
        self.trees += 1
        if not len(triangles):
            return None
        kind = {"bvh_constructor": _TREE, "bvh_leaf_size": _LEAF} if wp.get_device(self.device).is_cuda else {}
        return wp.Mesh(points, self._whole(triangles.ravel()), **kind)

    def _assemble(self, mesh: NDArray[np.int32]) -> None:
        """Put the triangles of these bodies together, each about its own origin."""
        bodies = [self.bodies[number] for number in mesh.tolist()]
        corners = np.array([len(body.vertices_m) for body in bodies], np.int64)
        faces = np.array([len(body.triangles) for body in bodies], np.int64)
        before = np.concatenate([[0], np.cumsum(corners)]).astype(np.uint32)
        self._mesh = np.array(mesh, np.int32)
        self._local = self._vectors(np.concatenate([np.zeros((0, 3)), *(body.vertices_m for body in bodies)]))
        self._points = wp.zeros(int(corners.sum()), dtype=wp.vec3, device=self.device)
        self._triangles = np.concatenate(
            [np.zeros((0, 3), np.uint32), *(body.triangles + before[row] for row, body in enumerate(bodies))]
        )
        self._owner_of_point = self._whole(np.repeat(np.arange(len(bodies)), corners))
        self._owner = self._whole(np.repeat(np.arange(len(bodies)), faces))
        self._first = self._whole(np.concatenate([[0], np.cumsum(faces)])[:-1])
        self._moving: Any = None
        self._poses = 0
        self.trees += 1  # there is one less

    def pose(self, instances: Instances) -> None:
        """Move the bodies to their present poses; other bodies are hidden."""
        if not np.array_equal(instances.mesh, self._mesh):
            self._assemble(instances.mesh)
        if not len(self._triangles):
            return
        matrices = np.zeros((len(instances.pose), 4, 4), np.float32)
        matrices[:, :3], matrices[:, 3, 3] = instances.pose, 1.0
        pose = wp.array(matrices, dtype=wp.mat44, device=self.device)
        arrays = [self._local, self._owner_of_point, pose, self._points]
        wp.launch(_place, dim=len(self._points), inputs=arrays, device=self.device)
        if self._poses % AGAIN == 0:
            self._moving = self._tree(self._points, self._triangles)
        else:
            self._moving.refit()
        self._poses += 1

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        """Return the nearest surface of each ray."""
        del coherent  # threads of a GPU go side by side as they come
        count = len(rays.origin_m)
        answers = [
            wp.empty(count, dtype=kind, device=self.device) for kind in (wp.float32, wp.int32, wp.int32, wp.vec3)
        ]
        sides = _SIDES if outer else 0
        asked = self._whole(np.array([count]))
        where = [*self._ids(), self._owner, self._first, *self._sent(rays), asked, float(farthest_m), sides]
        wp.launch(_closest, dim=count, inputs=[*where, *answers], device=self.device)
        return Hits(*(answer.numpy() for answer in answers))

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False) -> NDArray[np.bool_]:
        """Return (N,) whether anything is met at all, whichever its side."""
        del coherent
        hit = wp.empty(len(rays.origin_m), dtype=wp.bool, device=self.device)
        where = [*self._ids(), *self._sent(rays), float(farthest_m), hit]
        wp.launch(_blocked, dim=len(rays.origin_m), inputs=where, device=self.device)
        answer: NDArray[np.bool_] = hit.numpy()
        return answer

    def closest_into(self, asked: DeviceRays, hits: list[Any], farthest_m: float, gpu: Gpu) -> None:
        """Find what rays meet, all in arrays of Warp's; they go out through the inner sides of bodies."""
        where = [*self._ids(), self._owner, self._first, *asked.rays, asked.count, float(farthest_m), _SIDES]
        wp.launch(_closest, dim=asked.room, inputs=[*where, *hits], stream=gpu.queue, block_dim=_THREADS)

    def sunny_into(self, asked: DeviceRays, masks: list[Any], farthest_m: float, gpu: Gpu) -> None:
        """Write into the second mask 1 where a ray of the first meets nothing, else 0, all in arrays of Warp's."""
        facing, sunny = masks
        where = [*self._ids(), *asked.rays, facing, asked.count, float(farthest_m), sunny]
        wp.launch(_sunny, dim=asked.room, inputs=where, stream=gpu.queue, block_dim=_THREADS)

    def _ids(self) -> list[Any]:
        return [wp.uint64(0 if tree is None else tree.id) for tree in (self._standing, self._moving)]

    def _sent(self, rays: Rays) -> list[Any]:
        return [self._vectors(rays.origin_m), self._vectors(rays.direction)]
