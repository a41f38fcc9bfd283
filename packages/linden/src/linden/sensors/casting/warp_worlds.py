"""`WorldsCaster`: the rays of sensors in many worlds, cast on a GPU by one launch, and what kernels make of the hits.

All worlds share the tree of what stands. Each mesh of a body has one tree in its own frame. A ray is turned into the
frame of each body of its world that it passes near. So nothing is built or refitted from step to step.
"""

from typing import Any, NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from linden.protocol.values.enums import SemanticTag
from linden.sensors.camera.labels import DEPTH_STEPS, FAR_M
from linden.sensors.casting.caster import INNER_SIDES, ON_M
from linden.sensors.casting.warp_caster import WarpCaster

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

DeviceArray = Any
"""An array of Warp's. PyTorch, JAX and CuPy take it without a copy (DLPack, CUDA's array interface)."""

_SKY = int(SemanticTag.SKY)
_INNER_SIDES, _ON_M = wp.constant(INNER_SIDES), wp.constant(float(ON_M))
_FAR_M, _DEPTH_STEPS = wp.constant(wp.float64(FAR_M)), wp.constant(wp.float64(DEPTH_STEPS))
_THREADS = 64
_MOST_CONSTANTS = 64
"""Rays of lenses and sweeps that are kept on the device."""


class WorldBodies(NamedTuple):
    """The bodies of K worlds, those of one world after the other.

    While no body comes or goes, ``begins`` and ``mesh`` are the same objects; they are then not copied again.
    """

    begins: I32  # (K + 1,) where the bodies of each world begin
    mesh: I32  # (B,) number of the mesh among those of the caster
    pose: Any  # (B, 3, 4) of float32 from the mesh's frame to the world, m; on the host or on the device


class WorldEyes(NamedTuple):
    """Where the sensors of K worlds are, on the host or on the device, of float32."""

    place: Any  # (K, 3) m
    turn: Any  # (K, 3, 3) from the frame of each sensor to its world


class WorldHits(NamedTuple):
    """What the rays of K worlds met, on the device; each world has R rays."""

    distance_m: DeviceArray  # (K, R) infinite where nothing was met
    face: DeviceArray  # (K, R) number of the face among those of all meshes, -1 where nothing was met


@wp.kernel  # type: ignore[untyped-decorator]
def _ready(
    pose: wp.array2d(dtype=wp.vec4),  # type: ignore[valid-type] # (B, 3) rows of the matrices. Warp's types are values
    mesh: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    balls: wp.array(dtype=wp.vec4),  # type: ignore[valid-type] # around each mesh, in its frame
    inward: wp.array(dtype=wp.mat33),  # type: ignore[valid-type]
    place: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    ball: wp.array(dtype=wp.vec4),  # type: ignore[valid-type]
) -> None:
    body = wp.tid()
    x = pose[body, 0]
    y = pose[body, 1]
    z = pose[body, 2]
    turn = wp.mat33(x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2])
    origin = wp.vec3(x[3], y[3], z[3])
    scale = wp.length(wp.vec3(x[0], y[0], z[0]))
    own = balls[mesh[body]]
    middle = turn * wp.vec3(own[0], own[1], own[2]) + origin
    inward[body] = wp.transpose(turn) * (1.0 / (scale * scale))
    place[body] = origin
    ball[body] = wp.vec4(middle[0], middle[1], middle[2], own[3] * scale)


@wp.kernel  # type: ignore[untyped-decorator]
def _closest(
    standing: wp.uint64,
    trees: wp.array(dtype=wp.uint64),  # type: ignore[valid-type]
    first_face: wp.array(dtype=wp.int32),  # type: ignore[valid-type] # of what stands and of each mesh of bodies
    begins: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    mesh: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    inward: wp.array(dtype=wp.mat33),  # type: ignore[valid-type] # from the world to the frame of the body
    place: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    ball: wp.array(dtype=wp.vec4),  # type: ignore[valid-type] # middle and radius of each body, in the world
    eye: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    turn: wp.array(dtype=wp.mat33),  # type: ignore[valid-type]
    towards: wp.array(dtype=wp.vec3),  # type: ignore[valid-type] # of each ray, in the frame of the sensor
    far_m: float,
    distance: wp.array2d(dtype=float),  # type: ignore[valid-type]
    face: wp.array2d(dtype=wp.int32),  # type: ignore[valid-type]
) -> None:
    world, ray = wp.tid()
    o = eye[world]
    d = turn[world] * towards[ray]
    nearest = float(far_m)
    away = float(wp.inf)
    found = int(-1)  # noqa: UP018, RUF046 - so Warp knows a variable from a constant
    if standing != wp.uint64(0):
        hit = wp.mesh_query_ray(standing, o, d, far_m)
        if hit.result:
            nearest = hit.t
            away = hit.t
            found = first_face[0] + hit.face
    for body in range(begins[world], begins[world + 1]):
        tree = trees[mesh[body]]
        if tree == wp.uint64(0):
            continue
        middle = wp.vec3(ball[body][0], ball[body][1], ball[body][2]) - o
        radius = ball[body][3]
        along = wp.dot(middle, d)
        if along < -radius or along - radius > nearest or wp.dot(middle, middle) - along * along > radius * radius:
            continue
        own_o = inward[body] * (o - place[body])
        own_d = inward[body] * d
        passed = float(0.0)  # noqa: UP018 - likewise
        tries = int(0)  # noqa: UP018, RUF046 - likewise
        while tries <= _INNER_SIDES and passed < nearest:
            tries += 1
            met = wp.mesh_query_ray(tree, own_o + own_d * passed, own_d, nearest - passed)
            if not met.result:
                break
            side = wp.mesh_eval_face_normal(tree, met.face)
            if tries <= _INNER_SIDES and wp.dot(side, own_d) > 0.0:
                passed += met.t + _ON_M
                continue
            nearest = passed + met.t
            away = nearest
            found = first_face[1 + mesh[body]] + met.face
            break
    distance[world, ray] = away
    face[world, ray] = found


@wp.kernel  # type: ignore[untyped-decorator]
def _depth(
    distance: wp.array2d(dtype=float),  # type: ignore[valid-type]
    towards: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    pixel: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    image: wp.array2d(dtype=float),  # type: ignore[valid-type]
) -> None:
    world, ray = wp.tid()
    at = pixel[ray]
    if at < 0:
        return
    ahead_m = wp.min(distance[world, ray] * towards[ray][0], 1000.0)
    code = wp.uint32(wp.float64(ahead_m) * (_DEPTH_STEPS / _FAR_M) + wp.float64(0.5))
    image[world, at] = float(wp.float64(code) * (_FAR_M / _DEPTH_STEPS))


@wp.kernel  # type: ignore[untyped-decorator]
def _semantic(
    face: wp.array2d(dtype=wp.int32),  # type: ignore[valid-type]
    tags: wp.array(dtype=wp.uint8),  # type: ignore[valid-type]
    sky: wp.uint8,
    pixel: wp.array(dtype=wp.int32),  # type: ignore[valid-type]
    image: wp.array2d(dtype=wp.uint8),  # type: ignore[valid-type]
) -> None:
    world, ray = wp.tid()
    at = pixel[ray]
    if at < 0:
        return
    if face[world, ray] < 0:
        image[world, at] = sky
    else:
        image[world, at] = tags[face[world, ray]]


@wp.kernel  # type: ignore[untyped-decorator]
def _points(
    distance: wp.array2d(dtype=float),  # type: ignore[valid-type]
    towards: wp.array(dtype=wp.vec3),  # type: ignore[valid-type]
    attenuation_per_m: float,
    points: wp.array2d(dtype=wp.vec4),  # type: ignore[valid-type]
    returned: wp.array2d(dtype=wp.bool),  # type: ignore[valid-type]
) -> None:
    world, ray = wp.tid()
    away = distance[world, ray]
    hit = away < wp.inf
    returned[world, ray] = hit
    if hit:
        at = towards[ray] * away
        points[world, ray] = wp.vec4(at[0], at[1], at[2], wp.exp(-attenuation_per_m * away))
    else:
        points[world, ray] = wp.vec4(0.0, 0.0, 0.0, 0.0)


class WorldsCaster:
    """Casts the rays of one sensor in each of many worlds; all sensors have the same rays in their own frames."""

    def __init__(self, caster: WarpCaster, first_face: I64, tags: NDArray[np.uint8]) -> None:
        """Take what stands from ``caster``.

        Args:
            caster: the caster of the same scene.
            first_face: (1 + M,) number of the first face of what stands and of each mesh of bodies.
            tags: (F,) semantic tag of each face.
        """
        self._caster, self._device = caster, caster.device
        self._first_face = self._put(first_face.astype(np.int32), wp.int32)
        self._tags = self._put(tags, wp.uint8)
        self._trees: dict[int, Any] = {}
        self._grown: I32 | None = None  # the meshes of the latest bodies
        self._tree_ids = np.zeros(len(caster.bodies), np.uint64)
        self._tree_ids_there = self._balls_there = None
        self._balls = np.zeros((len(caster.bodies), 4), np.float32)
        self._constants: dict[int, tuple[object, Any]] = {}

    def cast(self, bodies: WorldBodies, eyes: WorldEyes, towards: F32, farthest_m: float) -> WorldHits:
        """Return what rays meet; they go out through the inner sides of bodies, as those of sensors do.

        Args:
            bodies: the bodies of K worlds.
            eyes: the sensors of K worlds.
            towards: (R, 3) unit vectors in the frame of a sensor.
            farthest_m: nothing is met beyond.
        """
        self._grow(bodies.mesh)
        worlds, rays = eyes.place.shape[0], len(towards)
        hits = WorldHits(
            wp.empty((worlds, rays), dtype=wp.float32, device=self._device),
            wp.empty((worlds, rays), dtype=wp.int32, device=self._device),
        )
        count = len(bodies.mesh)
        mesh = self._constant(bodies.mesh, wp.int32)
        inward, place, ball = (
            wp.empty(count, dtype=kind, device=self._device) for kind in (wp.mat33, wp.vec3, wp.vec4)
        )
        if count:
            pose = self._put(bodies.pose, wp.vec4)
            given = [pose, mesh, self._balls_there]
            wp.launch(_ready, dim=count, inputs=given, outputs=[inward, place, ball], device=self._device)
        wp.launch(
            _closest,
            dim=(worlds, rays),
            inputs=[
                wp.uint64(self._caster.standing_id),
                self._tree_ids_there,
                self._first_face,
                self._constant(bodies.begins, wp.int32),
                mesh,
                inward,
                place,
                ball,
                self._put(eyes.place, wp.vec3),
                self._put(eyes.turn, wp.mat33),
                self._constant(towards, wp.vec3),
                float(farthest_m),
            ],
            outputs=[*hits],
            device=self._device,
            block_dim=_THREADS,
        )
        return hits

    def depth_m(self, hits: WorldHits, towards: F32, pixel: I32, size: int) -> DeviceArray:
        """Return (K, size) the depth of each pixel in m, as a depth camera counts it; ``pixel`` (R,) or -1 of rays."""
        return self._image(_depth, hits.distance_m, [self._constant(towards, wp.vec3)], pixel, size, wp.float32)

    def semantic(self, hits: WorldHits, pixel: I32, size: int) -> DeviceArray:
        """Return (K, size) the semantic tag of each pixel."""
        return self._image(_semantic, hits.face, [self._tags, wp.uint8(_SKY)], pixel, size, wp.uint8)

    def points(self, hits: WorldHits, towards: F32, attenuation_per_m: float) -> tuple[DeviceArray, DeviceArray]:
        """Return (K, R) points (x, y, z in the sensor's frame, m, intensity) and (K, R) which rays returned."""
        shape = hits.distance_m.shape
        points = wp.empty(shape, dtype=wp.vec4, device=self._device)
        returned = wp.empty(shape, dtype=wp.bool, device=self._device)
        given = [hits.distance_m, self._constant(towards, wp.vec3), float(attenuation_per_m)]
        wp.launch(_points, dim=shape, inputs=given, outputs=[points, returned], device=self._device)
        return points, returned

    def _image(
        self,
        paint: Any,  # noqa: ANN401 - Warp's
        measured: DeviceArray,
        columns: list[Any],
        pixel: I32,
        size: int,
        dtype: Any,  # noqa: ANN401 - Warp's
    ) -> DeviceArray:
        image = wp.empty((measured.shape[0], size), dtype=dtype, device=self._device)
        given = [measured, *columns, self._constant(pixel, wp.int32)]
        wp.launch(paint, dim=measured.shape, inputs=given, outputs=[image], device=self._device)
        return image

    def _grow(self, mesh: I32) -> None:
        """Build the trees of meshes that no body had before."""
        if mesh is self._grown:
            return
        self._grown = mesh
        new = [number for number in np.unique(mesh).tolist() if number not in self._trees]
        for number in new:
            body = self._caster.bodies[number]
            self._trees[number] = tree = self._caster.tree_of(body)
            self._tree_ids[number] = 0 if tree is None else tree.id
            middle = 0.5 * (body.vertices_m.min(axis=0) + body.vertices_m.max(axis=0))
            self._balls[number, :3] = middle
            self._balls[number, 3] = 1.001 * np.linalg.norm(body.vertices_m - middle, axis=1).max() + 1e-3
        if new or self._tree_ids_there is None:
            self._tree_ids_there = self._put(self._tree_ids, wp.uint64)
            self._balls_there = self._put(self._balls, wp.vec4)

    def _constant(self, values: NDArray[Any], dtype: Any) -> DeviceArray:  # noqa: ANN401 - Warp's
        """Return the device's copy of an array that is the same object at each call, such as the rays of a camera."""
        known = self._constants.get(id(values))
        if known is None or known[0] is not values:
            if len(self._constants) > _MOST_CONSTANTS:
                self._constants.clear()
            known = self._constants[id(values)] = values, self._put(values, dtype)
        return known[1]

    def _put(self, values: Any, dtype: Any) -> DeviceArray:  # noqa: ANN401 - Warp's
        """Return an array on the device; one that lies there already is not copied."""
        if hasattr(values, "__cuda_array_interface__"):
            return wp.array(data=values, dtype=dtype, device=self._device, copy=False)
        return wp.array(np.ascontiguousarray(values), dtype=dtype, device=self._device)
