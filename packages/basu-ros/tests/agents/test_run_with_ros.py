"""Whole runs that ROS 2 software in another process drives, over real DDS, and what becomes of software that fails."""

import itertools
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from basu.records.history.files import read_history
from basu_ros.agents.ros2 import RosAgent
from rclpy_environment import rclpy_peer, rclpy_python
from ros_runs import FOLLOWER, STACK, has_failed, has_followed_the_route, run
from servers import RunningServer

__all__ = ["rclpy_peer", "rclpy_python"]

DOMAINS = itertools.count(1)
Starts = Callable[..., "subprocess.Popen[bytes]"]


@pytest.fixture
def starts(monkeypatch: pytest.MonkeyPatch) -> Iterator[Starts]:
    """Starts software on a domain of this test's own, and ends it: what was killed stays on its domain for 10 s."""
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + (os.getpid() + next(DOMAINS)) % 90))
    with ExitStack() as stack:

        def start(file: Path, *words: str) -> "subprocess.Popen[bytes]":
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
            process = stack.enter_context(subprocess.Popen([sys.executable, str(file), *words], env=environment))
            stack.callback(process.kill)
            return process

        yield start


@pytest.mark.parametrize(("agent", "kind"), [("ros", "ackermann"), ("autoware", "autoware")])
def test_a_follower_drives_along_the_route(
    agent: str, kind: str, simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(FOLLOWER, kind)
    _, result, folder = run(agent, simulator, route_file, tmp_path, "--stop-after", "6")
    has_followed_the_route(result, folder)


@pytest.mark.parametrize(
    ("kind", "status", "says"),
    [
        (
            "nan",
            "AgentInvalidControl",
            "/carla/hero/vehicle_control_cmd at 0.25 s: the ROS software commands throttle = nan; it must be a finite",
        ),
        ("stale", "AgentTimedOut", "frame 5 (0.25 s) (the last one that came has the earlier time 0.20 s) within the"),
        ("dies", "AgentTimedOut", "the ROS 2 software left the domain"),
        ("stalls", "AgentTimedOut", "within the limit of a step; it is still there"),
    ],
)
def test_software_that_fails_is_the_agent_s_failure_and_the_record_is_kept(
    kind: str, status: str, says: str, simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(STACK, kind)
    has_failed(run("ros", simulator, route_file, tmp_path, "--step-limit", "5"), status, says)


def test_software_that_floods_its_topic_drives_all_the_same(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    """300 commands a frame: the newest one of the frame's time counts, and the run is not held up."""
    starts(STACK, "floods")
    _, result, folder = run("ros", simulator, route_file, tmp_path, "--stop-after", "3")
    assert result["status"] == "Stopped", result["message"]
    assert read_history(folder).frames["throttle"][-1] == 0.5
    assert len(read_history(folder).frames) == 61


def test_a_stack_that_asks_for_a_sensor_that_does_not_exist_gets_its_name(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "sensors.json"
    file.write_text('[{"type": "sensor.lidar.of_glass", "id": "top", "x": 0.0, "z": 2.0}]')
    monkeypatch.setattr(RosAgent, "config", lambda _self: {"sensors": str(file)})
    starts(STACK, "good")
    code, result, _ = run("ros", simulator, route_file, tmp_path)
    assert code != 0
    assert "sensor.lidar.of_glass" in result["message"]


def test_two_drivers_at_one_wheel_are_refused(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts
) -> None:
    starts(STACK, "good")
    starts(FOLLOWER, "ackermann")
    _, result, _ = run("ros", simulator, route_file, tmp_path, "--step-limit", "2")
    assert result["fault"] == "agent"
    assert "several ROS 2 nodes command the vehicle (1 on /carla/hero/vehicle_control_cmd, 1 on" in result["message"]


def test_software_that_never_appears_is_a_time_out_with_a_sentence(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts, monkeypatch: pytest.MonkeyPatch
) -> None:
    del starts  # but its domain
    monkeypatch.setattr(RosAgent, "appears_s", 0.3)
    _, result, _ = run("ros", simulator, route_file, tmp_path)
    assert (result["status"], result["fault"]) == ("AgentTimedOut", "agent")
    assert "publishes on /carla/hero/vehicle_control_cmd or /carla/hero/ackermann_cmd within" in result["message"]
    assert "give both the same ROS_DOMAIN_ID" in result["message"]


def test_real_rclpy_drives_the_shuttle(
    simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts, rclpy_peer: Starts
) -> None:
    del starts  # but its domain
    rclpy_peer("drive", "good")
    _, result, folder = run("ros", simulator, route_file, tmp_path, "--stop-after", "3")
    assert result["status"] == "Stopped", result["message"]
    assert read_history(folder).frames["route_s_m"][-1] > 1.0


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        ("dies", "the ROS 2 software left the domain"),
        ("best-effort", "vehicle_control_cmd with the QoS reliability BEST_EFFORT; it must be RELIABLE"),
    ],
)
def test_real_rclpy_that_fails_is_a_time_out_with_the_cause(
    kind: str, says: str, simulator: RunningServer, route_file: Path, tmp_path: Path, starts: Starts, rclpy_peer: Starts
) -> None:
    del starts  # but its domain
    rclpy_peer("drive", kind)
    _, result, _ = run("ros", simulator, route_file, tmp_path, "--step-limit", "25")
    assert (result["status"], result["fault"]) == ("AgentTimedOut", "agent"), result["message"]
    assert says in result["message"]
