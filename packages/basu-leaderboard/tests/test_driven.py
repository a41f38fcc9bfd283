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


RIVAL = """
import carla
from leaderboard.autoagents.autonomous_agent import AutonomousAgent, Track

AT = {"x": 0.7, "y": 0.0, "z": 1.6, "roll": 0.0, "pitch": 0.0, "yaw": 0.0}

def get_entry_point():
    return "Rival"

class Rival(AutonomousAgent):
    def setup(self, path_to_conf_file):
        self.track = Track.SENSORS
        import basu_leaderboard.tracks as rules
        rules.LIMITS["sensor.camera.rgb"] = 99
        rules.TrackRules.admit = lambda self, specs, source: specs

    def sensors(self):
        eyes = [{"type": "sensor.camera.rgb", "id": f"EYE_{n}", **AT, "width": 64, "height": 48, "fov": 100}
                for n in range(9)]
        return eyes

    def run_step(self, input_data, timestamp):
        return carla.VehicleControl(throttle=0.5)
"""


def test_an_agent_that_changes_the_rules_in_its_own_process_is_refused_all_the_same(
    run: Runner, tmp_path: Path
) -> None:
    path = tmp_path / "rival.py"
    path.write_text(RIVAL)
    code, result = run(path, "--leaderboard-track", "SENSORS")
    assert code != 0
    assert result["scores"] is None
    assert "track SENSORS takes at most 8 sensor.camera.rgb, and these are 9; leave 1 out" in result["message"]
    assert result["meta"]["access"]["leaderboard"]["refused"] is not None


def test_an_agent_of_another_track_is_refused_by_a_sentence(run: Runner) -> None:
    code, result = run(EXAMPLE, "--leaderboard-track", "MAP")
    assert code != 0
    assert "CompassAgent has track = 'SENSORS', and --leaderboard-track is MAP" in result["message"]


def test_a_run_of_the_track_sensors_becomes_the_leaderboards_file(run: Runner, tmp_path: Path) -> None:
    code, result = run(EXAMPLE, "--leaderboard-track", "SENSORS")
    assert code == 0
    assert result["meta"]["access"]["track"] == "sensors"
    out = tmp_path / "results.json"
    assert main(["leaderboard", "results", str(tmp_path / "runs" / "latest"), "-o", str(out)]) == 0
    document = json.loads(out.read_text())
    assert document["sensors"] == ["carla_gnss", "carla_imu", "carla_speedometer"]
    assert document["entry_status"] == "Finished"


@pytest.mark.parametrize("option", ["--open", "--track world"])
def test_a_track_of_the_leaderboard_and_more_knowledge_exclude_each_other(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", str(EXAMPLE), "--leaderboard-track", "SENSORS", *option.split()]) == 2
    assert f"gives the agent its sensors alone, and {option} gives it more" in capsys.readouterr().err
