"""A GPU as kernels of numba's use it: memory, one stream of work, and pictures on their way back.

Warp casts rays there (``warp_caster``); numba compiles the very loops that shade on the CPU for the GPU as well. Needs
the extra ``gpu``.
"""

import ctypes
import math
import weakref
from collections import defaultdict
from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import DTypeLike, NDArray

THREADS = 128
"""Of a block: enough to hide what memory takes, few enough for kernels as thirsty for registers as the shading."""


class Gpu:
    """Memory and work on one device."""

    def __init__(self, number: int, stream: int) -> None:
        """Take CUDA's device of this number; ``stream`` is CUDA's too: work on it is done in the order it came in."""
        cuda.select_device(number)
        self.stream = cuda.external_stream(stream)
        self._frames: dict[tuple[tuple[int, ...], str], list[NDArray[Any]]] = defaultdict(list)

    def empty(self, shape: tuple[int, ...], dtype: DTypeLike) -> Any:  # noqa: ANN401 - an array of numba's
        """Return an array on the device."""
        return cuda.device_array(shape, np.dtype(dtype), stream=self.stream)

    def put(self, values: NDArray[Any]) -> Any:  # noqa: ANN401 - an array of numba's
        """Return a copy on the device."""
        return cuda.to_device(np.ascontiguousarray(values), stream=self.stream)

    def launch(self, kernel: Any, count: int, *arguments: Any) -> None:  # noqa: ANN401 - numba's
        """Run a kernel for each of ``count`` numbers, which is its last argument."""
        if count:
            kernel[math.ceil(count / THREADS), THREADS, self.stream](*arguments, count)

    def fetched(self, array: Any) -> NDArray[Any]:  # noqa: ANN401 - an array of numba's
        """Return a copy of an array on the host, once all work before it is done.

        It lies in memory that the device writes to by itself, which takes long to get; so it is used again when
        nobody holds the copy any more.
        """
        waiting = self._frames[array.shape, np.dtype(array.dtype).str]
        frame = waiting.pop() if waiting else cuda.pinned_array(array.shape, array.dtype)
        array.copy_to_host(frame, stream=self.stream)
        self.stream.synchronize()
        held = (ctypes.c_char * frame.nbytes).from_address(frame.ctypes.data)
        weakref.finalize(held, waiting.append, frame)  # every view of the copy holds it
        return np.frombuffer(held, array.dtype).reshape(array.shape)
