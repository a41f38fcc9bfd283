"""Compiled functions as plain Python: for comparisons on a few values, where compiling would take much longer."""

from types import FunctionType
from typing import Any

from numba.core.dispatcher import Dispatcher


def uncompiled(function: Any) -> Any:
    """Return the Python form of a function of numba's, with all that it calls in the same form."""
    return _plain(function, {})


def _plain(value: Any, known: dict[int, Any]) -> Any:
    if not isinstance(value, Dispatcher):
        return value
    code = value.py_func
    if id(code) not in known:
        names: dict[str, Any] = {}
        known[id(code)] = FunctionType(code.__code__, names, code.__name__, code.__defaults__, code.__closure__)
        names.update({name: _plain(each, known) for name, each in code.__globals__.items()})
    return known[id(code)]
