"""The tests of the official client, each file in a process of its own: ``run_compat.py [pytest's options]``.

As many files at a time as WORKERS says (2); one at a time while the process runs whose number BESIDE gives.

That client's threads race each other: when it drops a stream that it has just asked for it may end its process
(``bad_weak_ptr``), and its Traffic Manager may miss the wake-up of a tick and stand still for ever, where no time-out
of Python's reaches it. docs/explanation/traffic.md and benchmarks/soak.py have the evidence. So a file whose process
was ended by a signal, or stood still, is run once more, and is said to have been; the second time counts. A test that
fails has failed.
"""

import os
import select
import selectors
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
SILENT_S = 360.0
"""Longer than any test may take by the time-out in pyproject.toml; a process that says nothing for so long is stuck."""
LAST_WORDS_S = 15.0
TRIES = 2
MEASURED = {**os.environ, "COVERAGE_OF_SERVERS": str(ROOT / "pyproject.toml")}
"""The client's process runs nothing of ours, so that the coverage of its servers alone is measured."""
NO_TESTS = 5
"""Of pytest, where options such as ``-k`` leave none in a file."""


def main(options: list[str]) -> int:
    """Run all files, some at a time; return 0 where all passed."""
    files = sorted((ROOT / "tests" / "compat").glob("test_*.py"))
    turns = Turns(int(os.environ.get("WORKERS", "2")), int(os.environ.get("BESIDE", "0")))
    with ThreadPoolExecutor(turns.workers) as workers:
        ended = list(workers.map(lambda file: turns.take(file.relative_to(ROOT).as_posix(), options), files))
    again = [sentence for end in ended for sentence in end.again]
    failed = [end.name for end in ended if end.code not in {0, NO_TESTS}]
    for sentence in again:
        print(f"run_compat: {sentence}")
    for name in failed:
        print(f"run_compat: {name} failed")
    return 1 if failed else 0


class Turns:
    """How many files run at a time: one while a neighbour runs, else as many as there are workers."""

    def __init__(self, workers: int, neighbour: int) -> None:
        """Watch the process of that number; 0 is none."""
        self.workers = workers
        self._first = threading.Lock()
        self._alone = threading.Event()
        if neighbour:
            threading.Thread(target=self._await_end, args=[neighbour], daemon=True).start()
        else:
            self._alone.set()

    def _await_end(self, neighbour: int) -> None:
        with suppress(ProcessLookupError):
            ending = os.pidfd_open(neighbour)
            select.select([ending], [], [])
            os.close(ending)
        self._alone.set()

    def take(self, name: str, options: list[str]) -> "Ended":
        """Run a file's tests when it is its turn."""
        while not self._alone.is_set():
            if self._first.acquire(timeout=1.0):
                try:
                    return told(name, options)
                finally:
                    self._first.release()
        return told(name, options)


class Ended(NamedTuple):
    """How the tests of a file ended."""

    name: str
    code: int
    again: tuple[str, ...]  # why it was run once more, in a sentence


def told(name: str, options: list[str]) -> Ended:
    """Run a file's tests, once more where the client took its process along, and show what they said."""
    again: list[str] = []
    code = 0
    for number in range(TRIES):
        code, said = run([sys.executable, "-m", "pytest", "--no-header", name, *options])
        with SHOWING:
            print(f"{name}{' once more' * (number > 0)}", flush=True)
            sys.stdout.buffer.write(said)
            sys.stdout.buffer.flush()
        if code >= 0:
            break
        again.append(f"{name}: its process {'stood still' if code == STUCK else f'was ended by signal {-code}'}")
    return Ended(name, code, tuple(again))


SHOWING = threading.Lock()
"""What one file said is shown in one piece."""

STUCK = -1000
"""Instead of a return code."""


def run(command: list[str], silent_s: float = SILENT_S) -> tuple[int, bytes]:
    """Run a command; return its code, minus the signal that ended it, or STUCK, and what it said."""
    said: list[bytes] = []
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, env=MEASURED
    ) as process:
        stuck = not _heard(process, said, silent_s)
        if stuck:
            process.send_signal(signal.SIGABRT)  # pytest then shows where each thread is
            _heard(process, said, LAST_WORDS_S)
        try:
            code = process.wait(LAST_WORDS_S)
        except subprocess.TimeoutExpired:
            stuck = True
        if stuck:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    return STUCK if stuck else code, b"".join(said)


def _heard(process: "subprocess.Popen[bytes]", said: list[bytes], silent_s: float) -> bool:
    """Hear a process until it says no more; return False where it is silent for too long first."""
    assert process.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        heard_s = time.monotonic()
        while time.monotonic() - heard_s < silent_s:
            if not selector.select(1.0):
                continue
            words = os.read(process.stdout.fileno(), 1 << 16)
            if not words:
                return True
            heard_s = time.monotonic()
            said.append(words)
    return False


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
