"""The small street as a GPU and as the CPU see it, the rays cast by Warp for both."""

from functools import partial

import numpy as np
import warp as wp

from fakes import street as streets
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.sensors.camera.gpu.renderer import GpuRenderer
from linden.sensors.camera.renderer import CpuRenderer
from linden.sensors.camera.spec import CameraSpec, Film, Picture
from linden.sensors.casting.caster import CPU, Hits, Rays
from linden.sensors.casting.warp_caster import WarpCaster
from linden.sensors.view import SensorLook

SPEC = CameraSpec(160, 122)
EYE, BEFORE = Transform(Vector3D(0.0, 0.0, 2.0), Rotation()), Transform(Vector3D(-0.1, 0.0, 2.0), Rotation())


class Answers:
    """What a caster on a GPU answers, for pictures that the CPU makes."""

    device = CPU

    def __init__(self, caster: WarpCaster) -> None:
        self._caster = caster

    def closest(self, rays: Rays, farthest_m: float, *, coherent: bool = False, outer: bool = False) -> Hits:
        return self._caster.closest(rays, farthest_m, coherent=coherent, outer=outer)

    def blocked(self, rays: Rays, farthest_m: float, *, coherent: bool = False):
        return self._caster.blocked(rays, farthest_m, coherent=coherent)


def apart() -> dict[str, np.ndarray] | None:
    """Return how far the pictures of each kind are apart, value by value; None where there is no GPU."""
    if not wp.get_cuda_device_count():
        return None
    plain, streets.caster_of = streets.caster_of, partial(WarpCaster, device="cuda")
    try:
        seen = streets.street((8.0, 0.5, 0.8), (7.0, 0.5, 0.8))
    finally:
        streets.caster_of = plain
    here, there, found = CpuRenderer(), GpuRenderer(seen.caster), {}
    given = seen._replace(caster=Answers(seen.caster)), seen
    for _ in range(3):  # as it stands, captured, and replayed
        looks = [SensorLook(moment, {}, EYE, BEFORE, np.zeros(3), 0, 0, 0.05) for moment in given]
        for kind in ("depth", "semantic", "instance", "normals", "flow", "coloured"):
            picture = Picture(kind, SPEC, Film() if kind == "coloured" else None)
            one, other = here.make(picture, looks[0]), there.make(picture, looks[1])
            found[kind] = np.abs(one.astype(float) - other)
    return found
