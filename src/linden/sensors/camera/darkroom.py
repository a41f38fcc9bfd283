"""Where cameras have their pictures made: on the CPU, or on the GPU where rays are cast on one."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from linden.casting.rays import CPU, Caster, Hits, Rays
from linden.sensors.camera import labels, motion
from linden.sensors.camera.picture.rgb import picture
from linden.sensors.camera.rays import aim, directions
from linden.sensors.camera.spec import CameraSpec, Film
from linden.sensors.looking import Look

U8 = NDArray[np.uint8]
F32 = NDArray[np.float32]


class Darkroom(Protocol):
    """Makes pictures: (height, width, 4) bytes B, G, R, A, and (height, width, 2) floats of a flow."""

    def depth(self, spec: CameraSpec, look: Look) -> U8:
        """Return depth along the camera's axis in 24 bits."""
        ...

    def semantic(self, spec: CameraSpec, look: Look) -> U8:
        """Return tags."""
        ...

    def instance(self, spec: CameraSpec, look: Look) -> U8:
        """Return tags and ids."""
        ...

    def normals(self, spec: CameraSpec, look: Look) -> U8:
        """Return normals in the camera's view."""
        ...

    def flow(self, spec: CameraSpec, look: Look) -> F32:
        """Return the motion of each pixel since the frame before."""
        ...

    def coloured(self, spec: CameraSpec, film: Film, look: Look) -> U8:
        """Return colours."""
        ...


class OnCpu:
    """The CPU's pictures."""

    def depth(self, spec: CameraSpec, look: Look) -> U8:
        """Return depth along the camera's axis in 24 bits."""
        return labels.depth(spec, view(spec, look)[1], directions(spec))

    def semantic(self, spec: CameraSpec, look: Look) -> U8:
        """Return tags."""
        return labels.semantic(spec, view(spec, look)[1], look.seen)

    def instance(self, spec: CameraSpec, look: Look) -> U8:
        """Return tags and ids."""
        return labels.instance(spec, view(spec, look)[1], look.seen)

    def normals(self, spec: CameraSpec, look: Look) -> U8:
        """Return normals in the camera's view."""
        return labels.normals(spec, view(spec, look)[1], look.pose)

    def flow(self, spec: CameraSpec, look: Look) -> F32:
        """Return the motion of each pixel since the frame before."""
        return motion.flow(spec, *view(spec, look), look.seen.instances, look.before, look.pose)

    def coloured(self, spec: CameraSpec, film: Film, look: Look) -> U8:
        """Return colours."""
        return picture(spec, film, look.pose, *view(spec, look), look.seen)


def view(spec: CameraSpec, look: Look) -> tuple[Rays, Hits]:
    """Return a camera's rays and what they meet; cameras of one place and lens share them."""
    key = ("view", spec, look.pose)
    if key not in look.shared:
        rays = aim(directions(spec), look.pose)
        look.shared[key] = rays, look.seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True)
    return look.shared[key]  # type: ignore[return-value] # put there above


_ON_CPU = OnCpu()
_on_gpu: list[tuple[Caster, Darkroom]] = []
"""The last one made, for the caster it was made of."""


def darkroom_of(caster: Caster) -> Darkroom:
    """Return where pictures of what a caster sees are made."""
    if caster.device == CPU:
        return _ON_CPU
    if not _on_gpu or _on_gpu[0][0] is not caster:
        from linden.casting.warp_caster import WarpCaster  # noqa: PLC0415 - users of a GPU alone have Warp
        from linden.sensors.camera.gpu.darkroom import GpuDarkroom  # noqa: PLC0415 - likewise

        assert isinstance(caster, WarpCaster)
        _on_gpu[:] = [(caster, GpuDarkroom(caster))]
    return _on_gpu[0][1]
