"""`GpuWorlds`: the bodies of many worlds on a CUDA device; one thread steps one world by the functions of the CPU.

Needs the extra ``gpu`` (numba-cuda). Nothing is copied from the device before it is read.
"""

import math
from typing import Any, TypeAlias

import numpy as np
from numba import cuda as numba_cuda
from numpy.typing import NDArray

from linden.errors import UserError
from linden.maps.ground import Ground
from linden.physics.bodies import FARTHEST_M
from linden.physics.columns import BodyTable
from linden.physics.contact.impulses import ACCOUNT
from linden.physics.contact.pairs import pairs_of_few, write_circles
from linden.physics.contact.statics import Statics
from linden.physics.state import BODY, VEHICLE_WORK
from linden.physics.step import GRAVITY_MPS2, begin_frame, run_frame
from linden.physics.vehicle.controls import set_controls
from linden.structured import StructuredArray

cuda: Any = numba_cuda
"""What it offers it makes up as it is loaded: nothing of that is typed."""

OnDevice: TypeAlias = Any
"""An array of numba's on the device, or one of its records."""

THREADS = 64
"""Of a block: the step needs as many registers as a thread can have."""

_PAIRS_A_WORLD, _PAIRS_A_BODY = 16, 8
"""Room for pairs; a world with more becomes invalid."""

_WORDS = BODY.itemsize // 8


class DeviceColumn:
    """A column of all bodies on the device, as torch and CuPy take it without a copy."""

    def __init__(self, interface: dict[str, Any], owner: object) -> None:
        """Describe memory of ``owner`` by CUDA's array interface, version 3."""
        self.__cuda_array_interface__ = interface
        self._owner = owner


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _step(
    state: OnDevice,
    spec_of: OnDevice,
    specs: OnDevice,
    work: OnDevice,
    counts: OnDevice,
    valid: OnDevice,
    frames: OnDevice,
    circles: OnDevice,
    pairs: OnDevice,
    found: OnDevice,
    account: OnDevice,
    ground: OnDevice,
    statics: OnDevice,
    dt_s: float,
    substeps: int,
    gravity_mps2: float,
) -> None:  # pragma: no cover - compiled
    """Step the world of this thread."""
    world = cuda.grid(1)
    if world >= len(counts) or not valid[world]:
        return
    rows, which, count, w = state[world], spec_of[world], counts[world], work[world]
    begin_frame(rows, which, specs, w, count, dt_s)
    reach = circles[world, :count]
    write_circles(rows, dt_s, reach)
    found[world] = pairs_of_few(rows, reach, statics, pairs[world])
    if found[world] > pairs.shape[1]:
        valid[world], found[world] = False, 0
        return
    own, entries = pairs[world, : found[world]], account[world]
    for k in range(found[world]):
        for column in range(ACCOUNT):
            entries[k, column] = 0.0
    run_frame(rows, which, specs, w, count, own, entries, ground, statics, dt_s, substeps, gravity_mps2)
    frames[world] += 1
    for i in range(count):
        for axis in range(3):
            if not abs(rows[i].position[axis]) < FARTHEST_M:
                valid[world] = False


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _set_controls(flat: OnDevice, rows: OnDevice, controls: OnDevice) -> None:  # pragma: no cover - compiled
    """Set the control of this thread's vehicle."""
    k = cuda.grid(1)
    if k < len(rows):
        set_controls(flat, rows[k : k + 1], controls[k : k + 1])


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _copy_worlds(
    words: OnDevice, first: OnDevice, chosen: OnDevice, valid: OnDevice, frames: OnDevice, found: OnDevice
) -> None:  # pragma: no cover
    """Copy one word of the first state of the chosen worlds."""
    k = cuda.grid(1)
    if k >= len(chosen) * words.shape[1]:
        return
    world, word = chosen[k // words.shape[1]], k % words.shape[1]
    words[world, word] = first[world, word]
    if word == 0:
        valid[world], frames[world], found[world] = True, 0, 0


@cuda.jit  # type: ignore[untyped-decorator] # numba has no hints for it
def _copy_bodies(words: OnDevice, rows: OnDevice, given: OnDevice) -> None:  # pragma: no cover - compiled
    """Copy one word of a given body into its row."""
    k = cuda.grid(1)
    if k < len(rows) * given.shape[1]:
        row, word = k // given.shape[1], k % given.shape[1]
        words[rows[row], word] = given[row, word]


class GpuWorlds:
    """Copies of the tables of worlds on a device.

    Attributes:
        is_current: whether the device holds the worlds as they are; the host may be behind.
    """

    def __init__(self, ground: Ground, statics: Statics) -> None:
        """Take the first CUDA device, and copy the map there.

        Raises:
            UserError: there is no such device.
        """
        try:
            cuda.current_context()
        except Exception as error:  # numba's errors of a missing driver are of several kinds
            raise UserError(f"no CUDA device can be used ({error}); use device='cpu'") from error
        self._ground, self._statics = (
            type(part)(*(cuda.to_device(np.ascontiguousarray(column)) for column in part)) for part in (ground, statics)
        )
        self.is_current = False

    def upload(self, table: BodyTable, first: BodyTable, valid: NDArray[np.bool_], frames: NDArray[np.int64]) -> None:
        """Copy the worlds to the device.

        Raises:
            UserError: they do not fit into its memory.
        """
        worlds, slots = table.state.shape
        room = _PAIRS_A_WORLD + _PAIRS_A_BODY * slots
        needed = 2 * table.state.nbytes + worlds * (VEHICLE_WORK.itemsize + 24 * slots + (8 * ACCOUNT + 8) * room)
        free = float(cuda.current_context().get_memory_info()[0])
        if needed > free:
            raise UserError(
                f"{worlds} worlds of {slots} bodies need {needed / 2**30:.1f} GiB, and the device has "
                f"{free / 2**30:.1f} GiB free; make fewer worlds, or use device='cpu'"
            )
        self.state, self._first = cuda.to_device(table.state), cuda.to_device(_words(first.state))
        self._spec_of, self._specs = cuda.to_device(table.spec_of), cuda.to_device(table.specs)
        self._counts, self.valid = cuda.to_device(table.counts), cuda.to_device(valid)
        self.frames = cuda.to_device(frames)
        self._work = cuda.device_array(worlds, VEHICLE_WORK)
        self._circles = cuda.device_array((worlds, slots, 3), np.float64)
        self._pairs = cuda.device_array((worlds, room, 2), np.int32)
        self._found = cuda.to_device(np.zeros(worlds, np.int32))
        self._account = cuda.device_array((worlds, room, ACCOUNT), np.float64)
        self.is_current = True

    def download(self, table: BodyTable, valid: NDArray[np.bool_], frames: NDArray[np.int64]) -> None:
        """Copy the worlds back into the tables of the host."""
        self.state.copy_to_host(table.state)
        self.valid.copy_to_host(valid)
        self.frames.copy_to_host(frames)

    def step(self, dt_s: float, substeps: int) -> None:
        """Advance all valid worlds; returns before the device is done."""
        _launch(
            _step, len(self._counts), self.state, self._spec_of, self._specs, self._work, self._counts, self.valid,
            self.frames, self._circles, self._pairs, self._found, self._account, self._ground, self._statics, dt_s,
            substeps, GRAVITY_MPS2,
        )  # fmt: skip

    def set_controls(self, rows: NDArray[np.int32], controls: NDArray[np.float64]) -> None:
        """Set the controls (K, 7) of vehicles in flat rows (K,)."""
        flat = self.state.reshape(self.state.shape[0] * self.state.shape[1])
        _launch(_set_controls, len(rows), flat, cuda.to_device(rows), cuda.to_device(controls))

    def set_state(self, rows: NDArray[np.int32], states: StructuredArray) -> None:
        """Set the bodies in flat rows (K,) to states (K,) of BODY."""
        words = self.state.view(np.int64).reshape(self.state.shape[0] * self.state.shape[1], _WORDS)
        given = cuda.to_device(_words(states))
        _launch(_copy_bodies, len(rows) * _WORDS, words, cuda.to_device(rows), given)

    def reset(self, chosen: NDArray[np.int32]) -> None:
        """Set worlds back to their first state."""
        words = self.state.view(np.int64).reshape(self.state.shape[0], self.state.shape[1] * _WORDS)
        count = len(chosen) * words.shape[1]
        _launch(_copy_worlds, count, words, self._first, cuda.to_device(chosen), self.valid, self.frames, self._found)

    def touched(self) -> list[tuple[int, NDArray[np.int32], NDArray[np.float64]]]:
        """Return for each world with near pairs its number, the pairs (P, 2) and their accounts (P, ACCOUNT)."""
        found = self._found.copy_to_host()
        worlds = np.flatnonzero(found)
        if not len(worlds):
            return []
        pairs, account = self._pairs.copy_to_host(), self._account.copy_to_host()
        return [(int(world), pairs[world, : found[world]], account[world, : found[world]]) for world in worlds]

    def column(self, name: str) -> DeviceColumn:
        """Return a column of all bodies, (W, S, ...), where it lies."""
        assert BODY.fields is not None
        kind, offset = BODY.fields[name][:2]
        inner = np.empty(kind.shape, kind.base)
        worlds, slots = self.state.shape
        interface = {
            "shape": (worlds, slots, *kind.shape),
            "strides": (slots * BODY.itemsize, BODY.itemsize, *inner.strides),
            "typestr": kind.base.str,
            "data": (self.state.device_ctypes_pointer.value + offset, False),
            "version": 3,
        }
        return DeviceColumn(interface, self.state)

    @staticmethod
    def wait() -> None:
        """Wait until the device has done all work."""
        cuda.synchronize()


def _launch(kernel: Any, count: int, *arguments: Any) -> None:  # noqa: ANN401 - numba's
    kernel[math.ceil(count / THREADS), THREADS](*arguments)


def _words(state: NDArray[Any]) -> NDArray[np.int64]:
    """Return rows of BODY (W, S) as words (W, S * words)."""
    return state.view(np.int64).reshape(len(state), -1)
