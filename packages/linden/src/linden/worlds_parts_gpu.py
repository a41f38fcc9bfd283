"""`PartsOnGpu`: places sensors and the parts of bodies of many worlds on a CUDA device, by the functions of the CPU.

Needs the extra ``gpu`` (numba-cuda). Nothing is copied from the device.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba import cuda as numba_cuda
from numpy.typing import NDArray

from linden.scenery.actors.posing import MOST_BONES, SCRATCH, BoneChain, bones, put_matrix, put_part
from linden.sensors.runtime.world_parts import FRAMES, PartsOfBodies, put_body, put_eye

cuda: Any = numba_cuda
OnDevice: TypeAlias = Any
"""An array of numba's on the device."""

_THREADS = 64
_F64 = np.float64


class BodiesOnDevice(NamedTuple):
    """The bodies of W worlds with S slots, on the device."""

    state: OnDevice  # (W, S) of BODY
    spec_of: OnDevice  # (W, S)
    specs: OnDevice


class EyesOnDevice(NamedTuple):
    """Where the sensors of K worlds are, on the device."""

    place: OnDevice  # (K, 3) m
    turn: OnDevice  # (K, 3, 3) from the frame of each sensor to its world


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _place_bodies(
    bodies: BodiesOnDevice, walked_m: OnDevice, parts: PartsOfBodies, chain: BoneChain, poses: OnDevice
) -> None:  # pragma: no cover - compiled
    """Write the poses (P, 3, 4) of the parts of this thread's body."""
    index = cuda.grid(1)
    if index >= len(parts.row):
        return
    slots = bodies.state.shape[1]
    world, slot = parts.row[index] // slots, parts.row[index] % slots
    pose, place = cuda.local.array(6, _F64), cuda.local.array((3, 4), _F64)
    scratch, frames = cuda.local.array((MOST_BONES, SCRATCH), _F64), cuda.local.array((FRAMES, 3, 4), _F64)
    spec = bodies.specs[bodies.spec_of[world, slot]]
    put_body(bodies.state[world, slot], spec, walked_m[world, slot], chain, pose, scratch, place, frames)
    for own in range(parts.first[index], parts.first[index + 1]):
        put_part(place, frames[parts.frame[own]], parts.scale[own], poses[own])


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _place_eyes(
    bodies: BodiesOnDevice, chosen: OnDevice, slot: int, relative: OnDevice, found: EyesOnDevice
) -> None:  # pragma: no cover - compiled
    """Write where the sensor of this thread's world is; a negative ``slot`` says that it stands in the world."""
    index = cuda.grid(1)
    if index >= len(chosen):
        return
    outer, pose, matrix = cuda.local.array(6, _F64), cuda.local.array(6, _F64), cuda.local.array((3, 4), _F64)
    if slot >= 0:
        put_eye(bodies.state[chosen[index], slot], relative[index], outer, pose)
        put_matrix(pose, matrix)
    else:
        put_matrix(relative[index], matrix)
    for i in range(3):
        found.place[index, i] = matrix[i, 3]
        for j in range(3):
            found.turn[index, i, j] = matrix[i, j]


class PartsOnGpu:
    """Keeps on the device what does not change while bodies move."""

    def __init__(self) -> None:
        """Copy the bones of walkers to the device."""
        self._bones = BoneChain(*(cuda.to_device(column) for column in bones()))
        self._of: PartsOfBodies | None = None

    def poses(self, bodies: BodiesOnDevice, parts: PartsOfBodies, walked_m: NDArray[np.float64]) -> OnDevice:
        """Return the poses (P, 3, 4), float32, of parts; ``walked_m`` (W, S) of walkers."""
        if self._of is not parts:
            self._of = parts
            self._parts = PartsOfBodies(*(cuda.to_device(np.ascontiguousarray(column)) for column in parts))
        found = cuda.device_array((len(parts.mesh), 3, 4), np.float32)
        walked = cuda.to_device(walked_m)
        _launch(_place_bodies, len(parts.row), bodies, walked, self._parts, self._bones, found)
        return found

    @staticmethod
    def eyes(
        bodies: BodiesOnDevice, chosen: NDArray[np.int32], slot: int | None, transform: NDArray[np.float64]
    ) -> EyesOnDevice:
        """Return where sensors at ``transform`` (K, 6) are, relative to the bodies in a slot or in the world."""
        count = len(chosen)
        found = EyesOnDevice(*(cuda.device_array((count, *shape), np.float32) for shape in ((3,), (3, 3))))
        wanted = cuda.to_device(chosen), -1 if slot is None else slot, cuda.to_device(transform)
        _launch(_place_eyes, count, bodies, *wanted, found)
        cuda.synchronize()  # Warp has a stream of its own
        return found


def _launch(kernel: Any, count: int, *arguments: Any) -> None:  # noqa: ANN401 - numba's
    if count:
        kernel[math.ceil(count / _THREADS), _THREADS](*arguments)
