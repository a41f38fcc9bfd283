"""Choice of the renderer of camera pictures: on the CPU, or on the GPU where rays are cast on one."""

from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from linden.sensors.camera import labels
from linden.sensors.camera import optical_flow as motion
from linden.sensors.camera.picture.rgb import picture as coloured
from linden.sensors.camera.pixel_rays import aim, directions
from linden.sensors.camera.spec import CameraSpec, Picture
from linden.sensors.casting.caster import CPU, Caster, Hits, Rays
from linden.sensors.view import SensorLook

Pixels: TypeAlias = NDArray[np.uint8] | NDArray[np.float32]


class Renderer(Protocol):
    """Makes pictures: (height, width, 4) bytes B, G, R, A, and (height, width, 2) floats of a flow."""

    def expect(self, picture: Picture, look: SensorLook) -> None:
        """Begin a picture that will be asked for, where it can be made beside others."""
        ...

    def make(self, picture: Picture, look: SensorLook) -> Pixels:
        """Return a picture."""
        ...


class CpuRenderer:
    """The CPU's pictures."""

    def expect(self, picture: Picture, look: SensorLook) -> None:
        """Do nothing: each picture is made by all processors."""

    def make(self, picture: Picture, look: SensorLook) -> Pixels:
        """Return a picture."""
        spec, (rays, hits) = picture.spec, view(picture.spec, look)
        if picture.film is not None:
            return coloured(spec, picture.film, look.pose, rays, hits, look.seen)
        if picture.kind == "depth":
            return labels.depth(spec, hits, directions(spec))
        if picture.kind == "normals":
            return labels.normals(spec, hits, look.pose)
        if picture.kind == "flow":
            return motion.flow(spec, rays, hits, look.seen.instances, look.before, look.pose)
        return (labels.semantic if picture.kind == "semantic" else labels.instance)(spec, hits, look.seen)


def view(spec: CameraSpec, look: SensorLook) -> tuple[Rays, Hits]:
    """Return a camera's rays and what they meet; cameras of one place and lens share them."""
    key = ("view", spec, look.pose)
    if key not in look.shared:
        rays = aim(directions(spec), look.pose)
        look.shared[key] = rays, look.seen.caster.closest(rays, labels.FAR_M, coherent=True, outer=True)
    return look.shared[key]  # type: ignore[return-value] # put there above


_ON_CPU = CpuRenderer()
_on_gpu: list[tuple[Caster, Renderer]] = []
"""The last one made, for the caster it was made of."""


def renderer_of(caster: Caster) -> Renderer:
    """Return where pictures of what a caster sees are made."""
    if caster.device == CPU:
        return _ON_CPU
    if not _on_gpu or _on_gpu[0][0] is not caster:
        from linden.sensors.camera.gpu.renderer import gpu_renderer  # noqa: PLC0415 - Warp, which users of a GPU have

        _on_gpu[:] = [(caster, gpu_renderer(caster))]
    return _on_gpu[0][1]
