"""How functions are compiled: one decorator, so that every kernel is built alike and keeps its type for the reader.

``error_model="numpy"``: dividing by zero gives inf or nan, as arrays do. No ``fastmath`` and no threads: the same input
gives the same bits. The compiled code is kept beside the source (numba's cache), so it is paid for once.
"""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile ``function`` with numba at its first call; its Python form stays at ``.py_func``."""
    return cast("Function", numba.njit(cache=True, error_model="numpy")(function))
