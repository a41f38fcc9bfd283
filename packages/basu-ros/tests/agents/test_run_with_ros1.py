"""Whole runs that ROS 1 software in another process drives, at a real roscore, and software that fails."""

import contextlib
import json
import os
import subprocess
import sys
import time
import xmlrpc.client
from pathlib import Path
from typing import Any, cast

import pytest

from basu.cli import main
from basu.records.history.files import read_history
from basu_ros.agents.ros1 import Ros1Agent
from ros_runs import FOLLOWER, STACK, has_failed, has_followed_the_route, run
from roscore import SYSTEM_PYTHON, Starts, master, roscore, starts
from servers import RunningServer

__all__ = ["master", "roscore", "starts"]
ROSTOPIC = "import sys, rostopic; rostopic.rostopicmain(['rostopic', *sys.argv[1:]])"


@pytest.mark.parametrize(
    ("agent", "kind"), [("ros1", "ros1"), ("autoware-ai", "autoware-ai"), ("autoware-ai", "autoware-ai-1.13")]
)
def test_a_follower_drives_along_the_route(
    agent: str, kind: str, simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(FOLLOWER, kind)
    _, result, folder = run(agent, simulator, route_file, tmp_path, "--stop-after", "6")
    has_followed_the_route(result, folder)


@pytest.mark.parametrize(
    ("kind", "status", "says"),
    [
        ("nan", "AgentInvalidControl", "commands throttle = nan; it must be a finite number"),
        ("dies", "AgentTimedOut", "the ROS 1 software left the master http://localhost:"),
        ("stalls", "AgentTimedOut", "within the limit of a step; it is still there"),
    ],
)
def test_software_that_fails_is_the_agent_s_failure_and_the_record_is_kept(
    kind: str, status: str, says: str, simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(STACK, kind, "ros1")
    has_failed(run("ros1", simulator, route_file, tmp_path, "--step-limit", "5"), status, says)


def test_a_loop_that_misses_its_turn_does_not_stop_the_clock_for_ever(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    """Its last command is too old in some frames, and it wakes only when the clock goes on."""
    starts(STACK, "seldom")
    _, result, folder = run("autoware-ai", simulator, route_file, tmp_path, "--stop-after", "2.5", "--step-limit", "5")
    assert result["status"] == "Stopped", result["message"]
    frames = read_history(folder).frames
    assert len(frames) == 51
    assert frames["route_s_m"][-1] - frames["route_s_m"][0] > 0.5


def test_a_loop_that_stalls_is_a_time_out_all_the_same(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(STACK, "seldom-stalls")
    _, result, _ = run("autoware-ai", simulator, route_file, tmp_path, "--step-limit", "2")
    assert (result["status"], result["fault"]) == ("AgentTimedOut", "agent"), result["message"]
    assert "gave no command on /vehicle_cmd for frame" in result["message"]


def test_software_that_localises_itself_gets_no_pose_before_its_map_is_there(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    """It has no pose for a while, and must stand still meanwhile."""
    starts(STACK, "localises")
    _, result, folder = run("autoware-ai", simulator, route_file, tmp_path, "--stop-after", "2.5", "--step-limit", "5")
    assert result["status"] == "Stopped", result["message"]
    assert read_history(folder).frames["route_s_m"][-1] > 0.5


def test_two_drivers_at_one_wheel_are_refused(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(STACK, "good", "ros1")
    starts(FOLLOWER, "ros1")
    _, result, _ = run("ros1", simulator, route_file, tmp_path, "--step-limit", "3")
    assert result["fault"] == "agent"
    assert "several ROS 1 nodes command the vehicle (1 on /carla/hero/vehicle_control_cmd, 1 on" in result["message"]


def test_software_that_never_appears_is_a_time_out_with_a_sentence(
    simulator: RunningServer, route_file: Path, tmp_path: Path, master: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Ros1Agent, "appears_s", 0.3)
    _, result, _ = run("ros1", simulator, route_file, tmp_path)
    assert (result["status"], result["fault"]) == ("AgentTimedOut", "agent")
    assert f"no ROS 1 node of the master {master} publishes on /carla/hero/vehicle_control_cmd" in result["message"]
    assert "give both the same ROS_MASTER_URI" in result["message"]


def wait_for_node(master: str, beginning: str) -> None:
    """Wait until the master knows a node with a name of this beginning: each node publishes its log."""
    deadline_s = time.monotonic() + 60.0
    while time.monotonic() < deadline_s:
        _, _, (published, _, _) = cast("Any", xmlrpc.client.ServerProxy(master)).getSystemState("/test")
        if any(node.startswith(beginning) for _, nodes in published for node in nodes):
            return
        time.sleep(0.05)
    pytest.fail(f"no node {beginning} has begun")


def test_a_run_is_published_beside_any_agent(
    simulator: RunningServer, route_file: Path, tmp_path: Path, master: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Debian's own `rostopic echo` prints the odometry while the forward agent drives.

    On a busy machine a short drive may be over before it is connected. It then hears the next one.
    """
    command = [SYSTEM_PYTHON, "-c", ROSTOPIC, "echo", "-n", "3", "--noarr", "/carla/hero/odometry/child_frame_id"]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as echo:
        try:
            wait_for_node(master, "/rostopic")  # on a busy machine it starts later than a short drive ends
            address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--in-process", "--output", str(tmp_path)]
            told, code = "", None
            for _ in range(4):
                code = main(["run", "forward", *address, "--routes", str(route_file), "--ros1"])
                with contextlib.suppress(subprocess.TimeoutExpired):
                    told, _ = echo.communicate(timeout=10.0)
                    break
        finally:
            echo.kill()
    result = json.loads((tmp_path / "latest" / "result.json").read_text())
    assert (code, result["status"]) == (0, "Completed"), result["message"]
    assert told.count('"hero"') == 3
    assert f"ROS 1             master {master}, topics /carla/hero/…" in capsys.readouterr().out


def test_without_a_roscore_a_run_is_refused_before_it_begins(
    tmp_path: Path, master: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    del master
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:9")
    assert main(["run", "forward", "--ros1", "--output", str(tmp_path)]) == 2
    assert "no roscore answers at http://localhost:9" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert sys.executable != SYSTEM_PYTHON
