"""Claims about agents in processes of their own: found with the same sentences, fresh each time, and never in here."""

import contextlib
import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import psutil
import pytest

from basu.agents.calls import route_point
from basu.agents.process import remote_agent
from basu.agents.process.remote_agent import AgentInProcess, RemoteAgent, find_agent
from basu.errors import AgentCrashedError, AgentTimedOutError, UserError

pytestmark = pytest.mark.measured_processes
COMPLETE = """
import os, random, signal, sys, time
COUNT = [0]

class Mine(AutonomousAgent):
    def __init__(self):
        COUNT[0] += 1

    def setup(self): pass
    def run_step(self, sensor_data): return carla.VehicleControl()
    def config(self): return {"vehicle": f"made {COUNT[0]} {random.random()}"}

    def get_initial_route_locations(self):
        return [(1, 2, 3), carla.Location(4.0, 5.0, 6.0)]

    def sensors(self):
        return [{"type": "sensor.other.gnss", "id": "GNSS", "z": 1.0, "data": "numpy"}]
"""


def found(folder: Path, text: str = COMPLETE, **options: Any) -> AgentInProcess:
    path = folder / "an_agent.py"
    path.write_text(text)
    agent = find_agent(str(path), **options)
    assert isinstance(agent, AgentInProcess)
    return agent


def test_an_agent_is_loaded_elsewhere_and_not_here(tmp_path: Path) -> None:
    sys.modules.pop("basu_agent_an_agent", None)  # another test of this process may have loaded one of that name
    agent = found(tmp_path)
    assert (agent.name, agent.class_name, agent.is_human) == ("an_agent", "Mine", False)
    assert "basu_agent_an_agent" not in sys.modules
    remote = RemoteAgent(agent, step_limit_s=10.0, seed=1)
    assert remote.own_route() == (route_point((1, 2, 3)), route_point((4, 5, 6)))
    (gnss,) = remote.sensor_set() or ()
    assert (gnss.id, gnss.z_m, gnss.as_numpy) == ("GNSS", 1.0, True)


def test_every_agent_begins_anew_in_a_process_that_is_kept(tmp_path: Path) -> None:
    agent = found(tmp_path)
    vehicles = [RemoteAgent(agent, 10.0, seed).config().vehicle for seed in (3, 3, 4)]
    assert vehicles[0] == vehicles[1]
    assert vehicles[0] != vehicles[2]
    assert all(vehicle.startswith("made 1 ") for vehicle in vehicles)  # the file's own state too
    assert agent.process() is agent.process()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param("def f(:", "is no Python: line 1", id="no Python"),
        pytest.param("x = 1 / 0", "line 1: ZeroDivisionError", id="raises"),
        pytest.param("raise SystemExit(3)", "line 1: SystemExit: 3", id="sys.exit"),
        pytest.param("import os; os._exit(0)", "does not load: its process ended with exit status 0", id="exits"),
        pytest.param(
            "import ctypes; ctypes.string_at(0)",
            r"its process was ended by the signal SIGSEGV",
            id="segmentation fault",
        ),
    ],
)
def test_a_file_that_does_not_load_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        found(tmp_path, text)


def test_native_code_that_hangs_at_loading_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote_agent, "LOAD_LIMIT_S", 0.5)
    with pytest.raises(UserError, match=r"was not loaded within 0.5 s"):
        found(tmp_path, "import ctypes; ctypes.PyDLL(None).sleep(3600)")


def test_a_process_that_died_is_replaced(tmp_path: Path) -> None:
    agent = found(tmp_path)
    remote = RemoteAgent(agent, 10.0, 0)
    os.kill(remote._process._process.pid, signal.SIGKILL)
    remote._process._process.wait(20.0)
    with pytest.raises(
        AgentCrashedError, match=r"Mine died in get_initial_route_locations\(\): its process was ended by"
    ):
        remote.own_route()
    assert RemoteAgent(agent, 10.0, 0).config().vehicle.startswith("made 1 ")


def test_what_the_agents_process_started_ends_with_it(tmp_path: Path) -> None:
    text = COMPLETE.replace("def config(self):", "def config(self):\n        os.fork() or time.sleep(3600)\n       ")
    remote = RemoteAgent(found(tmp_path, text), 10.0, 0)
    group = remote._process._process.pid
    remote._process.kill()
    deadline_s = time.monotonic() + 20.0
    while _alive_in(group) and time.monotonic() < deadline_s:
        os.sched_yield()
    assert not _alive_in(group)


def test_a_call_that_never_ends_is_the_agents_and_ends_its_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_agent, "SETUP_LIMIT_S", 0.5)
    text = "import ctypes" + COMPLETE.replace("return [(1,", "ctypes.PyDLL(None).sleep(3600); return [(1,")
    remote = RemoteAgent(found(tmp_path, text), 0.5, 0)
    with pytest.raises(AgentTimedOutError, match=r"get_initial_route_locations\(\) of Mine took longer .* 0.5 s"):
        remote.own_route()
    assert not remote._process.alive


def _alive_in(group: int) -> list[int]:
    """The processes of a group that still run."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error, OSError):
            if os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process.pid)
    return found
