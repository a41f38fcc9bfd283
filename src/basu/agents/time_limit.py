"""Calls into somebody else's code and comes back in time, whether that code sleeps, loops or answers.

In the main thread an interval timer's signal raises inside the call, at no cost that could be measured. Elsewhere, and
where there are no such signals (Windows), the call runs in a thread of its own that is left behind when it overruns.
"""

from __future__ import annotations

import queue
import signal
import threading
from typing import TYPE_CHECKING, NoReturn, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

T = TypeVar("T")
AGAIN_S = 0.2  # the signal is repeated: code that swallows every exception is interrupted in its next line too


class OverrunError(BaseException):
    """The call took too long. Not an ``Exception``: an agent's ``except Exception`` must not swallow it."""


def can_interrupt() -> bool:
    """Whether calls from here are limited by a signal rather than by a thread."""
    return hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread()


def call_within(limit_s: float, function: Callable[[], T]) -> T:
    """Call ``function``, at most for ``limit_s`` of wall time.

    Raises:
        OverrunError: the time is over.
    """
    return _call_interrupted(limit_s, function) if can_interrupt() else _call_abandoned(limit_s, function)


def _overrun(_signal: int, _frame: FrameType | None) -> NoReturn:
    raise OverrunError


def _call_interrupted(limit_s: float, function: Callable[[], T]) -> T:
    """With the interval timer of the main thread."""
    before = signal.signal(signal.SIGALRM, _overrun)
    try:
        signal.setitimer(signal.ITIMER_REAL, limit_s, AGAIN_S)
        try:
            return function()
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
    finally:
        signal.signal(signal.SIGALRM, before)


def _call_abandoned(limit_s: float, function: Callable[[], T]) -> T:
    """In a daemon thread that is not waited for any longer than the limit."""
    answers: queue.SimpleQueue[tuple[T | None, BaseException | None]] = queue.SimpleQueue()

    def work() -> None:
        try:
            answers.put((function(), None))
        except BaseException as error:  # noqa: BLE001 - handed over to the waiting thread, whatever it is
            answers.put((None, error))

    threading.Thread(target=work, name="basu-agent", daemon=True).start()
    try:
        answer, error = answers.get(timeout=limit_s)
    except queue.Empty:
        raise OverrunError from None
    if error is not None:
        raise error
    return answer  # type: ignore[return-value]  # no error: it is what the function returned
