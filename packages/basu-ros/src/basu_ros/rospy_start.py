"""The start of rospy's process: the master's address, the Python that has rospy, and what a refusal means."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from basu.errors import UserError
from basu_ros.rospy_process import REFUSED

PROGRAM = Path(__file__).with_name("rospy_process.py")
LAUNCH = f"import sys; del sys.path[0]; import runpy; runpy.run_path({str(PROGRAM)!r}, run_name='__main__')"
"""Run the program without its folder on Python's path: that has a module ``types``, as Python itself has."""
PYTHONS = ("/usr/bin/python3", "python3")  # Debian's and Ubuntu's; then a robostack environment's
MASTER_URI = "http://localhost:11311"  # rospy's default
PIPE_BYTES = 1 << 20  # Linux's largest pipe without rights: a cloud of 60,000 points fits
INSTALL = (
    "ROS 1 needs rospy, which is not on PyPI; install it for the system's Python, on Debian and Ubuntu by "
    "`sudo apt-get install python3-rospy python3-roslaunch`, or source the setup file of a Noetic"
)


def master_uri() -> str:
    """Return the address of the master.

    Raises:
        UserError: ``ROS_MASTER_URI`` is no address.
    """
    text = os.environ.get("ROS_MASTER_URI", "").strip() or MASTER_URI
    try:
        parts = urlsplit(text)
        is_one = parts.scheme == "http" and bool(parts.hostname) and parts.port is not None
    except ValueError:
        is_one = False
    if not is_one:
        raise UserError(f"ROS_MASTER_URI is '{text}'; it must be an address such as {MASTER_URI}")
    return text


def started(words: list[str]) -> subprocess.Popen[bytes]:
    """Return rospy's process, under a Python that has rospy.

    Raises:
        UserError: no Python has it.
    """
    environment = {**os.environ, "ROS_MASTER_URI": master_uri()}
    if urlsplit(master_uri()).hostname in {"localhost", "127.0.0.1"} and not {"ROS_HOSTNAME", "ROS_IP"} & {*os.environ}:
        environment["ROS_HOSTNAME"] = "localhost"  # this machine's name need not have an address
    process = subprocess.Popen(  # noqa: S603 - the system's Python
        [_python(), "-c", LAUNCH, *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=environment,
    )
    with contextlib.suppress(OSError, AttributeError):  # a smaller pipe is slower, and no more
        fcntl.fcntl(process.stdin.fileno(), fcntl.F_SETPIPE_SZ, PIPE_BYTES)  # type: ignore[union-attr]
    return process


@cache
def _python() -> str:
    """The first interpreter that finds rospy.

    Raises:
        UserError: none does.
    """
    looking = "import importlib.util as u, sys; sys.exit(u.find_spec('rospy') is None)"
    for name in PYTHONS:
        path = shutil.which(name)
        if path is None:
            continue
        looked = subprocess.run([path, "-c", looking], check=False, stderr=subprocess.DEVNULL)  # noqa: S603 - likewise
        if looked.returncode == 0:
            return path
    raise UserError(INSTALL)


def refusal(state: tuple[bytes, dict[str, Any]], realm: str) -> UserError:
    """Return the sentence for a node that did not start."""
    kind, told = state
    if kind != REFUSED:
        return UserError(f"rospy did not start: {told.get('reason', 'its process died')}")
    if told["why"] == "import":
        return UserError(f"{INSTALL} ({told['text']})")
    if told["why"] == "name":
        return UserError(f"{realm} has a node {told['text']} already, such as another run's; end that one first")
    return UserError(
        f"no roscore answers at {realm.rpartition(' ')[2]} ({told['text']}); start one with `roscore`, or name "
        "another by ROS_MASTER_URI"
    )
