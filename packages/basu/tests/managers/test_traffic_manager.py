"""Tests of ``basu.managers.traffic_manager``."""

import json
import math
import subprocess
from pathlib import Path

import carla
import numpy as np
import pytest

from basu.cli import main
from basu.managers.traffic_manager import CLEAR_M, REACH_M, distance_m, suitable, vehicles_for
from basu.records.history.files import read_history
from basu_fixtures import BASU
from fakes.drives import straight_route
from servers import RunningServer

ROUTE_M = straight_route(1000.0).points_m[:, :2]


def test_the_distance_is_that_to_the_nearest_part_of_the_route() -> None:
    random = np.random.default_rng(5)
    places_m = random.uniform(-800.0, 1800.0, (200, 2))
    inside = np.clip(places_m[:, 0], 0.0, 1000.0)
    exact_m = np.hypot(places_m[:, 0] - inside, places_m[:, 1])
    found_m = distance_m(places_m, ROUTE_M)
    assert (found_m >= exact_m - 1e-9).all()
    assert found_m[exact_m > 50.0] == pytest.approx(exact_m[exact_m > 50.0], abs=0.3)


def test_places_are_within_reach_and_away_from_the_start() -> None:
    places_m = np.array(
        [
            [0.0, CLEAR_M - 1.0],
            [0.0, CLEAR_M + 1.0],
            [500.0, REACH_M - 1.0],
            [500.0, REACH_M + 2.0],
            [-REACH_M - 9.0, 0.0],
        ]
    )
    assert suitable(places_m, ROUTE_M, (0.0, 0.0)).tolist() == [1, 2]


def test_a_density_is_vehicles_on_a_kilometre_of_lane() -> None:
    assert [vehicles_for(density, 12.0) for density in (0.0, 2.5, 5.0)] == [0, 30, 60]


def test_no_places_are_no_mistake() -> None:
    assert suitable(np.empty((0, 2)), ROUTE_M, (0.0, 0.0)).tolist() == []


WATCHER = """
class Watcher(AutonomousAgent):
    def setup(self):
        self.steps = 0
        ego = self.vehicle.get_location()
        moving = [each for each in self.world.get_actors() if each.type_id.startswith(("vehicle.", "walker."))]
        others = [each for each in moving if each.id != self.vehicle.id]
        self.seen = [(each.type_id.split(".")[0], each.get_location().distance(ego)) for each in others]

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > {steps}:
            raise ValueError(f"{{len(self.seen)}} others; "
                             f"{{sum(kind == 'vehicle' for kind, _ in self.seen)}} vehicles; "
                             f"nearest {{min(away for _, away in self.seen):.1f}} m")
        return carla.VehicleControl(brake=1.0)

    def config(self):
        return {{"vehicle": "vehicle.tesla.model3"}}
"""


KILLER = """
import os, psutil, signal

class Killer(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps == 20:
            for child in psutil.Process().children():
                os.kill(child.pid, signal.SIGKILL)
        return carla.VehicleControl(throttle=0.3)

    def config(self):
        return {}
"""


@pytest.fixture
def agent(tmp_path: Path) -> Path:
    path = tmp_path / "watcher.py"
    path.write_text(WATCHER.format(steps=5))
    return path


def address(simulator: RunningServer) -> list[str]:
    return ["--host", "127.0.0.1", "--port", str(simulator.port)]


def test_traffic_is_there_from_the_first_step_and_gone_after_the_last(
    simulator: RunningServer, tmp_path: Path, agent: Path, route_file: Path
) -> None:
    options = ["--routes", str(route_file), "--output", str(tmp_path / "runs"), "--vehicles", "12", "--walkers", "8"]
    assert main(["run", str(agent), "--in-process", *address(simulator), *options]) == 1
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert "raised ValueError: 20 others; 12 vehicles; nearest " in result["message"]
    nearest_m = float(result["message"].split("nearest ")[1].split(" m")[0])
    assert nearest_m > CLEAR_M - 2.0  # they have moved for some ticks
    assert result["meta"]["traffic"] == {"vehicles": 12, "walkers": 8, "density_per_km": None}
    world = carla.Client("127.0.0.1", simulator.port).get_world()
    world.wait_for_tick(10.0)
    moving = ("vehicle.", "walker.", "controller.")
    assert [actor.type_id for actor in world.get_actors() if actor.type_id.startswith(moving)] == []


def test_the_traffic_manager_ends_its_asynchronous_step_before_vehicles_are_registered(
    simulator: RunningServer, tmp_path: Path, agent: Path, route_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    called: list[str] = []

    def noted(owner: type, name: str) -> None:
        original = getattr(owner, name)
        monkeypatch.setattr(owner, name, lambda *arguments: (called.append(name), original(*arguments))[1])

    noted(carla.TrafficManager, "set_synchronous_mode")
    noted(carla.World, "tick")
    noted(carla.Vehicle, "set_autopilot")
    options = ["--routes", str(route_file), "--output", str(tmp_path / "runs"), "--vehicles", "2"]
    main(["run", str(agent), "--in-process", *address(simulator), *options])
    begin = called.index("set_synchronous_mode")
    assert called[begin : begin + 4] == ["set_synchronous_mode", "tick", "set_autopilot", "set_autopilot"]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--vehicles", "5000"], "5000 vehicles were requested, and "),
        (["--vehicles", "-1"], "--vehicles is -1; it must be 0 or more"),
        (["--traffic-density", "nan"], "--traffic-density is nan; it must be a finite number"),
    ],
)
def test_traffic_that_cannot_be_gets_a_sentence(
    simulator: RunningServer,
    tmp_path: Path,
    agent: Path,
    route_file: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    sentence: str,
) -> None:
    whole = [*address(simulator), "--routes", str(route_file), "--output", str(tmp_path / "runs"), *options]
    assert main(["run", str(agent), *whole]) == 2
    said = capsys.readouterr()
    assert sentence in said.out + said.err
    assert "Traceback" not in said.err


@pytest.mark.slow
def test_the_same_seed_has_the_same_traffic_beside_its_log_and_another_seed_another(
    tmp_path: Path, agent: Path
) -> None:
    agent.write_text(WATCHER.format(steps=40))
    traffic = ["--traffic-density", "4", "--walkers", "30"]
    words = ["run", str(agent), "--in-process", "--routes", "routes/linden_short.xml", *traffic]
    records = {}
    for name, repetitions in (("first", "1"), ("second", "2")):
        output = ["--output", str(tmp_path / name), "--seed", "3", "--repetitions", repetitions]
        main([*words, "--record", *output])
        folders = sorted(path for path in (tmp_path / name).iterdir() if not path.is_symlink())
        records |= zip((name, "third"), folders, strict=False)
    bytes_of = {name: (folder / "history.parquet").read_bytes() for name, folder in records.items()}
    assert bytes_of["first"] == bytes_of["second"] != bytes_of["third"]
    logs = {name: (folder / "recording.log").read_bytes() for name, folder in records.items()}
    assert b"CARLA_RECORDER" in logs["first"][:64]
    config = json.loads((records["first"] / "config.json").read_text())
    assert config["recording"] == {"file": "recording.log", "where": "run folder"}
    assert "--record" in config["command"]
    others = read_history(records["first"]).others
    assert len(np.unique(others["id"])) >= 1
    assert np.hypot(others["velocity_x_mps"], others["velocity_y_mps"]).max() > 1.0


@pytest.mark.slow
def test_a_simulator_that_dies_under_traffic_is_reported_and_what_was_measured_is_kept(
    tmp_path: Path, route_file: Path
) -> None:
    agent = tmp_path / "killer.py"
    agent.write_text(KILLER)
    options = ["--routes", str(route_file), "--vehicles", "10", "--walkers", "5"]
    # the agent ends the benchmark's child, so it drives in the benchmark's process
    arguments = ["run", str(agent), "--in-process", *options, "--output", str(tmp_path / "runs")]
    # in a process of its own: the client of a dead simulator keeps its Traffic Manager for as long as it lives, which
    # is until that has waited in vain for --timeout
    ended = subprocess.run([*BASU, *arguments], capture_output=True, text=True, check=False)
    assert ended.returncode == 3, ended.stderr
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert (result["status"], result["meta"]["ticks"]) == ("SimulatorFailed", 20)


def test_the_log_of_another_users_simulator_lies_with_them(
    tmp_path: Path, agent: Path, route_file: Path, simulator: RunningServer, capsys: pytest.CaptureFixture[str]
) -> None:
    output = ["--output", str(tmp_path / "runs")]
    main(["run", str(agent), "--in-process", *address(simulator), "--routes", str(route_file), "--record", *output])
    recording = json.loads((tmp_path / "runs" / "latest" / "config.json").read_text())["recording"]
    assert recording["where"] == f"disk of the simulator at 127.0.0.1:{simulator.port}"
    assert recording["file"].endswith(".log")
    assert f"recording         {recording['file']} (disk of the simulator" in capsys.readouterr().out
    Path(recording["file"]).unlink()


def test_the_weather_of_a_route_holds_unless_an_option_names_another(
    simulator: RunningServer, tmp_path: Path, route_file: Path
) -> None:
    text = route_file.read_text()
    weathers = (
        '<weathers><weather route_percentage="0" fog_density="40"/><weather route_percentage="100" fog_density="60"/>'
        "</weathers>"
    )
    route_file.write_text(text.replace('town="Linden">', f'town="Linden">{weathers}'))
    agent = tmp_path / "looker.py"
    agent.write_text(
        WATCHER.format(steps=5)
        .replace("{len(self.seen)} others", "fog {self.world.get_weather().fog_density:.1f}")
        .replace("min(away for _, away in self.seen)", "0")
    )
    found = []
    for options in ([], ["--weather", "ClearNoon"]):
        main(
            [
                "run",
                str(agent),
                "--in-process",
                *address(simulator),
                "--routes",
                str(route_file),
                "--output",
                str(tmp_path),
                *options,
            ]
        )
        result = json.loads((tmp_path / "latest" / "result.json").read_text())
        found.append((float(result["message"].split("fog ")[1].split(";")[0]), result["meta"]["weather"]))
    (fog, name), (clear, other) = found
    assert 40.0 <= fog < 41.0
    assert math.isclose(clear, carla.WeatherParameters.ClearNoon.fog_density, abs_tol=0.1)
    assert (name, other) == ("of the route file", "ClearNoon")
