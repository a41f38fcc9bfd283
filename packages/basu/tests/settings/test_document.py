"""Claims about config.json as a file: what is read back, what is refused and how, and what is warned of."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.settings.document import RUN, config_document, read_config
from basu.settings.option import fields_of
from basu.settings.resolve import resolve


def written(folder: Path, chosen: RunOptions | None = None, **changes: Any) -> Path:
    """A run's config with some entries changed; None takes an entry out."""
    route = folder / "r.xml"
    if not route.exists():
        route.write_text("<routes/>")
    document = config_document(RUN, chosen or RunOptions(), Scoring(), [route])
    merged = {key: value for key, value in {**document, **changes}.items() if value is not None}
    path = folder / "config.json"
    path.write_text(json.dumps(merged))
    return path


def test_a_config_holds_every_option_and_gives_back_what_repeats_the_run(tmp_path: Path) -> None:
    options = RunOptions(seed=4, walkers=3, host="there", output=Path("elsewhere"), step_limit_s=2.0)
    path = written(tmp_path, options)
    document = json.loads(path.read_text())
    names = {*document["options"], *document["session"]}
    assert names == {field.name for field in fields_of(RunOptions) if not field.option.is_rare}
    config = read_config(path, RUN, RunOptions)
    assert resolve(RunOptions, [config.options]) == RunOptions(seed=4, walkers=3, step_limit_s=2.0)
    assert resolve(Scoring, [config.scoring]) == Scoring()
    assert config.warnings == ()


def test_a_rare_option_stands_in_a_config_where_it_is_given(tmp_path: Path) -> None:
    path = written(tmp_path, RunOptions(shuttles=2))
    assert json.loads(path.read_text())["options"]["shuttles"] == 2
    assert resolve(RunOptions, [read_config(path, RUN, RunOptions).options]) == RunOptions(shuttles=2)


def test_a_folder_means_the_config_in_it(tmp_path: Path) -> None:
    written(tmp_path)
    assert read_config(tmp_path, RUN, RunOptions).warnings == ()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"schema_version": None}, r"has no 'schema_version': an earlier version .* \(it says: basu run basic\)"),
        ({"schema_version": 1}, "has the schema version 1, and this version of basu reads 2"),
        ({"kind": "scenario run"}, "is of kind 'scenario run'; use `basu scenario run --config"),
        ({"kind": "lunch"}, "is of kind 'lunch'; it must be 'run'"),
        ({"options": [1]}, r"config.json: options is \[1\]; it must be an object"),
        ({"options": {"host": "there"}}, "config.json: options.host is no part of a run's config; give --host"),
    ],
)
def test_a_config_that_cannot_be_used_is_refused(tmp_path: Path, changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        read_config(written(tmp_path, **changes), RUN, RunOptions)


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        ({"options": {"sede": 1}}, "config.json: options.sede means nothing; did you mean 'seed'?"),
        ({"scoring": {"harsh_stop_mps2": "x"}}, "config.json: scoring.harsh_stop_mps2 is 'x'; it must be a number"),
    ],
)
def test_a_wrong_value_is_named_with_path_and_key(
    tmp_path: Path, section: dict[str, Any], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, **section)
    assert main(["run", "--config", str(path)]) == 2
    assert capsys.readouterr().err == f"basu: {tmp_path}/{sentence}\n"


def test_what_has_changed_since_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, versions={"basu": "0.0.1"})
    (tmp_path / "r.xml").write_text("<routes><!-- other --></routes>")
    assert read_config(path, RUN, RunOptions).warnings[0].endswith("r.xml has changed since")
    assert read_config(path, RUN, RunOptions).warnings[1].startswith("basu was 0.0.1 and is ")
    (tmp_path / "r.xml").unlink()
    assert read_config(path, RUN, RunOptions).warnings[0].endswith("r.xml is not there any more")


def test_files_are_found_from_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.py").write_text("")
    path = written(tmp_path, RunOptions(agent="my.py:Mine", scenario_files=(Path("my.py"),), routes="routes/x.xml"))
    here = read_config(path, RUN, RunOptions).options.values
    assert (here["agent"], here["scenario_files"]) == ("my.py:Mine", ["my.py"])
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    there = read_config(path, RUN, RunOptions).options.values
    assert (there["agent"], there["scenario_files"]) == (f"{tmp_path}/my.py:Mine", [f"{tmp_path}/my.py"])
    assert there["routes"] == "routes/x.xml"
