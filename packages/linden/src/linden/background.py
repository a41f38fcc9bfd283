"""Work in the background: a thread that makes something, and how the work is given up.

The threads are daemons, because Python waits for any other thread without a limit when a process ends. But compiled
code of a daemon goes on while the libraries of the process are taken down, and ends the process by a signal. So a
process calls :func:`end_all` before it ends.
"""

import ctypes
import gc
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from threading import Event, Lock, Thread, local
from types import TracebackType
from typing import TypeAlias, TypeVar
from weakref import WeakSet

from linden.errors import LindenError

Made = TypeVar("Made")


Unwanted: TypeAlias = Event
"""Set where what is being made is not wanted any more."""


class NotWantedError(Exception):
    """What a thread was making in the background is not wanted any more."""


_LOOK_S = 0.1
"""How often a thread that waits for its turn looks whether its work is still wanted."""
_here = local()  # .unwanted: the Event by which the work of this thread is given up
_threads: "WeakSet[Thread]" = WeakSet()
_ending = Event()  # the process ends: no work is wanted any more

_YOUNG = (20_000, 1_000_000_000, 1_000_000_000)
"""Thresholds of Python's garbage collector: it looks at 20,000 values at a time, which takes some 3 ms."""
_lock = Lock()
_spared: list[tuple[int, int, int]] = []  # the thresholds before, once for each block of young_collector
_M_ARENA_MAX = -8  # mallopt(3): most heaps that threads share
_SETTLED_S = 1.0
"""How long after the end of work its memory is returned."""
_returns: list[None] = []  # one for each time that memory is to be returned and was not yet


def in_background(work: Callable[[], Made], unwanted: Unwanted | None = None) -> "Future[Made]":
    """Return what will have been made by a thread of its own, which may wait for others.

    ``unwanted`` gives it up: the work ends with a NotWantedError at its next :func:`checkpoint`.
    """
    made: Future[Made] = Future()

    def begin() -> None:
        _here.unwanted = Event() if unwanted is None else unwanted
        with young_collector():
            carry_out(work, made)
        give_memory_back()

    _start(begin)
    return made


def share_one_heap() -> None:
    """Let all threads of this process allocate from one heap of the C library, so that its free memory can be returned.

    By default glibc makes a heap for each thread, and ``malloc_trim`` never returns the end of any but the first. One
    large map in the background left 30 MB. To be called before threads begin; other C libraries ignore it.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_ARENA_MAX, 1)


def give_memory_back() -> None:
    """Return memory that is free to the system, as soon as what was made by work that has just ended is given up.

    That takes the next call or frame, or more, so this happens a second later, in a thread of its own. Only glibc can
    do it (``malloc_trim``); another C library keeps all of it.
    """
    with _lock:
        _returns.append(None)
        if len(_returns) > 1:
            return  # the thread below goes round once more
    _start(_return_memory)


def _return_memory() -> None:
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    while True:
        asked = len(_returns)
        if not _ending.wait(_SETTLED_S) and trim is not None:
            trim(0)
        with _lock:
            if len(_returns) == asked or _ending.is_set():
                _returns.clear()
                return


def _start(work: Callable[[], None]) -> None:
    """Start a thread that ``end_all`` waits for."""
    thread = Thread(target=work, name="background", daemon=True)
    _threads.add(thread)
    thread.start()


@contextmanager
def young_collector() -> Iterator[None]:
    """Let Python look for garbage among the newest values only, in all threads, as long as such a block runs.

    A large map makes a million values, none of which is garbage. A look at all of them holds Python's lock for 0.3 s,
    and without this there is one whenever they have grown by a quarter.
    """
    with _lock:
        _spared.append(gc.get_threshold())
        gc.set_threshold(*_YOUNG)
    try:
        yield
    finally:
        with _lock:
            before = _spared.pop()
            if not _spared:
                gc.set_threshold(*before)


def end_all(at_most_s: float) -> bool:
    """Give up all work in the background and wait for its threads; return whether all have ended in time.

    To be called at the end of a command. Work that begins meanwhile is given up at its first checkpoint. Where all
    work has ended in time, later work goes on as ever: a Python program can run several commands.
    """
    _ending.set()
    until_s = time.monotonic() + at_most_s
    while running := [thread for thread in tuple(_threads) if thread.is_alive()]:
        running[0].join(max(0.0, until_s - time.monotonic()))
        if time.monotonic() >= until_s and any(thread.is_alive() for thread in running):
            return False
    _ending.clear()
    return True


def checkpoint() -> None:
    """Break off work in the background that is not wanted any more; to be called between its parts.

    Raises:
        NotWantedError: it is not wanted.
    """
    unwanted = getattr(_here, "unwanted", None)
    if unwanted is not None and (unwanted.is_set() or _ending.is_set()):
        raise NotWantedError


class OneAtATime:
    """Lets one thread at a time into its ``with`` block; a thread that waits gives up once its work is not wanted."""

    def __init__(self) -> None:
        self._taken = Lock()

    def __enter__(self) -> None:
        """Wait for the turn.

        Raises:
            NotWantedError: as of :func:`checkpoint`.
        """
        while not self._taken.acquire(timeout=_LOOK_S):
            checkpoint()

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        """Let the next thread in."""
        self._taken.release()


def carry_out(work: Callable[[], Made], done: "Future[Made]") -> None:
    """Do the work and note in ``done`` what it returned or raised."""
    try:
        done.set_result(work())
    except (LindenError, NotWantedError) as error:  # their frames hold all that was made so far
        error.__cause__ = error.__context__ = None
        done.set_exception(error.with_traceback(None))
    except BaseException as error:  # noqa: BLE001 - it is raised again where the result is read
        done.set_exception(error)
