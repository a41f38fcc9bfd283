"""`GpuWorlds`: the bodies of many worlds on a CUDA device; one thread steps one world by the functions of the CPU.

Needs the extra ``gpu`` (numba-cuda). Nothing is copied from the device before it is read.
"""

import math
from functools import cache
from typing import Any, NamedTuple, TypeAlias, TypeVar

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
from linden.physics.state import BODY, SOURCES, VEHICLE_WORK
from linden.physics.step import GRAVITY_MPS2, begin_frame, run_frame
from linden.physics.vehicle.controls import set_controls
from linden.structured import StructuredArray
from linden.worlds_parts_gpu import BodiesOnDevice

cuda: Any = numba_cuda
"""What it offers it makes up as it is loaded: nothing of that is typed."""

OnDevice: TypeAlias = Any
"""An array of numba's on the device, or one of its records."""

Part = TypeVar("Part", Ground, Statics)

THREADS = 64
"""Of a block: the step needs as many registers as a thread can have."""

_PAIRS_A_WORLD, _PAIRS_A_BODY = 16, 8
"""Room for pairs; a world with more becomes invalid."""

_WORDS, _WORK_WORDS = BODY.itemsize // 8, VEHICLE_WORK.itemsize // 8

_MOST_LOCAL = 16
"""Bodies of a world that are copied into the local memory of its thread; there is a kernel for each number."""


class StepInputs(NamedTuple):
    """What a step reads, of all worlds: arrays on the device."""

    spec_of: OnDevice
    specs: OnDevice
    counts: OnDevice
    ground: Ground
    statics: Statics


class StepResults(NamedTuple):
    """What a step writes besides the states, world by world."""

    valid: OnDevice
    frames: OnDevice
    circles: OnDevice  # (W, S, 3)
    pairs: OnDevice  # (W, P, 2)
    near: OnDevice  # (W,) how many pairs there are
    account: OnDevice  # (W, P, ACCOUNT)


class DeviceColumn:
    """A column of all bodies on the device, as torch and CuPy take it without a copy."""

    def __init__(self, interface: dict[str, Any], owner: object) -> None:
        """Describe memory of ``owner`` by CUDA's array interface, version 3."""
        self.__cuda_array_interface__ = interface
        self._owner = owner


@cuda.jit(device=True)  # type: ignore[untyped-decorator] # numba has no hints for it
def _advance(
    rows: OnDevice,
    work: OnDevice,
    world: int,
    table: StepInputs,
    found: StepResults,
    dt_s: float,
    substeps: int,
    gravity: float,
) -> None:  # pragma: no cover - compiled
    """Step one world with the bodies ``rows``; ``work`` is scratch."""
    which, count = table.spec_of[world], table.counts[world]
    begin_frame(rows, which, table.specs, work, count, dt_s)
    reach = found.circles[world, :count]
    write_circles(rows, dt_s, reach)
    near = pairs_of_few(rows, reach, table.statics, found.pairs[world])
    if near > found.pairs.shape[1]:
        found.valid[world], found.near[world] = False, 0
        return
    found.near[world] = near
    own, entries = found.pairs[world, :near], found.account[world]
    for k in range(near):
        for column in range(ACCOUNT):
            entries[k, column] = 0.0
    run_frame(rows, which, table.specs, work, count, own, entries, table.ground, table.statics, dt_s, substeps, gravity)
    found.frames[world] += 1
    for i in range(count):
        for axis in range(3):
            if not abs(rows[i].position[axis]) < FARTHEST_M:
                found.valid[world] = False


def _step_kernel(slots: int, built_of: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel that steps worlds of at most ``slots`` bodies; the sources are part of the name of its file.

    A thread works on copies of its bodies and its scratch in local memory. A GPU interleaves the local memory of the
    threads of a warp, so all of them together read whole lines, where records lie 1,160 bytes apart.
    """
    room = slots * _WORDS

    @cuda.jit(cache=True)  # type: ignore[untyped-decorator] # numba has no hints for it
    def step(
        words: OnDevice, table: StepInputs, found: StepResults, dt_s: float, substeps: int, gravity: float
    ) -> None:  # pragma: no cover - compiled
        """Step the world of this thread; ``words`` (W, S * words of a body) are the states."""
        world = cuda.grid(1)
        if world >= len(table.counts) or not found.valid[world] or built_of < 0:
            return
        bodies = cuda.local.array(room, np.int64)
        scratch = cuda.local.array(_WORK_WORDS, np.int64)
        used = table.counts[world] * _WORDS
        for word in range(used):
            bodies[word] = words[world, word]
        _advance(bodies.view(BODY), scratch.view(VEHICLE_WORK)[0], world, table, found, dt_s, substeps, gravity)
        for word in range(used):
            words[world, word] = bodies[word]

    return step


def _step_kernel_of_many(built_of: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel that steps worlds of any number of bodies, which stay where they lie."""

    @cuda.jit(cache=True)  # type: ignore[untyped-decorator] # numba has no hints for it
    def step(
        state: OnDevice, table: StepInputs, found: StepResults, dt_s: float, substeps: int, gravity: float
    ) -> None:  # pragma: no cover - compiled
        """Step the world of this thread; ``state`` (W, S) are the bodies."""
        world = cuda.grid(1)
        if world >= len(table.counts) or not found.valid[world] or built_of < 0:
            return
        scratch = cuda.local.array(_WORK_WORDS, np.int64)
        _advance(state[world], scratch.view(VEHICLE_WORK)[0], world, table, found, dt_s, substeps, gravity)

    return step


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
        self._ground, self._statics = _copy(ground), _copy(statics)
        self.is_current = False

    def upload(self, table: BodyTable, first: BodyTable, valid: NDArray[np.bool_], frames: NDArray[np.int64]) -> None:
        """Copy the worlds to the device.

        Raises:
            UserError: they do not fit into its memory.
        """
        worlds, slots = table.state.shape
        room = _PAIRS_A_WORLD + _PAIRS_A_BODY * slots
        needed = 2 * table.state.nbytes + worlds * (24 * slots + (8 * ACCOUNT + 8) * room)
        free = float(cuda.current_context().get_memory_info()[0])
        if needed > free:
            raise UserError(
                f"{worlds} worlds of {slots} bodies need {needed / 2**30:.1f} GiB, and the device has "
                f"{free / 2**30:.1f} GiB free; make fewer worlds, or use device='cpu'"
            )
        self.state, self._first = cuda.to_device(table.state), cuda.to_device(_words(first.state))
        self.valid, self.frames = cuda.to_device(valid), cuda.to_device(frames)
        self._table = StepInputs(
            cuda.to_device(table.spec_of),
            cuda.to_device(table.specs),
            cuda.to_device(table.counts),
            self._ground,
            self._statics,
        )
        self._found = StepResults(
            self.valid,
            self.frames,
            cuda.device_array((worlds, slots, 3), np.float64),
            cuda.device_array((worlds, room, 2), np.int32),
            cuda.to_device(np.zeros(worlds, np.int32)),
            cuda.device_array((worlds, room, ACCOUNT), np.float64),
        )
        self.is_current = True

    def download(self, table: BodyTable, valid: NDArray[np.bool_], frames: NDArray[np.int64]) -> None:
        """Copy the worlds back into the tables of the host."""
        self.state.copy_to_host(table.state)
        self.download_marks(valid, frames)

    def download_marks(self, valid: NDArray[np.bool_], frames: NDArray[np.int64]) -> None:
        """Copy back which worlds are valid, and their numbers of steps."""
        self.valid.copy_to_host(valid)
        self.frames.copy_to_host(frames)

    @property
    def bodies(self) -> BodiesOnDevice:
        """The bodies of all worlds, to be read."""
        return BodiesOnDevice(self.state, self._table.spec_of, self._table.specs)

    def step(self, dt_s: float, substeps: int) -> None:
        """Advance all valid worlds; returns before the device is done."""
        worlds, slots = self.state.shape
        common = self._table, self._found, dt_s, substeps, GRAVITY_MPS2
        if slots <= _MOST_LOCAL:
            _launch(_step_of(slots), worlds, self._words_of_worlds(), *common)
        else:
            _launch(_step_of(0), worlds, self.state, *common)

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
        words = self._words_of_worlds()
        count = len(chosen) * words.shape[1]
        marks = self.valid, self.frames, self._found.near
        _launch(_copy_worlds, count, words, self._first, cuda.to_device(chosen), *marks)

    def _words_of_worlds(self) -> OnDevice:
        """Return the states as words (W, S * words of a body)."""
        return self.state.view(np.int64).reshape(self.state.shape[0], self.state.shape[1] * _WORDS)

    def touched(self) -> list[tuple[int, NDArray[np.int32], NDArray[np.float64]]]:
        """Return for each world with near pairs its number, the pairs (P, 2) and their accounts (P, ACCOUNT)."""
        found = self._found.near.copy_to_host()
        worlds = np.flatnonzero(found)
        if not len(worlds):
            return []
        pairs, account = self._found.pairs.copy_to_host(), self._found.account.copy_to_host()
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


@cache
def _step_of(slots: int) -> Any:  # noqa: ANN401 - numba's
    """Return the kernel for worlds of so many bodies; 0: of any number."""
    return _step_kernel(slots, SOURCES) if slots else _step_kernel_of_many(SOURCES)


def _launch(kernel: Any, count: int, *arguments: Any) -> None:  # noqa: ANN401 - numba's
    kernel[math.ceil(count / THREADS), THREADS](*arguments)


def _copy(part: Part) -> Part:
    """Return a copy of columns on the device."""
    return type(part)(*(cuda.to_device(np.ascontiguousarray(column)) for column in part))


def _words(state: NDArray[Any]) -> NDArray[np.int64]:
    """Return rows of BODY (W, S) as words (W, S * words)."""
    return state.view(np.int64).reshape(len(state), -1)
