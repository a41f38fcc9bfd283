"""A roscore of its own, and programs of Autoware.AI 1.13 in a folder (``docs/how-to/ros.md``)."""

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

TABLES = (
    "area", "dtlane", "intersection", "lane", "line", "node", "point", "roadsign", "stopline", "vector", "wayarea",
)  # fmt: skip
"""The CSV files that carla-autoware loads; a file that the map lacks is left out."""


class Stack:
    """Starts programs at one roscore, and ends them with the block."""

    def __init__(self, stack: ExitStack, out: Path, logs: Path) -> None:
        """Start the roscore; ``out`` is the folder with the programs of Autoware.AI."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self._stack, self._out, self._logs = stack, out, logs
        logs.mkdir(parents=True, exist_ok=True)
        own = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost", "ROS_LOG_DIR": str(logs)}
        os.environ.update(own)
        self.environment = {**os.environ, "ROS_PACKAGE_PATH": f"{out / 'packages'}:/usr/share"}
        self.environment.pop("PYTHONPATH", None)
        self.environment["PATH"] = f"/usr/bin:{os.environ['PATH']}"  # ROS's programs want the system's Python
        core = self.start("roscore", "roscore", "-p", str(port), pipe=True)
        assert core.stdout is not None
        next((line for line in core.stdout if b"started core service" in line), None)

    def start(self, name: str, *words: str, pipe: bool = False) -> "subprocess.Popen[bytes]":
        """Start a program with its output in a file of the folder of logs."""
        log = self._stack.enter_context((self._logs / f"{name}.txt").open("wb"))
        output = subprocess.PIPE if pipe else log
        process = subprocess.Popen(words, env=self.environment, stdout=output, stderr=log)
        self.adopt(process)
        return process

    def adopt(self, process: "subprocess.Popen[bytes]") -> None:
        """End a program with the block."""
        self._stack.callback(_end, process)

    def node(self, name: str, *words: str) -> "subprocess.Popen[bytes]":
        """Start a program of Autoware.AI."""
        return self.start(name, str(self._out / "build" / name), *words)

    def load_vector_map(self, asian: Path) -> None:
        """Publish an Aisan map."""
        files = [str(asian / f"{name}.csv") for name in TABLES if (asian / f"{name}.csv").exists()]
        self.node("vector_map_loader", *files)


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a program and wait for it."""
    process.terminate()
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextmanager
def running_stack(out: Path, logs: Path) -> Iterator[Stack]:
    """A roscore and what is started at it, until the end of the block."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that the programs end with this one
    with ExitStack() as stack:
        yield Stack(stack, out.resolve(), logs)
