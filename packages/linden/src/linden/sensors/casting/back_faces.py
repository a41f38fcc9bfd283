"""Embree filter callback, compiled by numba: drops hits on back faces, so that a sensor inside a car sees out of it.

An RTCFilterFunctionN (embree4/rtcore_common.h), compiled: Embree calls it in the middle of its search, from whichever
thread is looking, with rays and hits in the frame of the body.
"""

from collections.abc import Callable
from typing import Any

import numba
from numba import types
from numba.extending import intrinsic

_VALID, _RAY, _HIT, _COUNT = 0, 3, 4, 5
"""Words of 8 bytes of RTCFilterFunctionNArguments: addresses of the mask, the rays and the hits, and how many."""
_TOWARDS, _NORMAL = 4, 0
"""Columns of the rays and of the hits in which three of a vector begin."""

_pointer: Any = types.CPointer  # numba's types have no types


def _numbers_at(kind: Any) -> Callable[[int], Any]:  # noqa: ANN401 - numba's types have no types
    """Return what gives a kernel the numbers of a kind that lie at an address."""

    def at(_typing: Any, address: Any) -> tuple[Any, Callable[..., Any]]:  # noqa: ANN401 - likewise
        def cast(context: Any, builder: Any, signature: Any, values: Any) -> Any:  # noqa: ANN401 - likewise
            return builder.inttoptr(values[0], context.get_value_type(signature.return_type))

        return _pointer(kind)(address), cast

    made: Any = intrinsic(at)
    found: Callable[[int], Any] = made
    return found


_floats_at, _whole_at = _numbers_at(types.float32), _numbers_at(types.int32)


def _refuse_inner_sides(given: Any) -> None:  # noqa: ANN401 - the address of Embree's arguments
    """Clear the mask of each hit with a normal that points the way its ray goes."""
    count = given[_COUNT] & 0xFFFFFFFF
    valid, ray, hit = _whole_at(given[_VALID]), _floats_at(given[_RAY]), _floats_at(given[_HIT])
    for k in range(count):
        along = ray[_TOWARDS * count + k] * hit[_NORMAL * count + k]
        along += ray[(_TOWARDS + 1) * count + k] * hit[(_NORMAL + 1) * count + k]
        along += ray[(_TOWARDS + 2) * count + k] * hit[(_NORMAL + 2) * count + k]
        if along > 0.0:
            valid[k] = 0


_kept: list[Any] = []
"""Embree calls the filter as long as the scene lives."""


def address() -> int:
    """Return where the filter lies in memory; compiled at the first call."""
    if not _kept:
        _kept.append(numba.cfunc(types.void(_pointer(types.intp)), cache=True)(_refuse_inner_sides))
    return int(_kept[0].address)
