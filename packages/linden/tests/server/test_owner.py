"""Claims about which process a connection belongs to: an agent goes through no gate but its own."""

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from linden.server.owner import admits

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs /proc")

CONNECT = (
    "import socket, sys; kept = socket.create_connection(('127.0.0.1', int(sys.argv[1]))); "
    "print(1, flush=True); input()"
)
STARTS = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {CONNECT!r}, sys.argv[1]])"


@contextmanager
def connected(program: str) -> Iterator[tuple[int, socket.socket]]:
    """The number of a process that runs a program, and what was accepted from it."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        command = [sys.executable, "-c", program, str(listener.getsockname()[1])]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
            assert process.stdout is not None
            process.stdout.readline()
            accepted, _ = listener.accept()
            with accepted:
                yield process.pid, accepted
                process.communicate(b"\n")


@pytest.mark.parametrize("program", [CONNECT, STARTS], ids=["itself", "by a child"])
def test_a_gate_lets_in_its_agent_and_what_that_started(program: str) -> None:
    with connected(program) as (agent, accepted), subprocess.Popen([sys.executable, "-c", ""]) as other:
        assert admits(agent, accepted)
        assert not admits(other.pid, accepted)
        assert admits(None, accepted)
