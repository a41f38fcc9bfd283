"""The tests of the official client, in processes of their own: ``run_compat.py [pytest's options]``.

As many processes at a time as WORKERS says (2); one at a time while the process runs whose number BESIDE gives.
Some files share a process and a server (``TOGETHER``), because a start of both takes 3 s of processor time.

That client's threads race each other: when it drops a stream that it has just asked for it may end its process
(``bad_weak_ptr``), and its Traffic Manager may miss the wake-up of a tick and stand still for ever, where no time-out
of Python's reaches it. docs/explanation/traffic.md and benchmarks/soak.py have the evidence. So files whose process
was ended by a signal, or stood still, are run once more, and are said to have been; the second time counts. A test that
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
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests"))

import processor_time  # noqa: E402 - of the tests

SILENT_S = 360.0
"""Longer than any test may take by the time-out in pyproject.toml; a process that says nothing for so long is stuck."""
RESTS_S, RESTS_USED_S = 90.0, 0.5
"""So is one that says nothing for 90 s and uses less than half a second of processor time in them, with all that it
started: no test sleeps that long, and the busiest machine gives a test that computes more."""
LAST_WORDS_S = 15.0
TRIES = 2
MEASURED = {**os.environ, "COVERAGE_OF_SERVERS": str(ROOT / "pyproject.toml")}
"""The client's process runs nothing of ours, so that the coverage of its servers alone is measured."""
NO_TESTS = 5
"""Of pytest, where options such as ``-k`` leave none in a file."""
Files = tuple[str, ...]
TOGETHER: tuple[Files, ...] = (
    ("actors", "client_quirks", "components", "environment"),
    ("cameras", "scene", "sensing", "sensors", "unreal"),
    ("clients", "lights", "props"),
    ("determinism", "every_method", "truth_of_runs"),
    ("fuzz", "fuzz_sessions"),
    ("scenario_calls", "truth_of_motion", "truth_on_a_street", "vehicle_forces"),
    ("vehicle_parts", "vehicles", "walkers"),
)
"""Files whose tests use the common server alone, begin an episode each, and do not count what the server holds.

The fourth row starts servers for each drive. In the last, the first file counts sentences of the log.
"""
UNMEASURED = {f"tests/compat/test_{name}.py" for name in ("clients_at_their_worst", "traffic", "under_attack")}
"""Files of which the servers take lines that other tests reach."""


def main(options: list[str]) -> int:
    """Run all files, some at a time; return 0 where all passed."""
    groups = grouped(path.relative_to(ROOT).as_posix() for path in (ROOT / "tests" / "compat").glob("test_*.py"))
    turns = Turns(int(os.environ.get("WORKERS", "2")), int(os.environ.get("BESIDE", "0")))
    with ThreadPoolExecutor(turns.workers) as workers:
        ended = list(workers.map(lambda files: turns.take(files, options), groups))
    again = [sentence for end in ended for sentence in end.again]
    failed = [end.name for end in ended if end.code not in {0, NO_TESTS}]
    for sentence in again:
        print(f"run_compat: {sentence}")
    for name in failed:
        print(f"run_compat: {name} failed")
    return 1 if failed else 0


def grouped(files: Iterable[str]) -> list[Files]:
    """Return the files that share a process, in one order always; a file that ``TOGETHER`` lacks is alone."""
    place = {f"tests/compat/test_{name}.py": number for number, names in enumerate(TOGETHER) for name in names}
    groups: dict[str | int, list[str]] = {}
    for file in sorted(files):
        groups.setdefault(place.get(file, file), []).append(file)
    return [tuple(group) for group in groups.values()]


class Turns:
    """How many processes run at a time: one while a neighbour runs, else as many as there are workers."""

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

    def take(self, files: Files, options: list[str]) -> "Ended":
        """Run the tests of some files when it is their turn."""
        while not self._alone.is_set():
            if self._first.acquire(timeout=1.0):
                try:
                    return told(files, options)
                finally:
                    self._first.release()
        return told(files, options)


class Ended(NamedTuple):
    """How the tests of some files ended."""

    name: str
    code: int
    again: tuple[str, ...]  # why it was run once more, in a sentence


def told(files: Files, options: list[str]) -> Ended:
    """Run the tests of some files, once more where the client took its process along, and show what they said."""
    again: list[str] = []
    name, code = " ".join(files), 0
    for number in range(TRIES):
        command = [sys.executable, "-m", "pytest", "--no-header", *files, *options]
        code, said = run(command, environment=None if UNMEASURED.issuperset(files) else MEASURED)
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


def run(command: list[str], silent_s: float = SILENT_S, environment: dict[str, str] | None = None) -> tuple[int, bytes]:
    """Run a command; return its code, minus the signal that ended it, or STUCK, and what it said."""
    said: list[bytes] = []
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, env=environment
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
        heard_s = worked_s = time.monotonic()
        used_s = processor_time.used_s(process.pid)
        while time.monotonic() - heard_s < silent_s:
            if not selector.select(1.0):
                if (now_s := processor_time.used_s(process.pid)) > used_s + RESTS_USED_S:
                    used_s, worked_s = now_s, time.monotonic()
                if time.monotonic() - max(heard_s, worked_s) >= RESTS_S:
                    return False
                continue
            words = os.read(process.stdout.fileno(), 1 << 16)
            if not words:
                return True
            heard_s = time.monotonic()
            said.append(words)
    return False


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
