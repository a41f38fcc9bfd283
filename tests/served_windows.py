"""Servers with a window for tests."""

import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

from servers import READY

BY_PROCESSOR = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Switches of a browser that draws by the processor."""


class Served:
    """A server with a window, and what it printed."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process, said = process, ""
        while (ready := READY.search(said)) is None:
            line = process.stdout.readline()
            assert line, said
            said += line
        self.port = int(ready[1])
        self.address = re.search(r"linden: window (http://127\.0\.0\.1:\d+/\S+/)", said)[1]

    @property
    def pages(self) -> psutil.Process:
        """The process of the pages."""
        (found,) = [p for p in psutil.Process(self.process.pid).children() if "linden_window" in p.cmdline()]
        return found


@contextmanager
def serving(*options: str | Path) -> Iterator[Served]:
    """A server of its own until the end of the block; ``options`` of `linden serve` turn the window on."""
    words = [sys.executable, "-m", "linden.cli", "serve", "--port", "0", "--streaming-port", "0", *options]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        yield Served(process)
    finally:
        process.kill()
        process.wait()
