"""Claims about `basu score` on a folder that the version before wrote: a new judgement, or a sentence.

`run_of_version_2` is a drive of six seconds: schema version 2 of facts and result, without the applied control.
"""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from basu.cli import main
from basu.records.history.files import read_history
from basu.records.history.model import CONTROL

EARLIER = Path(__file__).parent / "run_of_version_2"


def test_an_earlier_run_gets_a_new_judgement(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["score", str(EARLIER), "--json"]) == 0
    told = capsys.readouterr()
    found, kept = json.loads(told.out), json.loads((EARLIER / "result.json").read_text())
    assert (kept["schema_version"], found["schema_version"]) == (2, 3)
    assert found["scores"] == kept["scores"]
    assert found["passengers"]["harm"]["contacts"] == 0
    assert found["collisions"] == {"number": 0, "at_fault": 0}
    assert "it holds neither standing things nor the applied control" in told.err


def test_the_table_of_an_earlier_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["score", str(EARLIER)]) == 0
    told = capsys.readouterr().out
    assert told.startswith("driving score        0.981\n")
    assert "passengers        passed" in told


def test_the_requested_control_of_an_earlier_run_is_read_as_the_applied_one() -> None:
    history = read_history(EARLIER)
    for name in CONTROL:
        np.testing.assert_array_equal(history.frames[f"applied_{name}"], history.frames[name])


def test_a_report_of_an_earlier_result_is_refused_in_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(EARLIER)]) == 2
    assert "has the schema version 2, and this version of basu reads 3" in capsys.readouterr().err


def test_a_result_that_is_none_is_refused_in_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = shutil.copytree(EARLIER, tmp_path / "run")
    (folder / "result.json").write_text("[]")
    assert main(["score", str(folder)]) == 2
    assert "is no result of a run; remove the file to score the record alone" in capsys.readouterr().err


def test_a_scenario_cases_folder_and_that_of_all_cases_say_how_to_repeat_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = shutil.copytree(EARLIER, tmp_path / "case")
    (folder / "result.json").write_text('{"id": "roundabout_1", "status": "Completed", "verdict": "SUCCESS"}')
    assert main(["score", str(folder)]) == 2
    assert "is a case that an earlier version of basu played, without a score" in (said := capsys.readouterr().err)
    assert f"basu scenario run --config {folder / 'config.json'}" in said
    (tmp_path / "matrix.json").write_text("{}")
    assert main(["score", str(tmp_path)]) == 2
    assert f"basu scenario run --config {tmp_path / 'config.json'}" in capsys.readouterr().err
