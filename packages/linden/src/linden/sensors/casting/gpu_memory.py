"""`Gpu`: a CUDA device shared by numba and Warp (arrays, copies, launches, graphs); `UploadBuffer` for repeated inputs.

Warp casts rays there (``warp_caster``); numba compiles the very loops that shade on the CPU for the GPU as well. Needs
the extra ``gpu``.
"""

import ctypes
import math
import weakref
from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numba
import numpy as np
import warp as wp
from numba import cuda as numba_cuda
from numpy.typing import DTypeLike, NDArray

cuda: Any = numba_cuda
"""What it offers it makes up as it is loaded: nothing of that is typed."""

THREADS = 128
"""Of a block: enough to hide what memory takes, few enough for kernels as thirsty for registers as the shading."""

_ALIGNED = 256  # bytes: where arrays begin that numba makes itself

numba.config.CUDA_LOW_OCCUPANCY_WARNINGS = 0  # type: ignore[attr-defined] # small pictures are small


class SharedBuffer(NamedTuple):
    """Memory that is written here and read on a device, at the same place each time."""

    here: NDArray[np.uint8]
    there: Any  # an array of numba's
    send: Callable[[], None]


class Gpu:
    """Memory of a device, and work that is done there in the order it came in.

    Attributes:
        queue: Warp's stream of the work.
    """

    def __init__(self, device: str, queue: wp.Stream | None = None) -> None:
        """Take a device as Warp names it; without a queue of its own, the one that Warp works on by itself."""
        self._device = wp.get_device(device)
        cuda.select_device(self._device.ordinal)
        self.queue = wp.get_stream(self._device) if queue is None else queue
        self._stream = cuda.external_stream(self.queue.cuda_stream)
        self._frames: dict[int, list[Any]] = defaultdict(list)

    def beside(self) -> "Gpu":
        """Return the same device for work that goes on beside this one's."""
        return Gpu(self._device, wp.Stream(self._device))

    def after(self, other: "Gpu") -> None:
        """Let what comes from now on wait for what ``other`` was given until now."""
        self.queue.wait_stream(other.queue)

    def empty(self, shape: tuple[int, ...], dtype: DTypeLike) -> Any:  # noqa: ANN401 - an array of numba's
        """Return an array on the device."""
        return cuda.device_array(shape, np.dtype(dtype), stream=self._stream)

    def put(self, values: NDArray[Any]) -> Any:  # noqa: ANN401 - an array of numba's
        """Return a copy on the device, which is there when this returns."""
        copy = cuda.to_device(np.ascontiguousarray(values), stream=self._stream)
        self._stream.synchronize()
        return copy

    def shared_buffer(self, size: int) -> SharedBuffer:
        """Return memory of so many bytes, here and there."""
        here = wp.zeros(size, dtype=wp.uint8, device="cpu", pinned=True)
        there = wp.zeros(size, dtype=wp.uint8, device=self._device)
        return SharedBuffer(
            here.numpy(), cuda.as_cuda_array(there, sync=False), lambda: wp.copy(there, here, stream=self.queue)
        )

    def view(self, array: Any) -> Any:  # noqa: ANN401 - from numba to Warp
        """Return an array (N,) or (N, 3) of numba's as Warp has it; it has to outlive what is returned."""
        kind = wp.vec3 if len(array.shape) == 2 else wp.dtype_from_numpy(array.dtype)
        pointer = array.device_ctypes_pointer.value
        return wp.array(ptr=pointer, dtype=kind, shape=array.shape[0], device=self._device, capacity=array.nbytes)

    def launch(self, kernel: Any, count: int, *arguments: Any) -> None:  # noqa: ANN401 - numba's
        """Run a kernel in ``count`` threads or a few more."""
        kernel[math.ceil(count / THREADS), THREADS, self._stream](*arguments)

    def fetching(self, array: Any) -> Callable[[], NDArray[Any]]:  # noqa: ANN401 - an array of numba's
        """Have an array copied to the host once all work before is done; return what waits for the copy and returns it.

        It lies in memory that the device writes to by itself, which takes long to get; so it is used again when
        the copy is not referenced any more.
        """
        size, waiting = array.nbytes, self._frames[array.nbytes]
        frame = waiting.pop() if waiting else wp.empty(size, dtype=wp.uint8, device="cpu", pinned=True)
        pointer = array.device_ctypes_pointer.value
        there = wp.array(ptr=pointer, dtype=wp.uint8, shape=size, device=self._device, capacity=size)
        wp.copy(frame, there, stream=self.queue)

        def fetched() -> NDArray[Any]:
            wp.synchronize_stream(self.queue)
            held = (ctypes.c_char * size).from_address(frame.ptr)
            weakref.finalize(held, waiting.append, frame)  # every view of the copy holds it
            return np.frombuffer(held, array.dtype).reshape(array.shape)

        return fetched

    def capture(self, work: Callable[[], None]) -> Any:  # noqa: ANN401 - a graph of Warp's
        """Return what ``work`` would have launched, to be launched by ``replay`` at once and again and again."""
        with cuda.defer_cleanup(), wp.ScopedCapture(stream=self.queue, force_module_load=False) as capture:
            work()
        return capture.graph

    def replay(self, graph: Any) -> None:  # noqa: ANN401 - a graph of Warp's
        """Launch the captured kernels again."""
        wp.capture_launch(graph, stream=self.queue)


class UploadBuffer:
    """Arrays that go to a GPU together, again and again, and lie at the same place there each time.

    Attributes:
        moves: how often that place has changed, since an array had become longer than there was room for.
    """

    def __init__(self, gpu: Gpu) -> None:
        self.moves = 0
        self._gpu = gpu
        self._room: dict[str, int] = {}
        self._shared: SharedBuffer | None = None
        self._slots: dict[str, tuple[NDArray[Any], Any]] = {}

    def send(self, inputs: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the arrays on the device, each as long as there is room for; what is sent is at its beginning.

        The names, dtypes and trailing shapes are the same each time. What was sent before must have been read.
        """
        if any(len(shared_buffer) > self._room.get(name, -1) for name, shared_buffer in inputs.items()):
            self._make_room(inputs)
        for name, shared_buffer in inputs.items():
            self._slots[name][0][: len(shared_buffer)] = shared_buffer
        assert self._shared is not None
        self._shared.send()
        return {name: there for name, (_, there) in self._slots.items()}

    def _make_room(self, inputs: Mapping[str, NDArray[Any]]) -> None:
        """Lay all arrays out anew, with room for twice as many rows where there were too few."""
        self.moves += 1
        starts, end = {}, 0
        for name, shared_buffer in inputs.items():
            if len(shared_buffer) > self._room.get(name, -1):
                self._room[name] = max(1, len(shared_buffer) if self.moves == 1 else 2 * len(shared_buffer))
            starts[name] = end
            row = shared_buffer.dtype.itemsize * math.prod(shared_buffer.shape[1:])
            end += -(-self._room[name] * row // _ALIGNED) * _ALIGNED
        self._shared = self._gpu.shared_buffer(end)
        for name, shared_buffer in inputs.items():
            shape = (self._room[name], *shared_buffer.shape[1:])
            span = slice(starts[name], starts[name] + shared_buffer.dtype.itemsize * math.prod(shape))
            self._slots[name] = tuple(  # type: ignore[assignment] # the two of them
                side[span].view(shared_buffer.dtype).reshape(shape) for side in self._shared[:2]
            )
