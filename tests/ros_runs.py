"""Runs that ROS software in another process drives, and the software."""

import json
from pathlib import Path
from typing import Any

from basu.cli import main
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
