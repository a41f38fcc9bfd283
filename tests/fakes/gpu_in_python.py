"""A GPU that is none: numba's simulator runs the kernels as Python, a plain caster stands in for Warp.

``python gpu_in_python.py`` makes every picture of a small street on both sides and prints how far they are apart. It
runs in a process of its own, with NUMBA_ENABLE_CUDASIM=1 and NUMBA_DISABLE_JIT=1: both count for a whole process.
"""

import sys
from collections.abc import Callable
from types import ModuleType, SimpleNamespace

import numpy as np
from numba import cuda

from fakes.plain_caster import PlainCaster
from linden.sensors.casting.caster import Rays

WARP = ModuleType("warp")
"""What the modules under test name of it when they are loaded; what they would call of it is replaced below."""
WARP.Stream = WARP.uint64 = object
WARP.config = SimpleNamespace()
WARP.kernel = lambda function: function
for name in ("vec3", "int32", "mat44", "bool"):
    setattr(WARP, name, None)
WARP.array = lambda **_: None
sys.modules["warp"] = WARP

from linden.protocol.values.space import Rotation, Transform, Vector3D  # noqa: E402 - likewise
from linden.sensors.camera.gpu.renderer import GpuRenderer  # noqa: E402 - likewise
from linden.sensors.camera.renderer import CpuRenderer  # noqa: E402 - likewise
from linden.sensors.camera.spec import CameraSpec, Film, Picture  # noqa: E402 - likewise
from linden.sensors.casting.gpu_memory import SharedBuffer  # noqa: E402 - once there is something that is called warp
from linden.sensors.view import SensorLook  # noqa: E402 - likewise

SPEC = CameraSpec(12, 8)
PICTURES = [
    *(Picture(kind, SPEC) for kind in ("depth", "semantic", "instance", "normals", "flow")),
    Picture("coloured", SPEC, Film()),
]
EYE, BEFORE = Transform(Vector3D(0.0, 0.0, 2.0), Rotation()), Transform(Vector3D(-0.1, 0.0, 2.0), Rotation())


class PlainGpu:
    """As ``linden.sensors.casting.gpu_memory.Gpu``; work that was captured is simply done again."""

    queue = None

    def empty(self, shape, dtype):
        return cuda.device_array(shape, np.dtype(dtype))

    def put(self, values):
        return cuda.to_device(np.ascontiguousarray(values))

    def shared_buffer(self, size: int) -> SharedBuffer:
        here, there = np.zeros(size, np.uint8), cuda.device_array(size, np.uint8)
        return SharedBuffer(here, there, lambda: there.copy_to_device(here))

    def view(self, array):
        return array

    def launch(self, kernel, count: int, *arguments) -> None:
        kernel[-(-count // 16), 16](*arguments)

    def fetching(self, array):
        return array.copy_to_host

    def capture(self, work: Callable[[], None]) -> Callable[[], None]:
        return work

    def replay(self, graph: Callable[[], None]) -> None:
        graph()

    def beside(self) -> "PlainGpu":
        return self

    def after(self, other: "PlainGpu") -> None:
        pass


class PlainGpuCaster(PlainCaster):
    """As ``linden.sensors.casting.warp_caster.WarpCaster``."""

    device, gpu, trees = "cuda", PlainGpu(), 0

    def closest_into(self, asked, hits, farthest_m: float, _gpu: PlainGpu) -> None:
        count = int(asked.count.copy_to_host()[0])
        rays = Rays(*(column.copy_to_host()[:count] for column in asked.rays))
        for there, here in zip(hits, self.closest(rays, farthest_m, outer=True), strict=True):
            there[:count].copy_to_device(here)

    def sunny_into(self, asked, masks, farthest_m: float, _gpu: PlainGpu) -> None:
        count = int(asked.count.copy_to_host()[0])
        rays = Rays(*(column.copy_to_host()[:count] for column in asked.rays))
        facing = masks[0].copy_to_host()[:count]
        masks[1][:count].copy_to_device((facing & ~self.blocked(rays, farthest_m)).astype(np.float32))


def main() -> None:
    from fakes import street as streets  # noqa: PLC0415 - which is to be seen by our caster

    streets.caster_of = PlainCaster
    seen = streets.street((8.0, 0.5, 0.8), (7.0, 0.5, 0.8))
    caster = PlainGpuCaster(seen.standing, seen.bodies)
    caster.pose(seen.instances)
    here, there = CpuRenderer(), GpuRenderer(caster)
    for expected in (False, False, True):  # as it stands, captured, and begun before it is asked for
        given = [SensorLook(s, {}, EYE, BEFORE, np.zeros(3), 0, 0, 0.05) for s in (seen, seen._replace(caster=caster))]
        for picture in PICTURES if expected else ():
            there.expect(picture, given[1])
        for picture in PICTURES:
            one, other = here.make(picture, given[0]), there.make(picture, given[1])
            assert one.shape == other.shape
            apart = np.abs(one.astype(float) - other)
            words = picture.kind, np.ptp(one), apart.max(), (apart > 2.0).mean()
            sys.stdout.write(" ".join(map(str, words)) + "\n")


if __name__ == "__main__":
    main()
