"""The caster of the CPU: Embree's trees, asked in packets from compiled code by all processors.

What stands and each body is a scene of its own, built once; one scene above holds them as instances, posed anew each
tick. Trees are built by one thread, and packets are cut alike however many threads there are: so of two triangles at
the same distance it is always the same one that answers.
"""

import ctypes
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import CPU, F32, I32, Hits, Instances, Rays
from linden.sensors.casting.embree_library import embree, packet_width
from linden.sensors.casting.packets import asked, build, place
from linden.sensors.casting.thread_pool import in_stretches

_TRIANGLES, _INSTANCE = 0, 121  # RTC_GEOMETRY_TYPE_
_INDEX, _VERTEX = 0, 1  # RTC_BUFFER_TYPE_
_UINT3, _FLOAT3 = 0x5003, 0x9003  # RTC_FORMAT_
_MEDIUM = 1  # RTC_BUILD_QUALITY_
_ROBUST = 4  # RTC_SCENE_FLAG_


class EmbreeCaster:
    """Answers rays by Embree; see ``linden.sensors.casting.caster.Caster``.

    Attributes:
        width: rays in a packet.
        scene: address of the scene above, for kernels that send packets themselves.
        pose_of: (K, 3, 4) poses of the instances, as they were put last.
    """

    device = CPU

    def __init__(self, standing: Mesh, bodies: list[Mesh], *, beside: "EmbreeCaster | None" = None) -> None:
        """Build the trees, or take those of another caster of the same meshes, ``beside`` which this one is posed.

        Raises:
            NoEmbreeError: the library cannot be used here.
        """
        self._library = embree()
        self.width = packet_width()
        self._kernels = build(self.width)
        self._meshes = standing, bodies
        self._beside = beside  # keeps the trees
        self._scenes: list[int] = []
        if beside is None:
            self._device = self._library.rtcNewDevice(b"threads=1")
            self._kept: list[NDArray[Any]] = []  # Embree reads them in place
            self._trees: dict[int, int] = {}  # of bodies, by their number: built when one of them first comes
            weakref.finalize(self, _release, self._library, self._device, self._scenes)
            self._standing = self._built(standing, filtered=False)
            self._scenes.append(self._standing)
        else:
            self._device, self._trees, self._standing = beside._device, beside._trees, beside._standing  # noqa: SLF001
            weakref.finalize(self, _release, self._library, None, self._scenes)
        self.scene: int = self._library.rtcNewScene(self._device)
        # that takes 0.2 ms in each tick, and every ray meets it
        self._library.rtcSetSceneBuildQuality(self.scene, _MEDIUM)
        self._instances: list[int] = []
        self._mesh: I32 = np.zeros(0, np.int32)
        self.pose_of: F32 = np.zeros((0, 3, 4), np.float32)
        here = np.array([self._new_instance(self._standing, 0)], np.int64)
        place(here, np.eye(3, 4, dtype=np.float32)[None], self.pose_of)
        self._library.rtcCommitScene(self.scene)
        self._scenes.append(self.scene)
        self._complain()

    def build_trees(self, meshes: I32) -> None:
        """Build the trees of bodies, so that no thread does so."""
        for number in np.unique(meshes).tolist():
            self._tree(number)

    def sibling(self) -> "EmbreeCaster":
        """Return a caster of the same trees that is posed by itself: for another thread."""
        return EmbreeCaster(*self._meshes, beside=self)

    def _built(self, mesh: Mesh, *, filtered: bool) -> int:
        """Return a scene of the mesh's triangles; ``filtered``, its inner sides are not met by rays that ask for it.

        Embree's highest quality takes twice as long to build and answers no sooner.
        """
        library = self._library
        scene: int = library.rtcNewScene(self._device)
        library.rtcSetSceneFlags(scene, _ROBUST)
        library.rtcSetSceneBuildQuality(scene, _MEDIUM)
        if len(mesh.triangles):
            geometry = library.rtcNewGeometry(self._device, _TRIANGLES)
            library.rtcSetGeometryBuildQuality(geometry, _MEDIUM)
            # Embree reads 16 bytes of each vertex, so one more has to lie behind the last
            vertices = np.concatenate([mesh.vertices_m, mesh.vertices_m[-1:]]).astype(np.float32, order="C")
            triangles = np.ascontiguousarray(mesh.triangles, np.uint32)
            self._kept += [vertices, triangles]
            for kind, form, array, count in (
                (_VERTEX, _FLOAT3, vertices, len(vertices) - 1),
                (_INDEX, _UINT3, triangles, len(triangles)),
            ):
                library.rtcSetSharedGeometryBuffer(geometry, kind, 0, form, array.ctypes.data, 0, 12, count)
            library.rtcSetGeometryEnableFilterFunctionFromArguments(geometry, filtered)
            library.rtcCommitGeometry(geometry)
            library.rtcAttachGeometryByID(scene, geometry, 0)
            library.rtcReleaseGeometry(geometry)  # the scene keeps it
        library.rtcCommitScene(scene)
        return scene

    def _tree(self, number: int) -> int:
        """Return the scene of a body's mesh."""
        if number not in self._trees:
            self._trees[number] = self._built(self._meshes[1][number], filtered=True)
            self._scenes.append(self._trees[number])
        return self._trees[number]

    def _new_instance(self, scene: int, number: int) -> int:
        geometry: int = self._library.rtcNewGeometry(self._device, _INSTANCE)
        self._library.rtcSetGeometryInstancedScene(geometry, scene)
        self._library.rtcAttachGeometryByID(self.scene, geometry, number)
        self._library.rtcReleaseGeometry(geometry)  # the scene keeps it
        return geometry

    def pose(self, instances: Instances) -> None:
        """Move the bodies to their present poses; other bodies are hidden."""
        poses = np.ascontiguousarray(instances.pose, np.float32)
        if np.array_equal(instances.mesh, self._mesh) and np.array_equal(poses, self.pose_of):
            return
        if not np.array_equal(instances.mesh, self._mesh):
            self._recast(instances.mesh)
            self.pose_of = poses[:0]  # an instance with another mesh has to be placed in any case
        place(np.array(self._instances[: len(poses)], np.int64), poses, self.pose_of)
        self.pose_of = poses
        self._library.rtcCommitScene(self.scene)
        self._complain()

    def _recast(self, mesh: I32) -> None:
        """Give each instance its mesh; unused instances are hidden."""
        library, before = self._library, self._mesh
        for row, number in enumerate(mesh.tolist()):
            if row == len(self._instances):
                self._instances.append(self._new_instance(self._tree(number), row + 1))
                continue
            if row >= len(before):
                library.rtcEnableGeometry(self._instances[row])
            library.rtcSetGeometryInstancedScene(self._instances[row], self._tree(number))
        for geometry in self._instances[len(mesh) : max(len(mesh), len(before))]:
            library.rtcDisableGeometry(geometry)
        self._mesh = np.array(mesh, np.int32)

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        """Return the nearest surface of each ray."""
        count = len(rays.origin_m)
        hits = Hits(
            np.empty(count, np.float32),
            np.empty(count, np.int32),
            np.empty(count, np.int32),
            np.empty((count, 3), np.float32),
        )
        asking = arguments(coherent=coherent, outer=outer)
        where = (self.scene, asking, *_flat(rays), np.float32(farthest_m), self.pose_of)

        def work(start: int, stop: int) -> None:
            self._kernels.closest(*where, *hits, start, stop)

        in_stretches(count, work, multiple=self.width)
        return hits

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False) -> NDArray[np.bool_]:
        """Return (N,) whether anything is met at all, whichever its side."""
        hit = np.empty(len(rays.origin_m), np.bool_)
        where = (self.scene, arguments(coherent=coherent), *_flat(rays), np.float32(farthest_m))

        def work(start: int, stop: int) -> None:
            self._kernels.blocked(*where, hit, start, stop)

        in_stretches(len(hit), work, multiple=self.width)
        return hit

    def _complain(self) -> None:
        if error := self._library.rtcGetDeviceError(self._device):
            raise RuntimeError(f"Embree reports error {error} (RTCError in rtcore_device.h)")


def arguments(*, coherent: bool, outer: bool = False) -> int:
    """Return the address of RTCIntersectArguments for kernels."""
    return int(asked(coherent=coherent, outer=outer).ctypes.data)


def _flat(rays: Rays) -> tuple[F32, F32]:
    return np.ascontiguousarray(rays.origin_m, np.float32), np.ascontiguousarray(rays.direction, np.float32)


def _release(library: ctypes.CDLL, device: int | None, scenes: list[int]) -> None:
    for scene in reversed(scenes):
        library.rtcReleaseScene(scene)
    if device is not None:
        library.rtcReleaseDevice(device)
