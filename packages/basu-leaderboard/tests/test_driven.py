"""Claims about whole runs of agents of the leaderboard, in a live simulator."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from servers import RunningServer

EXAMPLE = Path(__file__).parents[3] / "examples" / "leaderboard_agent.py"
SEEING = """
import carla
from leaderboard.autoagents.autonomous_agent import AutonomousAgent
from srunner.scenariomanager.carla_data_provider import CarlaDataProvider
from srunner.scenariomanager.timer import GameTime

AT = {"x": 0.7, "y": 0.0, "z": 1.6, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}

def get_entry_point():
    return "Seeing"

class Seeing(AutonomousAgent):
    def setup(self, path_to_conf_file):
        self.steps = 0

    def sensors(self):
        return [
            {"type": "sensor.camera.rgb", "id": "EYE", **AT, "width": 64, "height": 48, "fov": 100},
            {"type": "sensor.lidar.ray_cast", "id": "LIDAR", **AT},
            {"type": "sensor.other.radar", "id": "RADAR", **AT, "horizontal_fov": 30.0, "vertical_fov": 30.0},
            {"type": "sensor.other.gnss", "id": "GPS", "x": 0.0, "y": 0.0, "z": 0.0},
            {"type": "sensor.other.imu", "id": "IMU", **AT},
            {"type": "sensor.speedometer", "id": "SPEED", "reading_frequency": 20},
        ]

    def run_step(self, input_data, timestamp):
        self.steps += 1
        if self.steps == 5:
            frames = {frame - GameTime.get_frame() for frame, _ in input_data.values()}
            shapes = {name: list(getattr(data, "shape", ())) for name, (_, data) in input_data.items()}
            dtypes = {name: str(getattr(data, "dtype", "")) for name, (_, data) in input_data.items()}
            fix, first = input_data["GPS"][1], self._global_plan[0][0]
            raise ValueError([
                sorted(frames), shapes, dtypes, round(timestamp, 3), CarlaDataProvider.get_hero_actor().type_id,
                bool(abs(fix[0] - first["lat"]) < 1e-4 and abs(fix[1] - first["lon"]) < 1e-4),
            ])
        return carla.VehicleControl(brake=1.0)
"""
Runner = Callable[..., tuple[int, dict[str, Any]]]


@pytest.fixture
def run(simulator: RunningServer, tmp_path: Path, route_file: Path) -> Runner:
    """``basu run`` in this process, at the shared simulator; the exit code and the result."""

    def at(agent: Path, *options: str) -> tuple[int, dict[str, Any]]:
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        output = tmp_path / "runs"
        code = main(["run", str(agent), *address, "--routes", str(route_file), "--output", str(output), *options])
        result = output / "latest" / "result.json"
        return code, json.loads(result.read_text()) if result.exists() else {}

    return at


def test_the_example_finds_its_way_by_gnss_compass_and_speedometer(run: Runner) -> None:
    code, result = run(EXAMPLE)
    assert (code, result["status"]) == (0, "Completed")
    assert result["scores"]["path_following"] > 0.95
    assert result["meta"]["vehicle"] == "vehicle.lincoln.mkz_2020"


def test_what_an_agent_sees_is_in_step_and_in_the_leaderboards_form(run: Runner, tmp_path: Path) -> None:
    path = tmp_path / "seeing.py"
    path.write_text(SEEING)
    code, result = run(path)
    assert (code, result["status"], result["fault"]) == (1, "AgentCrashed", "agent")
    told = result["message"]
    assert "run_step() of Seeing raised ValueError: [[0], " in told
    assert re.search(r"'EYE': \[48, 64, 4], 'LIDAR': \[\d+, 4], 'RADAR': \[\d+, 4], 'GPS': \[3], 'IMU': \[7]", told)
    assert "'EYE': 'uint8', 'LIDAR': 'float32', 'RADAR': 'float32', 'GPS': 'float64', 'IMU': 'float64'" in told
    assert ", 0.25, 'vehicle.lincoln.mkz_2020', True]" in told


def test_a_sensor_that_the_simulator_lacks_gets_a_sentence(run: Runner, tmp_path: Path) -> None:
    path = tmp_path / "seeing.py"
    path.write_text(SEEING.replace("sensor.other.radar", "sensor.other.can_bus"))
    code, result = run(path)
    assert (code, result["status"]) == (1, "AgentCrashed")
    assert "sensor 'RADAR' has the type 'sensor.other.can_bus', which the simulator does not have" in result["message"]
