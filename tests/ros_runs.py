"""Runs that ROS software in another process drives, and the software."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from basu.cli import main
from basu.records.history.files import read_history
from servers import RunningServer

ROOT = Path(__file__).parents[1]
FOLLOWER, STACK = ROOT / "examples" / "ros_follower.py", ROOT / "tests" / "fakes" / "ros_stack.py"


def run(
    agent: str, simulator: RunningServer, route_file: Path, output: Path, *options: str
) -> tuple[int, dict[str, Any], Path]:
    """The exit code of ``basu run``, the result and the run's folder."""
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--in-process", "--output", str(output)]
    code = main(["run", agent, *address, "--routes", str(route_file), *options])
    result = output / "latest" / "result.json"
    return code, json.loads(result.read_text()) if result.exists() else {}, output / "latest"


def has_followed_the_route(result: dict[str, Any], folder: Path) -> None:
    """Check a run of six seconds that a follower drove."""
    assert result["status"] == "Stopped", result["message"]
    frames = read_history(folder).frames
    assert frames["route_s_m"][-1] > 8.0
    assert np.abs(frames["lateral_m"]).max() < 1.0
    assert len(frames) == 121


def has_failed(ended: tuple[int, dict[str, Any], Path], status: str, says: str) -> None:
    """Check a run whose software failed at the sixth frame: the agent's failure, and the record is kept."""
    code, result, folder = ended
    assert (code, result["status"], result["fault"]) == (1, status, "agent"), result["message"]
    assert says in result["message"]
    assert 5 <= len(read_history(folder).frames) <= 6
