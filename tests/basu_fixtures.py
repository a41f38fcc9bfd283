"""Fixtures of the tests of basu and its plugins: a live simulator, and a short piece of a Linden street to drive on.

conftest.py of the root loads them. The automatic ones act in the tests of these distributions only.
"""

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, nullcontext, suppress
from pathlib import Path

import pytest

from basu import simulator as simulator_module
from basu.agents.process import agent_process
from basu.output.report import path_picture
from kept_server import end_kept_server, kept_server
from servers import RunningServer, running_server
from shared_client import shared_client
from tracing import untraced

PACKAGES = Path(__file__).parents[1] / "packages"
BASU = (sys.executable, "-c", "from basu.cli import entry_point; entry_point()")
"""The command ``basu`` in a process of its own; arguments follow."""
SHORT_ROUTE = PACKAGES / "basu" / "src" / "basu" / "routes" / "linden_short.xml"


@pytest.fixture(autouse=True)
def _basu(request: pytest.FixtureRequest) -> None:
    """Set up what each test of basu and of its plugins has."""
    if request.path.is_relative_to(PACKAGES) and request.path.relative_to(PACKAGES).parts[0].startswith("basu"):
        for name in (
            "_no_stand_ins",
            "_no_server_starts_early",
            "_pictures_where_asked",
            "_agents_write_their_coverage",
        ):
            request.getfixturevalue(name)


@pytest.fixture
def _no_stand_ins() -> Iterator[None]:
    """Forget the modules that an agent's file brought with it: other tests' files find their own."""
    yield
    module = sys.modules.get("basu_leaderboard.replacement_modules")
    if module is not None:
        module.uninstall()


@pytest.fixture(scope="session")
def _no_server_starts_early() -> Iterator[None]:
    """Have a command start its server when it drives: one that is refused, or has another server, starts none."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator_module, "started_early", lambda *_: nullcontext())
        yield


@pytest.fixture
def _pictures_where_asked(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have drives of the shared simulator leave an empty ``path.png``, but in tests with the mark ``pictures``.

    matplotlib draws it in 0.3 s of processor time, which is a third of a short drive.
    """
    if "simulator" in request.fixturenames and not request.node.get_closest_marker("pictures"):
        monkeypatch.setattr(path_picture, "draw", lambda path, *_: path.write_bytes(b""))


@pytest.fixture(scope="session")
def _agents_write_their_coverage() -> Iterator[None]:
    """End the processes of agents by SIGTERM, at which they write their coverage; the benchmark would kill them."""
    yield
    processes = [running._process for running in agent_process._running]
    for process in processes:
        process.terminate()
    for process in processes:
        with suppress(subprocess.TimeoutExpired):
            process.wait(10.0)


KILLER = """
import os, socket, struct, sys

import psutil

orders = socket.socket(socket.AF_UNIX)
orders.bind(sys.argv[1])
orders.listen()
print(flush=True)
while True:
    agent, _ = orders.accept()
    pid, number = map(int, agent.recv(100).split())
    if pid == 0:  # the benchmark: the first above the agent's process and its keeper, which share their command
        own = psutil.Process(struct.unpack("3i", agent.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0])
        command = own.cmdline()
        while own.cmdline() == command:
            own = own.parent()
        pid = own.pid
        with open(sys.argv[2], "w") as note:
            note.write(" ".join(str(child.pid) for child in own.children()))
    os.kill(pid, number)
    agent.close()
"""
Kills = Callable[[str, str], str]


@pytest.fixture
def kills(tmp_path: Path) -> Iterator[Kills]:
    """Code for an agent that has a signal sent by another process: the kernel lets its own signal none but its own.

    The arguments are code as well, of a process's id (or ``BENCHMARK``) and a signal. The code waits until the signal
    is sent. The file ``children`` in ``tmp_path`` then holds the ids of the benchmark's children.
    """
    with tempfile.TemporaryDirectory() as short:  # the path of a socket has 107 characters at most
        orders = Path(short) / "orders"
        with subprocess.Popen(
            [sys.executable, "-c", KILLER, str(orders), str(tmp_path / "children")], stdout=subprocess.PIPE
        ) as killer:
            assert killer.stdout is not None
            killer.stdout.readline()
            yield (
                lambda pid, name: (
                    f"import socket; ask = socket.socket(socket.AF_UNIX); ask.connect({str(orders)!r}); "
                    f"ask.sendall(f'{{{pid}}} {{int({name})}}'.encode()); ask.recv(1)"
                )
            )
            killer.kill()


@pytest.fixture(scope="session")
def simulator() -> Iterator[RunningServer]:
    """One server for all runs of a session; each run puts its own things away."""
    with ExitStack() as stack:
        with untraced():  # tests/compat and packages/linden/tests measure the server's coverage
            running = stack.enter_context(running_server())
        stack.enter_context(shared_client(running.port))
        yield running


@pytest.fixture(scope="session")
def _kept_server_ends() -> Iterator[None]:
    """End the server of ``one_server`` with the session."""
    yield
    end_kept_server()


@pytest.fixture
def one_server(_kept_server_ends: None) -> Iterator[None]:
    """Commands of this test that start a server take the one of all such tests, in a new world."""
    with kept_server():
        yield


@pytest.fixture
def route_file(tmp_path: Path) -> Path:
    """The first hundred metres or so of the short route."""
    lines = SHORT_ROUTE.read_text(encoding="utf-8").splitlines()
    points = [line for line in lines if "<position" in line or "<waypoint " in line]
    path = tmp_path / "piece.xml"
    path.write_text(
        '<routes><route id="piece" town="Linden"><waypoints>' + "\n".join(points[:3]) + "</waypoints></route></routes>",
        encoding="utf-8",
    )
    return path
