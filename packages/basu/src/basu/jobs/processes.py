"""Workers that are processes of this machine, each at the other end of a pipe."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import traceback
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Any

from basu import client_threads
from basu.errors import BasuError
from basu.jobs.job import After, Died, JobOutcome, PlayerSpec, Ready, refusal, versions
from basu.parent_end import end_with_parent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.jobs.job import PlayerAnswer

END_LIMIT_S = 10.0  # of wall time for a worker to end by itself


class ProcessWorker:
    """A process with its pipe."""

    def __init__(self, spec: PlayerSpec) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        is_main = threading.current_thread() is threading.main_thread()
        # the system ends a child with the thread that started it: only the main thread lives as long as the process
        # not multiprocessing's "spawn": it would run a user's script again, unless that guards its main part
        self.process = subprocess.Popen(  # noqa: S603 - our own module
            worker_command(theirs.fileno(), os.getpid() if is_main else 0),
            stdin=subprocess.DEVNULL,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        self._send(spec)

    def give(self, data: Any) -> None:  # noqa: ANN401 - plain data of a job
        """Send a job's data."""
        self._send((data,))

    def answer(self) -> PlayerAnswer:
        """The next answer, which has come."""
        try:
            answer: PlayerAnswer = self.connection.recv()
        except (EOFError, OSError):
            self.end(at_once=False)
            return Died(f"its process ended with exit status {self.process.returncode}")
        return answer

    def end(self, *, at_once: bool) -> None:
        """Wait until its process has ended; kill it at once, or after ``END_LIMIT_S``."""
        self.connection.close()
        if at_once:
            self.process.kill()
        try:
            self.process.wait(END_LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def _send(self, message: object) -> None:
        with contextlib.suppress(OSError):  # the process has ended, which its pipe shows
            self.connection.send(message)


class Processes:
    """The backend of a `basu.jobs.pool.Pool`."""

    def __init__(self, spec: PlayerSpec) -> None:
        """Take the player that every worker opens."""
        self._spec = spec

    def start(self) -> ProcessWorker:
        """Start a process."""
        return ProcessWorker(self._spec)

    def answers(self, workers: Sequence[ProcessWorker], timeout_s: float) -> list[tuple[ProcessWorker, PlayerAnswer]]:
        """Wait until some have answered."""
        by_connection: dict[Any, ProcessWorker] = {worker.connection: worker for worker in workers}
        return [(by_connection[each], by_connection[each].answer()) for each in wait(list(by_connection), timeout_s)]

    def close(self) -> None:
        """Do nothing, because the workers hold nothing open."""


def worker_command(descriptor: int, parent: int) -> list[str]:
    """The command that starts a worker, which inherits its end of the pipe as ``descriptor`` and ends with ``parent``.

    ``parent`` is a process's id; with 0 the worker ends when it next uses its pipe.
    """
    return [sys.executable, "-c", f"from {main.__module__} import main; main()", str(descriptor), str(parent)]


def main() -> None:
    """Work at a pipe; its descriptor is the first argument, the parent's process id the second."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command, which ends its workers
    parent = int(sys.argv[2])
    if parent and sys.platform == "linux":
        end_with_parent()
        if os.getppid() != parent:  # it ended before the call
            sys.exit(1)
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):  # the command has ended
        work(Connection(int(sys.argv[1])))
    if client_threads.is_held():
        client_threads.leave(0)


def work(connection: Connection) -> None:
    """Play the jobs that come through a pipe, and answer through it; the player comes first."""
    spec: PlayerSpec = connection.recv()
    try:
        with spec.open() as play:
            connection.send(Ready(versions()))
            after = After.GO_ON
            while after is After.GO_ON:
                (data,) = connection.recv()
                played: JobOutcome = play(data)
                connection.send(played)
                after = played.after
    except BasuError as error:
        connection.send(refusal(error))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:  # noqa: BLE001 - a bug of ours: shown in full, and the job is tried again elsewhere
        traceback.print_exc()
        connection.send(Died(f"it raised {''.join(traceback.format_exception_only(error)).strip()}"))
