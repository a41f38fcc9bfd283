"""Claims about whole runs, in a live simulator: what is left behind, and what each kind of failure is called."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import carla
import psutil
import pytest

from basu.cli import main
from basu.records.history.files import read_history
from basu_fixtures import BASU
from cheating_agent import BENCHMARK
from servers import RunningServer, running_server

SAMPLE = Path(__file__).parents[4] / "examples" / "forward_agent.py"
AGENT = """
import ctypes, os, signal, sys, time

class TestAgent(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 20:
            {deed}
        return carla.VehicleControl(throttle=0.3)

    def config(self):
        return {{"vehicle": "vehicle.tesla.model3", "sensors": {sensors!r}}}
"""
RAMMER = """
class Rammer(AutonomousAgent):
    def setup(self):
        blueprint = self.world.get_blueprint_library().find("vehicle.audi.a2")
        pose = self.route.waypoints[15].transform
        pose.location.z += 0.3
        self.parked = self.world.spawn_actor(blueprint, pose)
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 120:
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.7)

    def config(self):
        return {"vehicle": "vehicle.tesla.model3"}

    def destroy(self):
        self.parked.destroy()
"""
RESULT_FILES = {
    "config.json",
    "history.parquet",
    "path.png",
    "report.html",
    "result.json",
    "result.txt",
    "route.json",
    "streets.json",
}
Runner = Callable[..., tuple[int, dict[str, Any]]]
Kills = Callable[[str, str], str]


@pytest.fixture
def run(simulator: RunningServer, tmp_path: Path, route_file: Path) -> Runner:
    """``basu run`` in this process, at the shared simulator; the exit code and the result."""

    def at(agent: object, *options: str, port: int | None = None) -> tuple[int, dict[str, Any]]:
        output = tmp_path / "runs"
        address = ["--host", "127.0.0.1", "--port", str(port or simulator.port)]
        code = main(["run", str(agent), *address, "--routes", str(route_file), "--output", str(output), *options])
        result = output / "latest" / "result.json"
        return code, json.loads(result.read_text()) if result.exists() else {}

    return at


def doing(folder: Path, deed: str, sensors: str | None = None) -> Path:
    """An agent that drives for twenty steps and then does something."""
    path = folder / "test_agent.py"
    path.write_text(AGENT.format(deed=deed, sensors=sensors))
    return path


@pytest.mark.pictures
def test_the_thesis_sample_leaves_a_scored_folder_and_scoring_it_again_gives_the_same_judgement(
    run: Runner, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, result = run(SAMPLE)
    folder = tmp_path / "runs" / "latest"
    assert folder.is_symlink()
    assert {path.name for path in folder.iterdir()} == RESULT_FILES | {"sumo.json"}, (
        "the record of SUMO, amid which it drives"
    )
    assert set(result["scores"]) == {"driving", "infraction", "path_following"}
    assert all(0.0 <= value <= 1.0 for value in result["scores"].values())
    assert isinstance(result["infractions"], list)
    assert result["meta"]["simulated_s"] > 0.0
    assert result["meta"]["wall_s"] > 0.0
    assert result["meta"]["vehicle"] == "vehicle.tesla.model3"
    assert "warning" not in capsys.readouterr().err
    assert result["meta"]["traffic"]["vehicles"] > 5, "it names a SUMO folder, so it drives amid SUMO's traffic"
    assert (folder / "path.png").read_bytes().startswith(b"\x89PNG")
    assert main(["score", str(folder), "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again == {key: result[key] for key in again}


def test_the_history_follows_the_vehicle_from_rest(run: Runner, tmp_path: Path) -> None:
    run(doing(tmp_path, "return None"), "--in-process")
    history = read_history(tmp_path / "runs" / "latest")
    assert history.frames["tick"].tolist() == list(range(21))
    assert history.speed_mps()[0] < 0.05
    assert history.speed_mps()[-1] > 0.5
    assert history.frames["throttle"][:20] == pytest.approx(0.3)
    assert abs(history.frames["route_s_m"][0]) < 1.0


@pytest.mark.unmeasured
@pytest.mark.parametrize(
    ("deed", "status", "sentence"),
    [
        pytest.param("raise ValueError('no lane')", "AgentCrashed", "raised ValueError: no lane (line", id="raises"),
        pytest.param("time.sleep(3600)", "AgentTimedOut", "took longer than its limit of 0.5 s", id="sleeps"),
        pytest.param("while True: pass", "AgentTimedOut", "took longer than its limit of 0.5 s", id="loops"),
        pytest.param("return None", "AgentInvalidControl", "returned None", id="returns nothing"),
        pytest.param("return 'ahead'", "AgentInvalidControl", "returned a str", id="returns nonsense"),
        pytest.param("os._exit(1)", "AgentCrashed", "its process ended with exit status 1", id="ends its process"),
        pytest.param(
            "os._exit(0)", "AgentCrashed", "its process ended with exit status 0", id="ends as if all is well"
        ),
        pytest.param("sys.exit(0)", "AgentCrashed", "raised SystemExit: 0", id="sys.exit"),
        pytest.param("raise KeyboardInterrupt", "AgentCrashed", "raised KeyboardInterrupt", id="plays the user"),
        pytest.param(
            "from basu.errors import UserError; raise UserError('a bad route')",
            "AgentCrashed",
            "raised UserError: a bad route",
            id="blames the set-up",
        ),
        pytest.param("ctypes.string_at(0)", "AgentCrashed", "ended by the signal SIGSEGV", id="segmentation fault"),
        pytest.param(
            "ctypes.PyDLL(None).sleep(3600)",  # PyDLL keeps the interpreter's lock
            "AgentTimedOut",
            "took longer than its limit of 0.5 s",
            id="hangs in native code",
        ),
        pytest.param(
            "time.sleep(3600) if os.fork() == 0 else os._exit(3)",
            "AgentCrashed",
            "its process ended with exit status 3",
            id="leaves a child with its pipes open",
        ),
        pytest.param("os.closerange(3, 256)", "AgentCrashed", "its process", id="closes all that is open"),
    ],
)
def test_an_agent_that_fails_has_its_own_status_and_what_was_measured(
    run: Runner, tmp_path: Path, deed: str, status: str, sentence: str
) -> None:
    code, result = run(doing(tmp_path, deed), "--step-limit", "0.5")
    assert code == 1
    assert (result["status"], result["fault"]) == (status, "agent")
    assert sentence in result["message"]
    assert result["meta"]["ticks"] == 21
    assert result["meta"]["wall_s"] < 10.0  # on a busy machine; the hang alone lasts an hour
    assert result["scores"]["path_following"] > 0.0


def test_an_agent_that_takes_all_memory_has_failed(run: Runner, tmp_path: Path) -> None:
    deed = "self.hoard = [bytes([1]) * 20_000_000 for _ in range(50)]"
    code, result = run(doing(tmp_path, deed), "--agent-memory", "0.5", "--step-limit", "60")
    assert (code, result["status"]) == (1, "AgentCrashed")
    assert re.search(r"it used [01]\.\d\d GB of memory, more than its limit of 0.5 GB", result["message"])


def test_the_agents_process_changes_nothing_of_the_drive(tmp_path: Path, simulator: RunningServer, run: Runner) -> None:
    written = []
    for mode in ("", "--in-process"):
        code, _ = run("basic", *filter(None, [mode]))
        assert code == 0
        written.append((tmp_path / "runs" / "latest" / "history.parquet").read_bytes())
    assert written[0] == written[1]


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_an_interrupted_run_is_written_and_called_so(run: Runner, tmp_path: Path, kills: Kills, name: str) -> None:
    code, result = run(doing(tmp_path, kills(BENCHMARK, f"signal.{name}")))
    assert (code, result["status"]) == (130, "Interrupted")
    assert result["message"] == {"SIGINT": "interrupted by the user", "SIGTERM": "terminated by SIGTERM"}[name]
    assert result["scores"] is not None


@pytest.mark.measured_processes
def test_the_example_agent_arrives(run: Runner) -> None:
    code, result = run(SAMPLE.with_name("gentle_agent.py"))
    assert (code, result["status"]) == (0, "Completed")
    assert result["scores"]["driving"] > 0.95


def test_another_users_simulator_is_left_as_it_was(run: Runner, tmp_path: Path, simulator: RunningServer) -> None:
    client = carla.Client("127.0.0.1", simulator.port)
    world = client.get_world()
    before = world.get_settings()
    run(doing(tmp_path, "return None", "config/sensors.json"))
    after = world.get_settings()
    assert (after.synchronous_mode, after.fixed_delta_seconds) == (before.synchronous_mode, before.fixed_delta_seconds)
    world.wait_for_tick(10.0)
    left = [actor.type_id for actor in world.get_actors() if actor.type_id.startswith(("vehicle.", "sensor."))]
    assert left == []


def test_a_sensor_that_the_simulator_cannot_serve_gets_a_sentence(run: Runner, tmp_path: Path) -> None:
    (tmp_path / "ears.json").write_text('[{"type": "sensor.other.rss", "id": "EAR"}]')
    code, result = run(doing(tmp_path, "return None", str(tmp_path / "ears.json")))
    assert (code, result["status"]) == (1, "AgentCrashed")  # an agent that could choose it could choose its cases
    assert "ears.json: sensor 'EAR' (sensor.other.rss) cannot be served by this simulator" in result["message"]


@pytest.mark.slow
def test_a_simulator_that_dies_is_not_the_agents_failure(run: Runner, tmp_path: Path, kills: Kills) -> None:
    with running_server() as doomed:
        deed = kills(str(doomed.process.pid), "signal.SIGKILL")
        code, result = run(doing(tmp_path, deed), "--timeout", "1", port=doomed.port)
    assert (code, result["status"], result["fault"]) == (3, "SimulatorFailed", "simulator")
    assert result["meta"]["ticks"] >= 21


def test_sensors_are_in_step_with_the_ticks(run: Runner, tmp_path: Path) -> None:
    deed = (
        "seen = {name: sensor_data[name][0] for name in ('GNSS', 'IMU')}; "
        "raise ValueError(f'{seen} {self.world.get_snapshot().frame}')"
    )
    _, result = run(doing(tmp_path, deed, "config/sensors.json"))
    frame = result["meta"]["first_server_frame"] + 20
    assert f"ValueError: {{'GNSS': {frame}, 'IMU': {frame}}} {frame}" in result["message"]


def test_a_simulator_of_our_own_is_gone_afterwards(tmp_path: Path, route_file: Path) -> None:
    agent = doing(tmp_path, "raise ValueError('over')")
    own = psutil.Process(os.getpid())
    before = {process.pid for process in own.children(recursive=True)}  # fixtures of other tests have servers
    assert main(["run", str(agent), "--routes", str(route_file), "--output", str(tmp_path / "runs")]) == 1
    assert "linden" not in [each.name() for each in own.children(recursive=True) if each.pid not in before]


@pytest.mark.skipif(sys.platform != "linux", reason="parents that are killed take their children along on Linux only")
def test_a_simulator_of_our_own_does_not_outlive_a_killed_benchmark(
    tmp_path: Path, route_file: Path, kills: Kills
) -> None:
    deed = kills(BENCHMARK, "signal.SIGKILL")
    arguments = ["run", str(doing(tmp_path, deed)), "--routes", str(route_file), "--output", str(tmp_path / "runs")]
    killed = subprocess.run([*BASU, *arguments], capture_output=True, check=False)
    assert killed.returncode == -9
    servers = [int(number) for number in (tmp_path / "children").read_text().split()]
    assert len(servers) == 2  # the simulator, and the keeper of the agent
    gone, alive = psutil.wait_procs([psutil.Process(pid) for pid in servers if psutil.pid_exists(pid)], timeout=20)
    assert not alive, f"{len(gone)} ended, {alive} live on"


def test_repetitions_leave_a_folder_each(run: Runner, tmp_path: Path) -> None:
    run(doing(tmp_path, "return None"), "--in-process", "--repetitions", "2")
    folders = [path for path in (tmp_path / "runs").iterdir() if not path.is_symlink()]
    assert len(folders) == 2


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param(None, "cannot be read|was not found", id="missing"),
        pytest.param("", "is empty", id="empty"),
        pytest.param(
            '<routes><route id="x" town="Linden"><waypoints><position x="5000" y="0"/><position x="5050" y="0"/>'
            "</waypoints></route></routes>",
            r"route 'x' in .*: point 1 \(5000.0, 0.0\) lies \d+\.\d m from the nearest driving lane of Linden",
            id="off the road",
        ),
        pytest.param(
            '<routes><route id="x" town="Atlantis"><waypoints><position x="0" y="0"/><position x="9" y="0"/>'
            "</waypoints></route></routes>",
            "the route is in Atlantis, which this simulator does not have; it has .*Linden",
            id="no such town",
        ),
    ],
)
def test_a_route_that_cannot_be_driven_gets_a_sentence(
    run: Runner, route_file: Path, capsys: pytest.CaptureFixture[str], text: str | None, sentence: str
) -> None:
    if text is None:
        route_file.unlink()
    else:
        route_file.write_text(text)
    code, result = run(SAMPLE)
    assert (code, result) == (2, {})
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert any(re.search(sentence, line) for line in error.splitlines())


def test_hitting_a_parked_car_is_reported_with_the_party_the_place_and_the_speed(run: Runner, tmp_path: Path) -> None:
    path = tmp_path / "rammer.py"
    path.write_text(RAMMER)
    _, result = run(path, "--in-process")
    (collision,) = (found for found in result["infractions"] if found["kind"] == "collision_vehicle")
    assert collision["other"].startswith("vehicle.audi.a2 (actor ")
    assert collision["speed_mps"] > 2.0
    assert 8.0 < collision["route_s_m"] < 16.0  # 15 m from middle to middle, less half of both cars
    history = read_history(tmp_path / "runs" / "latest")
    assert set(history.facts.actor_types.values()) == {"vehicle.audi.a2"}
    assert history.others["tick"].tolist() == list(range(len(history.frames)))
    first = history.others[0]
    assert float(first["x_m"] - history.frames["x_m"][0]) == pytest.approx(-15.0, abs=0.5)
