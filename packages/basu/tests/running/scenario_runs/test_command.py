"""``basu scenario run``, whole: successes, failures with the party at fault, and the files."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import carla
import pytest

from basu.cli import main
from basu.jobs.playing import play_jobs
from basu.running.scenario_runs import command
from cheating_agent import BENCHMARK
from servers import RunningServer

AGENTS = """
import os, random, signal, time
import carla
from basu.agents.autonomous_agent import AutonomousAgent

class Bad(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def config(self):
        return {}

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps == 5:
            self.fail()
        return carla.VehicleControl(throttle=0.2)

class Raises(Bad):
    def fail(self):
        raise ValueError("no idea")

class Draws(Bad):
    def fail(self):
        raise ValueError(f"drew {random.random()}")

class Hangs(Bad):
    def fail(self):
        time.sleep(60.0)

class Dies(Bad):
    def fail(self):
        os._exit(1)

class EndsTheWorker(Bad):
    def fail(self):
        pass  # ends the worker

class Senses(Bad):
    def config(self):
        return {"sensors": "config/sensors.json"}

    def fail(self):
        there = {actor.type_id.rpartition(".")[2] for actor in self.world.get_actors().filter("sensor.*")}
        raise ValueError(f"felt {sorted(self.felt)}, there are {sorted(there)}")

    def run_step(self, sensor_data):
        self.felt = sensor_data.keys()
        return super().run_step(sensor_data)

class Searches(Bad):
    def fail(self):
        import re
        name, own = re.compile(rb"unspoke[n]_(?:case|else)"), b"unspoken_" + sorted([b"else"])[0]
        found = set()
        with open("/proc/self/maps") as parts, open("/proc/self/mem", "rb", 0) as memory:
            for part in parts:
                place, access, *_, file = part.rstrip("\\n").split(" ")
                if "rw" in access and not file.startswith("/"):
                    first, last = (int(end, 16) for end in place.split("-"))
                    memory.seek(first)
                    found.update(name.findall(memory.read(last - first)))
        raise ValueError(f"found {sorted(found)}")
"""


def played(output: Path) -> dict[str, dict[str, Any]]:
    """The cases of the newest run's results by id, of one agent."""
    found = [json.loads(path.read_text(encoding="utf-8")) for path in (output / "latest").glob("*/*/result.json")]
    return {result["case"]["id"]: result["case"] for result in found}


def matrix(output: Path) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((output / "latest" / "matrix.json").read_text(encoding="utf-8"))
    return document


def run(simulator: RunningServer, output: Path, *words: object) -> int:
    host = ("--host", "127.0.0.1", "--port", simulator.port)
    return main(["scenario", "run", *map(str, (*words, *host, "--output", output))])


def test_a_case_that_goes_well_leaves_its_verdict_and_a_clean_world(
    simulator: RunningServer, files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(20.0)
    assert run(simulator, tmp_path, "goes_well", "--scenarios", files) == 0
    result = played(tmp_path)["goes_well"]
    assert (result["verdict"], result["fault"], result["status"]) == ("SUCCESS", "none", "ScenarioEnded")
    assert list(result["phases_s"]) == ["setup", "trigger", "conflict", "resolution", "end"]
    assert result["actors"] == [{"id": result["actors"][0]["id"], "role": "walker", "type": "walker.pedestrian.0001"}]
    assert 0.3 < result["margins"]["distance_m"] < 22.0
    left = sorted(path.name for path in (tmp_path / "latest" / "basic" / "goes_well").iterdir())
    assert left == ["config.json", "history.parquet", "picture.svg", "result.json", "route.json", "streets.json"]
    assert matrix(tmp_path)["cases"][0]["results"]["basic"]["folder"] == "basic/goes_well"
    assert "Crosser" in capsys.readouterr().out
    moving = [
        a.type_id for a in client.get_world().get_actors() if a.type_id.startswith(("vehicle", "walker", "sensor"))
    ]
    assert moving == []


WRONG = {
    "stumbles": "the scenario stumbles raised ZeroDivisionError: stumbled (line ",
    "dozes": "never triggered",
    "leads": "leads speaks of 'absent', and no actor has this name; there are hero, walker",
    "elsewhere": "elsewhere is in Town05, which this simulator does not have (it has Linden, Linden_thesis)",
    "indoors": "indoors puts 'walker' at (294.2, 136.1), which is inside a house; move it",
}


def test_what_is_wrong_with_a_case_is_said_and_is_no_failure_of_an_agent(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    """One command plays all of them: the exit code of each is that of its verdict."""
    assert run(simulator, tmp_path, *WRONG, "--scenarios", files, "--in-process") == 2
    results = played(tmp_path)
    assert {case: result["verdict"] for case, result in results.items()} == dict.fromkeys(WRONG, "SETUP_FAULT")
    for case, sentence in WRONG.items():
        assert sentence in results[case]["message"]
    assert matrix(tmp_path)["shares"]["basic"]["share_of_cost"] is None


def test_an_agent_in_a_file_has_the_sensors_that_it_asks_for(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    (tmp_path / "senses.py").write_text(AGENTS)
    run(simulator, tmp_path, "goes_well", "--scenarios", files, "--agent", f"{tmp_path / 'senses.py'}:Senses")
    said = played(tmp_path)["goes_well"]["message"]
    assert "felt ['GNSS', 'IMU'], there are ['collision', 'gnss', 'imu', 'lane_invasion']" in said


@pytest.mark.parametrize("track", ["sensors", "objects"])
def test_no_part_of_an_agents_memory_names_the_case_that_it_drives(
    simulator: RunningServer, files: Path, tmp_path: Path, track: str
) -> None:
    """Memory holds environment and arguments as well; the name that is found there is made by the agent itself."""
    files.write_text(files.read_text(encoding="utf-8").replace("goes_well", "unspoken_case"), encoding="utf-8")
    (tmp_path / "searches").mkdir()
    agent = tmp_path / "searches" / "agent.py"
    agent.write_text(AGENTS)
    words = ("unspoken_case", "--scenarios", files, "--agent", f"{agent}:Searches", "--track", track)
    assert run(simulator, tmp_path / "runs", *words) == 1
    assert "found [b'unspoken_else']" in played(tmp_path / "runs")["unspoken_case"]["message"]


def test_a_driver_that_looks_at_nothing_fails_with_evidence(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    assert run(simulator, tmp_path, "goes_well", "--scenarios", files, "--agent", "forward") == 1
    result = played(tmp_path)["goes_well"]
    assert (result["verdict"], result["margins"]["distance_m"]) == ("FAILURE", 0.0)
    assert "hit walker (walker.pedestrian.0001)" in result["message"]


def test_the_same_case_again_is_the_same_byte_by_byte(simulator: RunningServer, files: Path, tmp_path: Path) -> None:
    left = []
    for name in ("one", "two"):
        assert run(simulator, tmp_path / name, "goes_well", "--scenarios", files, "--in-process") == 0
        folder = tmp_path / name / "latest" / "basic" / "goes_well"
        result = timeless(json.loads((folder / "result.json").read_text(encoding="utf-8")))
        left.append((result, *((folder / file).read_bytes() for file in ("history.parquet", "picture.svg"))))
    assert left[0] == left[1]


def timeless(result: dict[str, Any]) -> dict[str, Any]:
    """A result without what differs from drive to drive: wall times and the server's frame numbers."""
    meta = result["meta"] | {"wall_s": 0.0, "started": "", "first_server_frame": 0}
    return result | {"case": result["case"] | {"wall_s": 0.0}, "meta": meta}


def drives(output: Path) -> dict[str, tuple[bytes, dict[str, Any], dict[str, Any]]]:
    """The bytes of each drive of the newest run, its result and its config, without wall times.

    The access is left out, as the session is: --in-process, without a gate, is not repeated.
    """
    found = {}
    for path in (output / "latest").glob("*/*/result.json"):
        result = timeless(json.loads(path.read_text(encoding="utf-8")))
        agent = result["meta"]["agent"] | {"confinement": None}
        result["meta"] |= {"access": None, "agent": agent}
        config = json.loads(path.with_name("config.json").read_text(encoding="utf-8"))
        config |= {"session": None, "started": "", "access": None, "agent": agent}
        found[result["case"]["id"]] = (path.with_name("history.parquet").read_bytes(), result, config)
    return found


@pytest.mark.slow
def test_config_and_command_repeat_a_sweep_and_each_of_its_cases(
    simulator: RunningServer, files: Path, tmp_path: Path
) -> None:
    agent = tmp_path / "bad.py"
    agent.write_text(AGENTS, encoding="utf-8")
    words = ("goes_well", "--scenarios", files, "--agent", f"{agent}:Draws", "--in-process", "--sweep", 2, "--seed", 7)
    run(simulator, tmp_path / "one", *words, "--step-limit", 2, "--vehicle", "vehicle.tesla.model3")
    wanted = drives(tmp_path / "one")
    assert len(wanted) == 2
    assert all("drew 0." in result["case"]["message"] for _, result, _ in wanted.values()), "chance is a part of it"
    run(simulator, tmp_path / "two", "--config", tmp_path / "one" / "latest")
    assert drives(tmp_path / "two") == wanted
    name, alone = sorted(wanted.items())[1]
    assert name.startswith("goes_well:sweep-2-7-")
    again = alone[1]["case"]["command"]
    assert again == alone[2]["command"]
    run(simulator, tmp_path / "three", *again[3:])
    assert drives(tmp_path / "three") == {name: alone}
    config = next(
        path
        for path in (tmp_path / "one" / "latest").glob("*/*/config.json")
        if json.loads(path.read_text())["command"] == again
    )
    run(simulator, tmp_path / "four", "--config", config)
    assert drives(tmp_path / "four") == {name: alone}


@pytest.mark.parametrize(
    ("agent", "status"), [("Raises", "AgentCrashed"), ("Hangs", "AgentTimedOut"), ("Dies", "AgentCrashed")]
)
def test_an_agent_that_breaks_down_is_its_own_fault_and_the_next_case_is_played(
    simulator: RunningServer, files: Path, tmp_path: Path, agent: str, status: str
) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text(AGENTS, encoding="utf-8")
    words = ("goes_well", "goes_well:ahead=30", "--scenarios", files, "--agent", f"{bad}:{agent}", "--step-limit", 1)
    assert run(simulator, tmp_path, *words) == 1
    results = played(tmp_path)
    assert [(r["verdict"], r["fault"], r["status"]) for r in results.values()] == [("AGENT_FAULT", "agent", status)] * 2


@pytest.mark.slow
def test_a_process_that_dies_costs_its_own_case_only(
    files: Path, tmp_path: Path, kills: Callable[[str, str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not tried again here: packages/basu/tests/jobs/test_pool.py has the tries."""
    monkeypatch.setattr(command, "play_jobs", partial(play_jobs, attempts=1))
    bad = tmp_path / "bad.py"
    deed = kills(BENCHMARK, "signal.SIGKILL")
    bad.write_text(AGENTS.replace("pass  # ends the worker", deed), encoding="utf-8")
    words = ["goes_well", "--scenarios", files, "--agent", f"{bad}:EndsTheWorker", "--agent", "basic", "--workers", 2]
    code = main(["scenario", "run", *map(str, (*words, "--output", tmp_path))])
    assert code == 70
    results = matrix(tmp_path)["cases"][0]["results"]
    assert results["basic"]["verdict"] == "SUCCESS"
    assert results["bad"]["verdict"] == "BENCHMARK_FAULT"
    assert "its worker died" in results["bad"]["message"]


def test_ctrl_c_ends_the_run_and_what_was_played_is_written(
    simulator: RunningServer, files: Path, tmp_path: Path, kills: Callable[[str, str], str]
) -> None:
    agent = tmp_path / "bad.py"
    agent.write_text(AGENTS.replace("time.sleep(60.0)", kills(BENCHMARK, "signal.SIGINT")), encoding="utf-8")
    words = ("goes_well:ahead=30", "goes_well", "--scenarios", files, "--agent", "basic", "--agent", f"{agent}:Hangs")
    assert run(simulator, tmp_path, *words) == 130
    results = [case["results"] for case in matrix(tmp_path)["cases"]]
    assert [{name: result["verdict"] for name, result in row.items()} for row in results] == [
        {"basic": "SUCCESS", "bad": "INTERRUPTED"},
        {},
    ]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["rondabout"], "there is no scenario 'rondabout'"),
        (["goes_well", "--agent", "basics"], "there is no agent called 'basics'; did you mean 'basic'?"),
        (["goes_well", "--agent", "basic", "--agent", "basic"], "two agents are called 'basic'"),
        (["goes_well", "--set", "ahead"], "--set ahead: it must be NAME=VALUE"),
        (["goes_well", "--set", "ahed=3"], "did you mean 'ahead'?"),
        (["goes_well", "--workers", "0"], "--workers is 0"),
        (["goes_well", "--sweep", "0"], "a sweep of 0 is none"),
        (["--where", "lighting=dark", "--where", "partner=animal"], "cases has lighting=dark and partner=animal"),
    ],
)
def test_what_was_typed_wrongly_is_reported_before_anything_starts(
    files: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], sentence: str
) -> None:
    assert main(["scenario", "run", *words, "--scenarios", str(files), "--output", str(tmp_path / "out")]) == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
