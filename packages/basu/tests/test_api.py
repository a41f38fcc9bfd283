"""Claims about the benchmark from Python: the same runs as on the command line, as objects."""

import subprocess
import sys
from pathlib import Path

import carla
import pytest

import basu
from basu.cli import main
from basu.errors import UserError
from basu.outcome import Status
from basu.results import RunResult, ScenarioResults
from servers import RunningServer


class Gentle(basu.AutonomousAgent):
    """Drives straight on for a moment, then raises."""

    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 30:
            raise ValueError("enough")
        return carla.VehicleControl(throttle=0.3)

    def config(self):
        return {"sensors": None}


@pytest.fixture
def opened(simulator: RunningServer):
    with basu.open_simulator("127.0.0.1", simulator.port) as found:
        yield found


def test_importing_basu_brings_in_neither_the_client_nor_plots() -> None:
    program = "import sys, basu; print(sorted({'carla', 'matplotlib', 'numpy', 'pandas'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_run_gives_the_record_that_the_command_writes(
    opened, simulator: RunningServer, route_file: Path, tmp_path: Path
) -> None:
    ours = basu.run("basic", routes=route_file, seed=4, output=tmp_path / "ours", simulator=opened)
    assert isinstance(ours, RunResult)
    assert ours.completed
    assert ours.scores is not None
    assert 0.9 < ours.scores.driving <= 1.0
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    main(["run", "basic", *address, "--routes", str(route_file), "--seed", "4", "--output", str(tmp_path / "theirs")])
    theirs = basu.load(tmp_path / "theirs" / "latest")
    assert isinstance(theirs, RunResult)
    assert ours.history.frames.tobytes() == theirs.history.frames.tobytes()
    assert ours.scores == theirs.scores


def test_a_class_defined_here_drives_and_its_failure_is_its_own(opened, route_file: Path, tmp_path: Path) -> None:
    result = basu.run(Gentle, routes=route_file, output=tmp_path, simulator=opened)
    assert result.outcome.status is Status.AGENT_CRASHED
    assert "enough" in result.outcome.message
    assert result.agent == "Gentle"
    assert len(result.history.frames) == 31


def test_an_instance_drives_one_run(opened, route_file: Path, tmp_path: Path) -> None:
    agent = Gentle()
    result = basu.run(agent, routes=route_file, output=tmp_path, simulator=opened)
    assert agent.steps == len(result.history.frames)
    with pytest.raises(UserError, match="an instance drives one run, and these are 2"):
        basu.run(Gentle(), routes=route_file, repetitions=2, output=tmp_path, simulator=opened)


def test_repetitions_give_a_list_with_the_next_seeds(opened, route_file: Path, tmp_path: Path) -> None:
    results = basu.run("forward", routes=route_file, seed=7, repetitions=2, output=tmp_path, simulator=opened)
    assert [result.document["meta"]["seed"] for result in results] == [7, 8]


def test_pictures_and_cards_show_inline(opened, route_file: Path, tmp_path: Path) -> None:
    result = basu.run("basic", routes=route_file, output=tmp_path, simulator=opened)
    for picture in (result.plot_path(result), result.plot_speed(), result.plot_speed(by="route")):
        data = picture._repr_png_()
        assert data is not None
        assert data.startswith(b"\x89PNG")
    card = result._repr_html_()
    assert "Completed" in card
    assert "data:image/png;base64," in card
    with pytest.raises(UserError, match="no axis 'distance'"):
        result.plot_speed(by="distance")


@pytest.mark.usefixtures("one_server")
def test_runs_without_a_simulator_of_their_own_share_one(route_file: Path, tmp_path: Path) -> None:
    try:
        first = basu.run("forward", routes=route_file, output=tmp_path)
        again = basu.run("forward", routes=route_file, output=tmp_path)
        assert first.history.frames.tobytes() == again.history.frames.tobytes()
        assert again.config["own_simulator"]
    finally:
        basu.close_simulator()


def test_cases_give_a_matrix_with_rows_for_pandas(simulator: RunningServer, tmp_path: Path) -> None:
    results = basu.run_scenarios(
        "lead_vehicle_brakes_1", agent=["basic", Path("forward").name], output=tmp_path, host="127.0.0.1",
        port=simulator.port,
    )  # fmt: skip
    assert isinstance(results, ScenarioResults)
    assert [(case.id, case.agent) for case in results] == [
        ("lead_vehicle_brakes_1", "basic"),
        ("lead_vehicle_brakes_1", "forward"),
    ]
    table = results.to_pandas()
    assert list(table["agent"]) == ["basic", "forward"]
    assert {"verdict", "distance_m", "brake"} <= set(table.columns)
    assert len(results.cases[0].history.frames) > 20
    again = basu.load(results.folder)
    assert isinstance(again, ScenarioResults)
    assert again.cases == results.cases
    assert "LeadVehicleBrakes" in results._repr_html_()
    with pytest.raises(UserError, match="no parameter was varied"):
        results.plot_sweep()


def test_a_class_plays_a_case_in_this_process(simulator: RunningServer, tmp_path: Path) -> None:
    results = basu.run_scenarios(
        "lead_vehicle_brakes_1", agent=Gentle, output=tmp_path, host="127.0.0.1", port=simulator.port
    )
    (case,) = results.cases
    assert case.agent == "Gentle"
    assert case.status is Status.AGENT_CRASHED


@pytest.mark.slow
def test_a_script_without_a_main_guard_may_use_several_workers(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import basu\n"
        "cases = ['lead_vehicle_brakes_1', 'lead_vehicle_brakes_2']\n"
        "found = basu.run_scenarios(cases, agent='forward', workers=2, in_process=True, output='out')\n"
        "print('cases', len(found.cases))\n",
        encoding="utf-8",
    )
    done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.splitlines() == ["cases 2"], done.stderr


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        pytest.param(lambda: basu.run("basic", routs="x.xml"), "routs means nothing; did you mean", id="option"),
        pytest.param(lambda: basu.run(3), "3 is no agent; give a name, a file, or a subclass", id="agent"),
        pytest.param(lambda: basu.run("basic", series="a"), "keeps no series; give repetitions=N", id="series"),
        pytest.param(lambda: basu.run_scenarios(sweep=3, grid=3), "exclude each other", id="designs"),
        pytest.param(lambda: basu.run_scenarios(agent=[Gentle, "basic"]), "not both at once", id="agents"),
        pytest.param(lambda: basu.run_scenarios(agent=Gentle()), "give its class", id="instance"),
        pytest.param(lambda: basu.load("nowhere"), "nowhere is no folder", id="folder"),
    ],
)
def test_bad_input_is_a_sentence(call, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        call()


def test_a_name_that_basu_lacks_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'drive'"):
        basu.drive  # noqa: B018
