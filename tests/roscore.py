"""A real roscore of Debian's ROS 1 for tests, on a port of its own, and programs at it."""

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

SYSTEM_PYTHON = "/usr/bin/python3"
Starts = Callable[..., "subprocess.Popen[str]"]


def need_ros_1() -> None:
    """Skip a test where there is no ROS 1; fail in CI, which installs it."""
    if shutil.which("roscore") is None:
        sentence = "ROS 1 is not installed: sudo apt-get install python3-rospy python3-roslaunch rosbash"
        if os.environ.get("CI"):
            pytest.fail(sentence)
        pytest.skip(sentence)


@contextmanager
def running_roscore(logs: Path) -> Iterator[str]:
    """Start a roscore and give its address; it ends with the block."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"http://localhost:{port}"
    environment = {**os.environ, "ROS_MASTER_URI": address, "ROS_HOSTNAME": "localhost", "ROS_LOG_DIR": str(logs)}
    command = ["roscore", "-p", str(port)]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as core:
        assert core.stdout is not None
        lines = []
        for line in core.stdout:
            lines.append(line)
            if "started core service" in line:
                break
        else:
            raise AssertionError("".join(lines))
        try:
            yield address
        finally:
            core.terminate()
            core.stdout.read()


@pytest.fixture(scope="module")
def roscore(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a roscore that the tests of a file share."""
    need_ros_1()
    with running_roscore(tmp_path_factory.mktemp("ros")) as address:
        yield address


@pytest.fixture
def master(roscore: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> str:
    """The roscore, named by the environment as BASU and rospy read it."""
    monkeypatch.setenv("ROS_MASTER_URI", roscore)
    monkeypatch.setenv("ROS_HOSTNAME", "localhost")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "ros"))
    return roscore


@pytest.fixture
def starts(master: str) -> Iterator[Starts]:
    """Starts programs that use the roscore, and ends them; those of BASU's kind under this Python."""
    del master
    with ExitStack() as stack:

        def start(file: Path, *words: str, python: str = sys.executable) -> "subprocess.Popen[str]":
            environment = dict(os.environ)
            if python == sys.executable:
                environment["PYTHONPATH"] = os.pathsep.join(sys.path)
            else:
                environment.pop("PYTHONPATH", None)
            process = subprocess.Popen(
                [python, str(file), *words],
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            stack.enter_context(process)
            stack.callback(process.kill)
            return process

        yield start
