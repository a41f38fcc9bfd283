"""The server as a process of its system: its signals, its output, its limit of open files."""

import logging
import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType, TracebackType
from typing import TextIO

from typing_extensions import Self

from linden.background import end_all
from linden.server.rpc.warning_log import LogFilter

GRACE_S = 1.0
"""How long what is being done at a signal may take: any call but the loading of an unusual map."""
MOST_FILES = 20_000
"""What the limit of open files is raised to where the system allows it: all connections the server takes, and more."""
LAST_WORK_S = 3.0
"""How long the end of the process waits for work in the background: the largest part of a scene takes a second."""
WHOLE_WRITE_BYTES = 4096
"""What a pipe that can be written to takes without making the writer wait (PIPE_BUF of Linux)."""


class Ending:
    """While it lasts, SIGINT and SIGTERM end the program with 0, whatever it is doing; the old handlers come back."""

    def __enter__(self) -> Self:
        self._ask: Callable[[], None] | None = None
        self._reminder: threading.Timer | None = None
        self._before = {number: signal.signal(number, self._signalled) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, kind: type[BaseException] | None, _error: BaseException | None, _: TracebackType | None) -> None:
        if self._reminder is not None:
            self._reminder.cancel()
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def ask_first(self, stop: Callable[[], None]) -> None:
        """From now on ask by ``stop`` and wait :data:`GRACE_S`, or for the second signal, before breaking off."""
        self._ask = stop

    def _signalled(self, number: int, _frame: FrameType | None) -> None:
        ask = None if self._reminder is not None else self._ask
        self._remind(number)
        if ask is None:
            raise SystemExit(0)  # where a callback of the compiler's swallows it, the reminder comes again
        ask()

    def _remind(self, number: int) -> None:
        """Send the signal again after a moment."""
        if self._reminder is not None:
            self._reminder.cancel()
        self._reminder = threading.Timer(GRACE_S, signal.raise_signal, (number,))
        self._reminder.daemon = True
        self._reminder.start()


@contextmanager
def broken_off_cleanly() -> Iterator[None]:
    """Let SIGINT and SIGTERM end a long command as an exit, so that it takes away what it left half done."""
    before = {number: signal.signal(number, _break_off) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _break_off(number: int, _frame: FrameType | None) -> None:
    raise SystemExit(128 + number)  # as the shell counts it


class LossyHandler(logging.StreamHandler):  # type: ignore[type-arg] # subscripted at run time only from Python 3.11 on
    """Writes the log to stderr. A full pipe loses lines and never stops the server."""

    def __init__(self) -> None:
        super().__init__(sys.stderr or _nowhere())
        self._lost = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Write a line, in parts that a pipe takes at once, or count it as lost."""
        line = (self.format(record) + "\n").encode(errors="backslashreplace")
        if self._lost:
            line = f"linden: {self._lost} lines of the log are lost here, because stderr was not read\n".encode() + line
        for start in range(0, len(line), WHOLE_WRITE_BYTES):
            if not self._takes(line[start : start + WHOLE_WRITE_BYTES]):
                self._lost += 1
                return
        self._lost = 0

    def _takes(self, part: bytes) -> bool:
        """Write a part if that can be done at once."""
        try:
            output = self.stream.fileno()
        except (OSError, ValueError):  # replaced by something that is no file, as tests do; it cannot make us wait
            self.stream.write(part.decode())
            return True
        try:
            if hasattr(select, "poll"):
                ready = select.poll()
                ready.register(output, select.POLLOUT)
                if not ready.poll(0):
                    return False
            os.write(output, part)
        except OSError:  # closed, or the disk is full
            return False
        return True


def _nowhere() -> TextIO:
    """Return what takes the log of a process that was started without stderr."""
    return Path(os.devnull).open("w", encoding="utf-8")


def write_log(level: str) -> None:
    """Write the server's log to stderr from a level on; the compiler's own log is left out."""
    logging.basicConfig(level=logging.WARNING, handlers=[LossyHandler()], format="linden: %(levelname)s: %(message)s")
    log = logging.getLogger("linden")
    log.setLevel(level)
    log.addFilter(LogFilter())


def allow_connections() -> None:
    """Raise the limit of open files, which is often 1024, as far as this user may."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = MOST_FILES if hard == resource.RLIM_INFINITY else min(hard, MOST_FILES)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


@contextmanager
def background_work_ended() -> Iterator[None]:
    """At the end of the block, wait for work in the background; end the process at once, with 0, where it goes on.

    Compiled code that still runs while the process takes its libraries down would end it by a signal. An error is
    raised all the same, since its message is still to be written.
    """
    has_failed = False
    try:
        yield
    except Exception:
        has_failed = True
        raise
    finally:
        if not end_all(LAST_WORK_S) and not has_failed:
            logging.shutdown()
            with suppress(OSError):  # a closed pipe, a full disk
                sys.stdout.flush()
            os._exit(0)


def give_up_stdout() -> None:
    """Discard all further output, because its reader has closed it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
