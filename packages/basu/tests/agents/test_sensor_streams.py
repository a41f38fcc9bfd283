"""Claims about measurements as arrays: an agent receives what ScenarioRunner and the leaderboard feed to theirs."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.agents.sensor_file import parse_sensors, read_sensors
from basu.cli import main
from basu.errors import UserError
from servers import RunningServer

AGENT = """
import json
import numpy as np
from types import SimpleNamespace
from basu_leaderboard.adapted_agent import LeaderboardAgent

KINDS = {
    "sensor.camera.rgb": {"width": 32, "height": 24},
    "sensor.lidar.ray_cast": {"channels": 4, "points_per_second": 4000},
    "sensor.other.radar": {"fov": 30},
    "sensor.other.gnss": {},
    "sensor.other.imu": {},
}

class Arrays(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def sensors(self):
        pose = {"x": 1.0, "z": 2.0}
        plain = [{"type": kind, "id": kind, **pose, **fields} for kind, fields in KINDS.items()]
        return plain + [{**entry, "id": entry["id"] + " array", "data": "numpy"} for entry in plain]

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps < 10:
            return carla.VehicleControl(throttle=0.5)
        theirs = SimpleNamespace(_gps=SimpleNamespace(measured=lambda fix: fix))  # the leaderboard's degrees left out
        told = {}
        for kind in KINDS:
            array, measured = sensor_data[kind + " array"][1], sensor_data[kind][1]
            fed = LeaderboardAgent._measured(theirs, measured)
            size = len(measured.raw_data) if hasattr(measured, 'raw_data') else 0
            told[kind] = [str(array.dtype), list(array.shape), bool(np.array_equal(array, fed)), size]
        radar = sensor_data["sensor.other.radar"][1]
        first = [[d.depth, d.altitude, d.azimuth, d.velocity] for d in radar][:1]
        told["radar's row"] = first == sensor_data["sensor.other.radar array"][1][:1].tolist()
        open(TOLD, "w").write(json.dumps(told))
        raise ValueError("enough")

    def config(self):
        return {"vehicle": "vehicle.tesla.model3"}
"""


@pytest.mark.parametrize("mode", [["--agent-writes"], ["--in-process"]], ids=["own process", "in process"])
def test_arrays_equal_the_arrays_of_the_adapter(
    simulator: RunningServer, route_file: Path, tmp_path: Path, mode: list[str]
) -> None:
    agent, told = tmp_path / "arrays.py", tmp_path / "told.json"
    agent.write_text(f"TOLD = {str(told)!r}\n{AGENT}")
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    mode = [*mode, str(tmp_path)] if mode == ["--agent-writes"] else mode
    main(["run", str(agent), *address, "--routes", str(route_file), "--output", str(tmp_path / "runs"), *mode])
    found = json.loads(told.read_text())
    assert found["sensor.camera.rgb"] == ["uint8", [24, 32, 4], True, 24 * 32 * 4]
    for kind in ("sensor.lidar.ray_cast", "sensor.other.radar"):  # four float32 a point
        dtype, (points, columns), is_equal, size = found[kind]
        assert (dtype, columns, is_equal, size) == ("float32", 4, True, 16 * points)
    assert found["sensor.other.gnss"][:2] == ["float64", [3]]
    assert found["sensor.other.imu"][:2] == ["float64", [7]]
    assert found["radar's row"]


def test_the_form_may_be_said_for_all_sensors_or_for_one(tmp_path: Path) -> None:
    path = tmp_path / "sensors.json"
    sensors: list[dict[str, Any]] = [
        {"type": "sensor.other.gnss", "id": "A"},
        {"type": "sensor.other.imu", "id": "B", "data": "carla"},
    ]
    path.write_text(json.dumps({"data": "numpy", "sensors": sensors}))
    assert [spec.as_numpy for spec in read_sensors(path)] == [True, False]
    path.write_text(json.dumps({"sensors": sensors}))
    assert [spec.as_numpy for spec in read_sensors(path)] == [False, False]
    assert all("data" not in dict(spec.attributes) for spec in read_sensors(path))


def test_another_form_gets_a_sentence() -> None:
    with pytest.raises(UserError, match=r"mine: sensor 'A' has data = 'torch'; it may be 'numpy' for arrays"):
        parse_sensors([{"type": "sensor.other.gnss", "id": "A", "data": "torch"}], "mine")
