"""A live ``linden serve`` in a process of its own, for tests that talk to it as any client does."""

import ctypes
import os
import re
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tracing import of_servers

READY = re.compile(r"linden: ready, rpc port (\d+), streaming port (\d+)\n")
PR_SET_PDEATHSIG = 1
"""Of prctl(2)."""
START_LIMIT_S = 900.0
"""The first start on a machine compiles the kernels: a minute or two of its time, which may be shared by many."""
END_LIMIT_S = 60.0
"""A server ends within seconds. On a busy machine they are longer."""


@dataclass(frozen=True)
class RunningServer:
    process: subprocess.Popen[str]
    port: int
    streaming_port: int
    start_s: float
    log_file: Path

    def log(self) -> str:
        """What the server has written to stderr until now."""
        return self.log_file.read_text("utf-8")


SERVE = ("-m", "linden.cli", "serve")


@contextmanager
def running_server(*options: str, program: tuple[str, ...] = SERVE) -> Iterator[RunningServer]:
    """Start ``linden serve --port 0`` with these options; end it at the end of the block.

    ``program`` are the arguments of Python in its place.
    """
    with tempfile.TemporaryDirectory() as folder:
        log_file = Path(folder) / "stderr.txt"
        began_s = time.monotonic()
        with log_file.open("w", encoding="utf-8") as log:
            process = subprocess.Popen(
                [sys.executable, *program, "--port", "0", *options],
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                env=of_servers(),
                preexec_fn=_end_with_parent,  # noqa: PLW1509 - one prctl call, no lock
            )
        try:
            port, streaming_port = _ports(process, log_file)
            yield RunningServer(process, port, streaming_port, time.monotonic() - began_s, log_file)
            has_ended = process.poll() is not None  # a test's own doing
            process.terminate()
            code = process.wait(END_LIMIT_S)
            assert has_ended or code == 0, f"the server ended with {code}: {log_file.read_text('utf-8')[-1000:]}"
        finally:
            process.kill()
            process.wait()
            assert process.stdout is not None
            process.stdout.close()


def _end_with_parent() -> None:
    """Have the server end with the process that tests: the official client can take that one along."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def _ports(process: subprocess.Popen[str], log_file: Path) -> tuple[int, int]:
    """Wait for the line that says the server is ready."""
    assert process.stdout is not None
    deadline_s = time.monotonic() + START_LIMIT_S
    said = ""
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        while (left_s := deadline_s - time.monotonic()) > 0 and selector.select(left_s):
            part = os.read(process.stdout.fileno(), 65536).decode()  # readline() would keep lines that select() misses
            said += part
            if found := READY.search(said):
                return int(found[1]), int(found[2])
            if not part:
                break
    raise AssertionError(f"the server did not become ready: {said}{log_file.read_text('utf-8')}")
