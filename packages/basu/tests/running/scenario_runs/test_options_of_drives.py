"""Claims about the options that cases share with runs: each changes the drive, and a file or page shows it."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.options.drive import DriveOptions
from basu.options.run import RunOptions
from basu.output.report.scenarios.matrix_documents import read_case
from basu.records.history.files import read_history
from basu.results import ScenarioResults
from basu.running.scenario_runs.options import ScenarioOptions
from basu.settings.option import fields_of
from servers import RunningServer

METRIC = '''
"""A metric of a user's."""

from basu.metrics.registry import Metric


class TopSpeed(Metric):
    name = "top_speed"
    title = "top speed"
    unit = "m/s"

    def compute(self, drive):
        return float(drive.history.speed_mps().max())
'''
LOG_METRIC = """
from basu_carla_log.metric_file import BasicMetric


class Ended(BasicMetric):
    def _create_metric(self, town_map, log, criteria):
        print("frames", log.get_total_frame_count(), "walkers", len(log.get_actor_ids_with_type_id("walker.*")))
        hit = criteria["collision_pedestrian"]["actual_value"]
        print("arrives:", criteria["arrives"]["test_status"], "collisions:", hit)
"""


def run(simulator: RunningServer, output: Path, *words: object) -> int:
    host = ("--host", "127.0.0.1", "--port", simulator.port)
    return main(["scenario", "run", *map(str, (*words, *host, "--output", output))])


def folder_of(output: Path, name: str = "goes_well") -> Path:
    return output / "latest" / "basic" / name


def documents(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    config = json.loads((folder / "config.json").read_text(encoding="utf-8"))
    return result, config


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_case_has_every_option_of_a_drive() -> None:
    shared = {field.name for field in fields_of(DriveOptions)}
    for model in (RunOptions, ScenarioOptions):
        assert shared <= {field.name for field in fields_of(model)}


def test_weather_traffic_and_metrics_of_a_case_are_in_its_world_its_result_and_its_page(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    (tmp_path / "top.py").write_text(METRIC, encoding="utf-8")
    words = ("--weather", "HardRainNoon", "--vehicles", 2, "--walkers", 1, "--metrics", tmp_path / "top.py")
    code = run(simulator, tmp_path, "goes_well", "--scenarios", files, "--seed", 3, *words)
    result, config = documents(folder_of(tmp_path))
    assert code == 0, result["case"]["message"]
    assert result["meta"]["weather"] == config["weather"] == "HardRainNoon"
    assert result["meta"]["traffic"] == {"vehicles": 2, "walkers": 1, "density_per_km": None}
    assert result["meta"]["seed"] == 3
    assert 2.0 < result["metrics"]["top_speed"]["value"] < 12.0
    assert result["scores"]["driving"] > 0.5
    assert result["passed"] is True
    page = (tmp_path / "latest" / "matrix.html").read_text(encoding="utf-8")
    assert "HardRainNoon" in page
    assert "2 vehicles around, 1 walker around" in page
    assert "top speed" in page
    (case,) = ScenarioResults(tmp_path / "latest").cases
    assert case.run.metrics["top_speed"] == result["metrics"]["top_speed"]["value"]


def test_the_weather_of_a_case_is_in_its_world(
    simulator: RunningServer, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    agent = tmp_path / "looks.py"
    agent.write_text(
        "import carla\nfrom basu.agents.autonomous_agent import AutonomousAgent\n\n\n"
        "class Looks(AutonomousAgent):\n"
        "    def setup(self):\n        pass\n\n"
        "    def config(self):\n        return {}\n\n"
        "    def run_step(self, sensor_data):\n"
        "        weather = self.world.get_weather()\n"
        '        raise ValueError(f"fog {weather.fog_density:.0f} sun {weather.sun_altitude_angle:.0f}")\n',
        encoding="utf-8",
    )
    foggy = '<weather fog_density="40" sun_altitude_angle="12"/>'
    text = files.read_text(encoding="utf-8").replace(
        'name="goes_well" type="Crosser" town="Linden">', f'name="goes_well" type="Crosser" town="Linden">{foggy}'
    )
    files.write_text(text, encoding="utf-8")
    words = ("goes_well", "--scenarios", files, "--agent", agent)
    assert run(simulator, tmp_path / "own", *words) == 1
    assert "fog 40 sun 12" in capsys.readouterr().out
    assert run(simulator, tmp_path / "given", *words, "--weather", "ClearNoon") == 1
    assert "fog 2 sun 45" in capsys.readouterr().out


def test_repetitions_have_their_own_seeds_folders_and_rows(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    words = ("goes_well", "--scenarios", files, "--repetitions", 2, "--seed", 5, "--stop-after", 2)
    run(simulator, tmp_path, *words)
    seeds = [documents(folder_of(tmp_path, f"goes_well-{nth}"))[0]["meta"]["seed"] for nth in range(2)]
    assert seeds == [5, 6]
    rows = json.loads((tmp_path / "latest" / "matrix.json").read_text(encoding="utf-8"))["cases"]
    assert [(row["id"], row["repetition"], row["results"]["basic"]["status"]) for row in rows] == [
        ("goes_well", 0, "Stopped"),
        ("goes_well", 1, "Stopped"),
    ]
    page = (tmp_path / "latest" / "matrix.html").read_text(encoding="utf-8")
    assert "goes_well #2" in page
    _, config = documents(folder_of(tmp_path, "goes_well-1"))
    assert (config["options"]["seed"], config["options"]["repetitions"]) == (6, 1)


def test_a_recorded_case_has_its_log_and_the_metrics_module_works_on_it(
    files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The simulator is our own: the log lies in the folder of the case."""
    words = ["goes_well", "--scenarios", str(files), "--record", "--output", str(tmp_path)]
    assert main(["scenario", "run", *words]) == 0
    folder = folder_of(tmp_path)
    assert documents(folder)[1]["recording"] == {"file": "recording.log", "where": "run folder"}
    (tmp_path / "ended.py").write_text(LOG_METRIC, encoding="utf-8")
    capsys.readouterr()
    assert main(["metrics", str(folder), "--metric", str(tmp_path / "ended.py")]) == 0
    said = capsys.readouterr().out
    assert "walkers 1" in said
    assert "arrives: SUCCESS collisions: 0" in said


def test_the_log_of_a_case_on_another_machine_is_named(simulator: RunningServer, files: Path, tmp_path: Path) -> None:
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--record", "--stop-after", 1)
    recording = documents(folder_of(tmp_path))[1]["recording"]
    assert recording["file"].endswith("basic-goes_well.log")
    assert recording["where"] == f"disk of the simulator at 127.0.0.1:{simulator.port}"


def test_a_case_is_scored_and_reported_again_from_its_folder(
    simulator: RunningServer, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--penalty", "collision_pedestrian=0.1")
    folder = folder_of(tmp_path)
    result, _ = documents(folder)
    assert result["scoring"]["penalties"]["collision_pedestrian"] == 0.1
    assert result["reported"]["lane_invasions"] is None, "a case does not listen to them"
    capsys.readouterr()
    assert main(["score", str(folder), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert {key: again[key] for key in ("scores", "passed", "case", "meta", "scoring")} == {
        key: result[key] for key in ("scores", "passed", "case", "meta", "scoring")
    }
    assert main(["report", str(folder)]) == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "The case" in page
    assert "basu scenario run --config config.json" in page
    assert "goes_well" in page
    assert read_case(folder).result is not None


def test_the_keys_of_one_drive_alone_can_be_recorded(
    files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["goes_well", "dozes", "--scenarios", str(files), "--record-keys", "keys.json", "--output", str(tmp_path)]
    assert main(["scenario", "run", *words]) == 2
    assert "--record-keys records one drive, and these are 2" in capsys.readouterr().err
    assert not (tmp_path / "latest").exists()


def test_a_run_that_was_broken_off_goes_on_and_drives_the_rest_alone(
    simulator: RunningServer, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("goes_well", "goes_well:ahead=30", "dozes", "--scenarios", files, "--stop-after", 2)
    run(simulator, tmp_path, *words)
    folder = (tmp_path / "latest").resolve()
    whole = json.loads((folder / "matrix.json").read_text(encoding="utf-8"))
    (folder / "matrix.json").unlink()  # as a kill leaves it: two drives, and half of the third
    kept = folder / "basic" / "goes_well" / "result.json"
    before = kept.stat().st_mtime_ns
    (folder / "basic" / "dozes").rename(folder / "basic" / ".dozes.part")
    host = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    main(["scenario", "run", "--resume", str(tmp_path / "latest"), *host])
    again = json.loads((folder / "matrix.json").read_text(encoding="utf-8"))
    assert [row["id"] for row in again["cases"]] == [row["id"] for row in whole["cases"]]
    verdicts = [[row["results"]["basic"]["verdict"] for row in one["cases"]] for one in (again, whole)]
    assert verdicts[0] == verdicts[1]
    assert kept.stat().st_mtime_ns == before
    assert sorted(path.name for path in (folder / "basic").iterdir()) == ["dozes", "goes_well", "goes_well_ahead_30"]
    capsys.readouterr()
    assert main(["scenario", "run", "--resume", str(folder), "--weather", "ClearNoon", *host]) == 2
    assert "was begun differently: --weather was None and is 'ClearNoon'" in capsys.readouterr().err


def test_a_drive_that_says_nothing_of_the_agent_is_set_aside_and_driven_again(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    words = ("indoors", "--scenarios", files)
    assert run(simulator, tmp_path, *words) == 2
    folder = (tmp_path / "latest").resolve()
    main(["scenario", "run", "--resume", str(folder), "--host", "127.0.0.1", "--port", str(simulator.port)])
    assert sorted(path.name for path in (folder / "basic").iterdir()) == ["indoors", "indoors-SetupFailed"]


def test_a_bag_of_a_case_lies_in_its_folder(simulator: RunningServer, files: Path, tmp_path: Path) -> None:
    pytest.importorskip("rosbags")
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--rosbag", "--stop-after", 1)
    assert (folder_of(tmp_path) / "rosbag" / "rosbag.mcap").stat().st_size > 10_000


def test_sumo_drives_traffic_in_a_case(simulator: RunningServer, files: Path, tmp_path: Path) -> None:
    pytest.importorskip("libsumo")
    words = ("--sumo", "random", "--vehicles", 5, "--stop-after", 2)
    run(simulator, tmp_path, "goes_well", "--scenarios", files, *words)
    result, _ = documents(folder_of(tmp_path))
    assert result["meta"]["traffic"]["vehicles"] >= 1, result["case"]["message"]
    assert result["sumo"] is not None


def test_a_page_shows_a_case(
    simulator: RunningServer, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("websockets")
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--watch", "--stop-after", 1)
    assert "http://127.0.0.1:" in capsys.readouterr().out


def test_a_class_places_the_other_actors_of_its_case(simulator: RunningServer, files: Path, tmp_path: Path) -> None:
    classes = files.with_suffix(".py")
    given = """

class Given(Crosser):
    \"\"\"The actors of the case's file stand where it says.\"\"\"

    def actors(self):
        given = [
            ActorSpec(one.role, one.model, one.pose, on_ground=True, attributes=one.attributes, speed_mps=one.speed_mps)
            for one in self.place.others
        ]
        return [*super().actors(), *given]
"""
    classes.write_text(classes.read_text(encoding="utf-8") + given, encoding="utf-8")
    other = '<other_actor x="235" y="112" yaw="3" model="vehicle.audi.tt" rolename="neighbour" speed="2"/>'
    case = files.read_text(encoding="utf-8").replace(
        'name="goes_well" type="Crosser" town="Linden">', f'name="goes_well" type="Given" town="Linden">{other}'
    )
    files.write_text(case, encoding="utf-8")
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--stop-after", 2)
    result, _ = documents(folder_of(tmp_path))
    actors = {actor["role"]: actor["type"] for actor in result["case"]["actors"]}
    assert actors == {"walker": "walker.pedestrian.0001", "neighbour": "vehicle.audi.tt"}, result["case"]["message"]
    history = read_history(folder_of(tmp_path))
    number = next(actor["id"] for actor in result["case"]["actors"] if actor["role"] == "neighbour")
    rows = history.others[history.others["id"] == number]
    assert (rows["x_m"][0], rows["y_m"][0]) == (pytest.approx(235.0, abs=1.0), pytest.approx(112.0, abs=1.0))
    assert rows["x_m"][-1] - rows["x_m"][0] > 1.0, rows[["tick", "x_m", "velocity_x_mps"]][:8]
