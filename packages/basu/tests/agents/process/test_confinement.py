"""Claims about the confinement of the agent's process: it ends no other process, and its own as before."""

import subprocess
import sys
from pathlib import Path

import pytest

from basu.agents.process.confinement import is_available
from basu.agents.process.remote_agent import RemoteAgent, find_agent
from basu.errors import AgentCrashedError

pytestmark = pytest.mark.skipif(not is_available(), reason="this kernel has no Landlock with scopes (Linux 6.12)")

KILLER = """
import os, signal, subprocess, sys

class Killer(AutonomousAgent):
    def setup(self): pass
    def run_step(self, sensor_data): return carla.VehicleControl()
    def config(self):
        {deed}
        return {{"vehicle": "still here"}}
"""
DEEDS = {
    "signal": "os.kill({pid}, signal.SIGKILL)",
    "program": "subprocess.run(['kill', '-9', '{pid}'], check=True)",
    "python": "subprocess.run([sys.executable, '-c', 'import os; os.kill({pid}, 9)'], check=True)",
    "benchmark": "os.kill(os.getppid(), signal.SIGTERM)",
}


def agent(folder: Path, deed: str) -> RemoteAgent:
    path = folder / "killer.py"
    path.write_text(KILLER.format(deed=deed))
    return RemoteAgent(find_agent(str(path)), step_limit_s=10.0, seed=1)  # type: ignore[arg-type]


@pytest.mark.parametrize("deed", DEEDS)
def test_an_agent_that_ends_another_process_fails_and_the_process_lives(tmp_path: Path, deed: str) -> None:
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as other:
        with pytest.raises(AgentCrashedError, match=r"PermissionError|ProcessLookupError|CalledProcessError"):
            agent(tmp_path, DEEDS[deed].format(pid=other.pid)).config()
        assert other.poll() is None
        other.communicate(b"\n")


def test_an_agent_may_end_what_it_has_started(tmp_path: Path) -> None:
    deed = "p = subprocess.Popen(['sleep', '100']); p.kill(); assert p.wait() == -9"
    assert agent(tmp_path, deed).config().vehicle == "still here"
