"""Decorators that compile functions with numba and cache them: `kernel`, `part`, `kept_part`, `unlocked`, `shading`.

``error_model="numpy"``: dividing by zero gives inf or nan, as arrays do. No ``fastmath`` and no threads: the same input
gives the same bits; what is seen has threads (``unlocked``), pictures both. The compiled code is kept beside the source
(numba's cache), so it is paid for once.
"""

import hashlib
import logging
import pickle
from collections.abc import Callable
from functools import update_wrapper
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar, cast

import llvmlite.binding
import numba
import numpy as np
from numba.core.caching import FunctionCache, IndexDataCacheFile

from linden.target import choose

log = logging.getLogger("linden")

_UNCOUNTED: dict[str, Any] = {"_nrt": False}
"""An option of numba's that its own type hints do not know."""

COMPILER_IS_OFF = bool(getattr(numba.config, "DISABLE_JIT", False))
"""Whether functions stay Python's, as NUMBA_DISABLE_JIT=1 asks for."""

TARGET = choose()
"""Name of the processor that kernels are compiled for."""

Function = TypeVar("Function", bound=Callable[..., object])


def _cached(function: Callable[..., object], **options: Any) -> Any:  # noqa: ANN401 - numba's own
    """Compile with numba and keep what was compiled; for this process only, where no folder can be written to.

    numba keeps it beside the source, or in the user's cache folder where that cannot be written to.
    """
    try:
        compiled = numba.njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError as error:
        if "no locator available" not in str(error):
            raise
        return numba.njit(error_model="numpy", **options)(function)
    if not COMPILER_IS_OFF:
        compiled._cache = _KernelCache(function)  # type: ignore[no-untyped-call] # noqa: SLF001 - as njit(cache=True)
    return compiled


class _KernelCache(FunctionCache):
    """numba's cache of one function; a file that cannot be read is made anew, and so is one of other sources."""

    sources = 0
    """Fingerprint of the files that the function calls, where they are not its own."""

    def _index_key(self, *of_function: object) -> tuple[object, ...]:
        key = super()._index_key(*of_function)  # type: ignore[no-untyped-call]
        return (*key, self.sources) if self.sources else key

    def _load_overload(self, *of_function: object) -> object:
        try:
            return super()._load_overload(*of_function) or self._shipped(*of_function)  # type: ignore[no-untyped-call]
        except (ImportError, AttributeError, EOFError, ValueError, pickle.UnpicklingError) as error:
            # such as of a class that had another place when the file was written
            log.info("%s is compiled anew: %s", self, error)
            self.flush()  # type: ignore[no-untyped-call]
            return None

    def _shipped(self, signature: object, target: Any) -> object:  # noqa: ANN401 - numba's context of a target
        """Return what a wheel has brought beside the source, where numba keeps its files elsewhere; else None."""
        beside = Path(self._py_func.__code__.co_filename).parent / "__pycache__"
        if beside == Path(self._cache_path):
            return None
        files: Any = IndexDataCacheFile(  # type: ignore[no-untyped-call]
            str(beside), self._impl.filename_base, self._impl.locator.get_source_stamp()
        )
        data = files.load(self._index_key(signature, target.codegen()))
        return None if data is None else self._impl.rebuild(target, data)


def kernel(function: Function) -> Function:
    """Compile ``function`` with numba at its first call; its Python form stays at ``.py_func``.

    For functions that call kernels of their own module only (of others, see :func:`part`).
    """
    return cast("Function", _cached(function))


def part(function: Function) -> Function:
    """Compile ``function`` into the kernels that call it; it keeps no file of its own that could outlive an edit.

    numba renews a kernel's file when the module it stands in changes, not when a module it calls changes. So a kernel
    across modules is built of parts, and carries a fingerprint of all their sources (see :func:`fingerprint`).
    """
    return cast("Function", numba.njit(error_model="numpy")(function))


def kept_part(sources: int) -> Callable[[Function], Function]:
    """Return a decorator that compiles as :func:`part` does, but keeps a file of its own.

    So several processes can compile the parts of one kernel at once. ``sources`` is the fingerprint of every file that
    the part calls. With another fingerprint the part is compiled anew.
    """

    def decorate(function: Function) -> Function:
        compiled = _cached(function)
        if not COMPILER_IS_OFF and compiled.stats.cache_path:
            compiled._cache.sources = sources  # noqa: SLF001 - as in _cached
        return cast("Function", compiled)

    return decorate


def unlocked(function: Function) -> Function:
    """Compile ``function`` as :func:`kernel` does, but let go of Python's lock while it runs.

    So threads may work on parts of one array at once; a function that writes no place twice gives the same bits
    however many there are.
    """
    return cast("Function", _cached(function, nogil=True))


def shading(function: Function) -> Function:
    """Compile as :func:`unlocked` does, and let sums be reordered: for light and colour, never for what is measured.

    It makes no arrays, so that numba need not count their references: that took as long as all the rest.
    Numbers written in it are of 32 bits (see :func:`shading_part`).
    """
    return cast("Function", _cached(_single(function), nogil=True, fastmath=True, **_UNCOUNTED))


def shading_part(function: Function) -> Function:
    """Compile into the kernels that call it, as :func:`part` does, with sums reordered, and always in place of a call.

    Numbers written in it, as 0.5, are taken for floats of 32 bits: beside one of 64 bits all others would become that,
    and a processor takes twice as many of 32 at once. So loops over such parts can be worked on eight at a time.
    Constants of a module that it uses have to be of 32 bits themselves, ``np.float32(0.5)``.
    """
    return cast(
        "Function", numba.njit(error_model="numpy", fastmath=True, forceinline=True, **_UNCOUNTED)(_single(function))
    )


def shading_stage(function: Function) -> Function:
    """Compile as :func:`shading_part` does, but as a function of its own: a loop that several kernels call."""
    return cast("Function", numba.njit(error_model="numpy", fastmath=True, **_UNCOUNTED)(_single(function)))


def _single(function: Callable[..., object]) -> Callable[..., object]:
    """Return the function with literal floats of 32 bits."""
    given = cast("FunctionType", function)
    code = given.__code__
    written = cast("tuple[object, ...]", _narrowed(code.co_consts))
    narrow = FunctionType(
        code.replace(co_consts=written), given.__globals__, given.__name__, given.__defaults__, given.__closure__
    )
    return cast("Callable[..., object]", update_wrapper(narrow, function))


def _narrowed(value: object) -> object:
    """Return a constant with its floats, and those of tuples in it, of 32 bits."""
    if type(value) is tuple:
        return tuple(map(_narrowed, value))
    return np.float32(value) if type(value) is float else value


def fingerprint(*sources: Path) -> int:
    """Return 62 bits that change with the text of any file given; a kernel that closes over them is renewed with it."""
    digest = hashlib.sha256()
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return int.from_bytes(digest.digest()[:8], "little") >> 2


def machine() -> str:
    """Return what else decides the last bits of a computed number: the versions of what computes, and the processor."""
    processor = f"{llvmlite.binding.get_host_cpu_name()} {llvmlite.binding.get_host_cpu_features().flatten()}"
    return f"numpy {np.__version__}, numba {numba.__version__}, {processor}, kernels for {TARGET}"
