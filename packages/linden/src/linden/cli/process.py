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
LAST_WORK_S = 0.8
"""How long the end of the process waits for work in the background, after :data:`GRACE_S`: a user waits 2 s at most."""
AT_ONCE_S = 0.4
"""How long a break-off in Python may take; where the main thread is in compiled code, none comes."""
WHOLE_WRITE_BYTES = 4096
"""What a pipe that can be written to takes without making the writer wait (PIPE_BUF of Linux)."""


class Ending:
    """While it lasts, SIGINT and SIGTERM end the program with 0, whatever it is doing; the old handlers come back.

    Python runs handlers between two steps of the main thread, and a kernel may take long. So a thread reads the signals
    too, as Python's own handler writes them to a pipe at once. It ends the process if the main thread does not.
    """

    def __enter__(self) -> Self:
        self._ask: Callable[[], None] | None = None
        self._signals = 0
        self._signals_read, self._signals_written = os.pipe()
        os.set_blocking(self._signals_written, False)
        self._pipe_before = signal.set_wakeup_fd(self._signals_written, warn_on_full_buffer=False)
        self._before = {number: signal.signal(number, self._signalled) for number in (signal.SIGINT, signal.SIGTERM)}
        threading.Thread(target=self._watch, name="signals", daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, _error: BaseException | None, _: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._pipe_before)
        os.close(self._signals_written)  # the thread reads the end of the pipe, and ends

    def ask_first(self, stop: Callable[[], None]) -> None:
        """From now on ask by ``stop`` and wait :data:`GRACE_S`, or for the second signal, before breaking off."""
        self._ask = stop

    def _signalled(self, _number: int, _frame: FrameType | None) -> None:
        self._signals += 1
        if self._signals > 1 or self._ask is None:
            raise SystemExit(0)  # where a callback of the compiler's swallows it, the thread sends it again
        self._ask()

    def _watch(self) -> None:
        """Send the first signal again after :data:`GRACE_S`, and end the process if that does not."""
        with os.fdopen(self._signals_read, "rb", buffering=0) as signals:
            number = signals.read(1)
            if not number:
                return
            again, _, _ = select.select([signals], [], [], GRACE_S)
            if not again:
                signal.raise_signal(number[0])
            if signals.read(1) == b"":
                return
            over, _, _ = select.select([signals], [], [], AT_ONCE_S)
            if over and signals.read(1) == b"":
                return
            end_now()


def end_now() -> None:
    """End the process with 0 without running anything more, after its output is written."""
    logging.shutdown()
    with suppress(OSError, ValueError):  # a closed pipe, a full disk
        sys.stdout.flush()
    os._exit(0)


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
            end_now()


def give_up_stdout() -> None:
    """Discard all further output, because its reader has closed it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
