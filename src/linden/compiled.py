"""How functions are compiled: one decorator, so that every kernel is built alike and keeps its type for the reader.

``error_model="numpy"``: dividing by zero gives inf or nan, as arrays do. No ``fastmath`` and no threads: the same input
gives the same bits; what is seen has threads (``unlocked``), pictures both. The compiled code is kept beside the source
(numba's cache), so it is paid for once.
"""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import llvmlite.binding
import numba
import numpy as np

_UNCOUNTED: dict[str, Any] = {"_nrt": False}
"""An option of numba's that its own type hints do not know."""

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile ``function`` with numba at its first call; its Python form stays at ``.py_func``.

    For functions that call kernels of their own module only (of others, see :func:`part`).
    """
    return cast("Function", numba.njit(cache=True, error_model="numpy")(function))


def part(function: Function) -> Function:
    """Compile ``function`` into the kernels that call it; it keeps no file of its own that could outlive an edit.

    numba renews a kernel's file when the module it stands in changes, not when a module it calls changes. So a kernel
    across modules is built of parts, and carries a fingerprint of all their sources (see :func:`fingerprint`).
    """
    return cast("Function", numba.njit(error_model="numpy")(function))


def unlocked(function: Function) -> Function:
    """Compile ``function`` as :func:`kernel` does, but let go of Python's lock while it runs.

    So threads may work on parts of one array at once; a function that writes no place twice gives the same bits
    however many there are.
    """
    return cast("Function", numba.njit(cache=True, error_model="numpy", nogil=True)(function))


def shading(function: Function) -> Function:
    """Compile as :func:`unlocked` does, and let sums be reordered: for light and colour, never for what is measured.

    It makes no arrays, so that numba need not count who uses those it is given: that took as long as all the rest.
    """
    return cast(
        "Function", numba.njit(cache=True, error_model="numpy", nogil=True, fastmath=True, **_UNCOUNTED)(function)
    )


def shading_part(function: Function) -> Function:
    """Compile into the kernels that call it, as :func:`part` does, with sums reordered."""
    return cast("Function", numba.njit(error_model="numpy", fastmath=True, **_UNCOUNTED)(function))


def fingerprint(*sources: Path) -> int:
    """Return 62 bits that change with the text of any file given; a kernel that closes over them is renewed with it."""
    digest = hashlib.sha256()
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return int.from_bytes(digest.digest()[:8], "little") >> 2


def machine() -> str:
    """Return what else decides the last bits of a computed number: the versions of what computes, and the processor."""
    processor = f"{llvmlite.binding.get_host_cpu_name()} {llvmlite.binding.get_host_cpu_features().flatten()}"
    return f"numpy {np.__version__}, numba {numba.__version__}, {processor}"
