"""Work beside other work: a thread that makes something, and how it is given up.

The threads are daemons: a process that is told to end does not wait for them. Those of ``concurrent.futures`` it would
wait for, and for ever where the signal came in the moment in which one was started.
"""

from collections.abc import Callable
from concurrent.futures import Future
from threading import Event, Thread, local
from typing import TypeAlias, TypeVar

Made = TypeVar("Made")


Unwanted: TypeAlias = Event
"""Set where what is being made is not wanted any more."""


class NotWantedError(Exception):
    """What a thread was making in the background is not wanted any more."""


_here = local()  # .unwanted: the Event by which the work of this thread is given up


def in_background(work: Callable[[], Made], unwanted: Unwanted | None = None) -> "Future[Made]":
    """Return what will have been made by a thread of its own, which may wait for others.

    ``unwanted`` gives it up: the work ends with a NotWantedError at its next :func:`checkpoint`.
    """
    made: Future[Made] = Future()

    def begin() -> None:
        _here.unwanted = unwanted
        carry_out(work, made)

    Thread(target=begin, name="background", daemon=True).start()
    return made


def checkpoint() -> None:
    """Break off work in the background that is not wanted any more; to be called between its parts.

    Raises:
        NotWantedError: it is not wanted.
    """
    unwanted = getattr(_here, "unwanted", None)
    if unwanted is not None and unwanted.is_set():
        raise NotWantedError


def carry_out(work: Callable[[], Made], done: "Future[Made]") -> None:
    """Do the work and note in ``done`` what it returned or raised."""
    try:
        done.set_result(work())
    except BaseException as error:  # noqa: BLE001 - it is raised again where the result is asked for
        done.set_exception(error)
