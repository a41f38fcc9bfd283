"""Claims about what earlier versions left: every command reads it, or names the command that converts it.

`folders_of_november` has a series, a matrix and a case that version 0.1.0 of 26 November 2026 wrote, with the options
of then and without records. `run_of_version_2` is a run of the version before, with its record.
"""

import json
import shutil
from pathlib import Path

import pytest

import basu
from basu.cli import main
from basu.errors import UserError
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.results import RunResult, ScenarioResults
from basu.running.scenario_runs.options import ScenarioOptions
from basu.settings.document import CONFIG_VERSION, RUN, SCENARIO_RUN, read_config
from basu.settings.resolve import resolve

HERE = Path(__file__).parent
FOLDERS = HERE / "folders_of_november"
RUN_FOLDER, CASE_FOLDER = FOLDERS / "series" / "0001-basic-linden_leap-1", FOLDERS / "cases/basic/pedestrian_crossing_1"


def test_a_series_and_its_runs_are_read() -> None:
    runs = basu.load(FOLDERS / "series")
    assert isinstance(runs, list)
    assert [(run.agent, run.route, run.outcome.status.value) for run in runs] == [("basic", "0", "Stopped")] * 2
    assert runs[1].metrics["passengers"]["comfort_weights"]["service"] == 0.5


def test_a_matrix_and_its_case_are_read_as_runs() -> None:
    matrix = basu.load(FOLDERS / "cases")
    assert isinstance(matrix, ScenarioResults)
    (case,) = matrix.cases
    assert (case.verdict, case.run.passed, case.document["id"]) == ("NOT_EXERCISED", None, "pedestrian_crossing_1")
    assert "pedestrian_crossing_1" in str(matrix)


def test_the_options_and_the_scoring_of_then_repeat_a_run() -> None:
    config = read_config(RUN_FOLDER, RUN, RunOptions)
    options, scoring = resolve(RunOptions, [config.options]), resolve(Scoring, [config.scoring])
    assert (options.seed, options.stop_after_s, options.repetitions) == (1, 1.0, 1)
    assert (scoring.comfort_weights.service, scoring.standing_place.forward_m) == (0.5, 1.5)
    case = resolve(ScenarioOptions, [read_config(CASE_FOLDER, SCENARIO_RUN, ScenarioOptions).options])
    assert (case.what, case.agents) == (("pedestrian_crossing_1",), ("basic",))


def test_an_option_that_is_gone_is_refused_with_what_replaces_it(tmp_path: Path) -> None:
    document = json.loads((RUN_FOLDER / "config.json").read_text("utf-8"))
    document["options"]["sumo_sublane"] = True  # as versions before it wrote
    (tmp_path / "config.json").write_text(json.dumps(document), "utf-8")
    with pytest.raises(UserError, match=r"sumo_sublane is no option any more: write <lateral-resolution"):
        resolve(RunOptions, [read_config(tmp_path, RUN, RunOptions).options])


def test_a_config_of_a_later_version_is_refused(tmp_path: Path) -> None:
    (tmp_path / "config.json").write_text('{"schema_version": 99, "kind": "run"}', "utf-8")
    with pytest.raises(UserError, match=f"version 99, and this version of basu reads {CONFIG_VERSION}; use the ver"):
        read_config(tmp_path, RUN, RunOptions)


def test_a_result_of_an_earlier_version_names_the_command_that_converts_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = shutil.copytree(HERE / "run_of_version_2", tmp_path / "run")
    for command in (["report", str(folder)], ["compare", str(folder), str(RUN_FOLDER)]):
        assert main(command) == 2
        assert f"`basu score {folder} --write` judges its record" in capsys.readouterr().err
    before = json.loads((folder / "result.json").read_text("utf-8"))["scores"]
    assert main(["score", str(folder), "--write"]) == 0
    assert main(["report", str(folder)]) == 0
    assert "comfortable" in (folder / "report.html").read_text("utf-8")
    found = basu.load(folder)
    assert isinstance(found, RunResult)
    assert found.scores is not None
    assert found.scores._asdict() == before
