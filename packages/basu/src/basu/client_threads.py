"""Keeps the process alive when a thread of the official client fails, so that the record can be written.

Where a simulator falls silent, the client's Traffic Manager lets its time-out escape from its thread
(``TrafficManagerLocal::Run`` asks for the episode's settings), and C++ then ends the process: ``std::terminate``. With
:func:`hold` such a thread is put to sleep instead; the calls of the benchmark itself fail by their own time-outs, as
exceptions. A program that has held a thread must leave by :func:`leave`: C++ would wait for that thread at the
process's end.
"""

from __future__ import annotations

import ctypes
import os
import sys
import threading
import time
from typing import NoReturn

LIBRARY = "libstdc++.so.6"  # the official client's wheel for Linux is linked with it
SET_TERMINATE = "_ZSt13set_terminatePFvvE"  # std::set_terminate(void (*)())
A_WHILE_S = 3600.0

_held = threading.Event()


def _sleep_for_ever() -> None:
    """What C++ calls instead of ending the process; on the main thread nothing can be saved."""
    if threading.current_thread() is threading.main_thread():
        os.abort()
    _held.set()
    while True:
        time.sleep(A_WHILE_S)


_HANDLER = ctypes.CFUNCTYPE(None)(_sleep_for_ever)


def hold() -> None:
    """From now on, hold threads that fail; does nothing where the client's C++ library is another one."""
    try:
        set_terminate = getattr(ctypes.CDLL(LIBRARY), SET_TERMINATE)
    except (OSError, AttributeError):
        return
    set_terminate.restype, set_terminate.argtypes = ctypes.c_void_p, [type(_HANDLER)]
    set_terminate(_HANDLER)


def is_held() -> bool:
    """Whether a thread was held."""
    return _held.is_set()


def leave(code: int) -> NoReturn:
    """End the process at once, with everything said."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
