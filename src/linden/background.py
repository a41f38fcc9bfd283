"""Work in the background: a thread that makes something, and how the work is given up.

The threads are daemons, because Python waits for any other thread without a limit when a process ends. But compiled
code of a daemon goes on while the libraries of the process are taken down, and ends the process by a signal. So a
process calls :func:`end_all` before it ends.
"""

import time
from collections.abc import Callable
from concurrent.futures import Future
from threading import Event, Thread, local
from typing import TypeAlias, TypeVar
from weakref import WeakSet

Made = TypeVar("Made")


Unwanted: TypeAlias = Event
"""Set where what is being made is not wanted any more."""


class NotWantedError(Exception):
    """What a thread was making in the background is not wanted any more."""


_here = local()  # .unwanted: the Event by which the work of this thread is given up
_threads: "WeakSet[Thread]" = WeakSet()
_ending = Event()  # the process ends: no work is wanted any more


def in_background(work: Callable[[], Made], unwanted: Unwanted | None = None) -> "Future[Made]":
    """Return what will have been made by a thread of its own, which may wait for others.

    ``unwanted`` gives it up: the work ends with a NotWantedError at its next :func:`checkpoint`.
    """
    made: Future[Made] = Future()

    def begin() -> None:
        _here.unwanted = Event() if unwanted is None else unwanted
        carry_out(work, made)

    thread = Thread(target=begin, name="background", daemon=True)
    _threads.add(thread)
    thread.start()
    return made


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


def carry_out(work: Callable[[], Made], done: "Future[Made]") -> None:
    """Do the work and note in ``done`` what it returned or raised."""
    try:
        done.set_result(work())
    except BaseException as error:  # noqa: BLE001 - it is raised again where the result is read
        done.set_exception(error)
