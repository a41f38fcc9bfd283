"""Claims about metrics of a user's own: one file, and the metric is in result, console, report and comparison."""

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from basu.campaigns.columns import columns_of, schema_of
from basu.cli import main
from basu.errors import UserError
from basu.metrics import registry
from basu.metrics.display import Answer
from basu.metrics.registry import Drive, JudgedRun, Metric, TimedMark, built_in, user_metrics
from basu.metrics.result import Result, judge, result_schema
from basu.metrics.stretches import spans
from basu.outcome import Outcome, Status
from basu.output.report.comparison import rows, text
from basu.output.report.console import table
from basu.output.report.documents import RESULT_SCHEMA, mistakes, read_schema
from basu.output.report.html.page import report
from basu.records.history import History
from fakes.drives import at, driven, ramp
from fakes.results import META
from fakes.run_records import record

PAGE = Path(__file__).parents[4] / "docs" / "reference" / "metrics.md"
DONE = Outcome(Status.COMPLETED, "arrived")


@pytest.fixture
def own_file(tmp_path: Path) -> Path:
    """The example of the page, word for word."""
    example = PAGE.read_text(encoding="utf-8").partition("## A metric of your own")[2]
    found = re.search(r"```python\n(.*?)```", example, re.DOTALL)
    assert found is not None
    path = tmp_path / "own_metrics.py"
    path.write_text(found.group(1), encoding="utf-8")
    return path


def judged(own_file: Path) -> Result:
    history = driven([*at(4.0, 5.0), *ramp(4.0, 8.0, 4.0), *at(8.0, 5.0)])
    history.frames["applied_brake"][20:60] = 0.3
    return judge(DONE, history, meta=META, own=user_metrics([own_file]))


def test_the_example_of_the_page_reports_and_scores(own_file: Path) -> None:
    found = judged(own_file)
    assert found.own["brake_time"].value == pytest.approx(2.0)
    assert found.own["too_lively"].value == 1
    assert found.scores is not None
    assert found.scores.infraction == pytest.approx(0.9)
    assert [event.kind.value for event in found.infractions] == ["too_lively"]
    assert found.scoring["penalties"]["too_lively"] == 0.9


def test_the_document_holds_them_and_is_as_the_schema_says(own_file: Path) -> None:
    document = json.loads(json.dumps(judged(own_file).document(), allow_nan=False))
    assert list(mistakes(document, read_schema(RESULT_SCHEMA))) == []
    assert document["metrics"]["brake_time"]["unit"] == "s"
    assert Result.from_document(document) == judged(own_file)


def test_console_report_and_comparison_show_them(own_file: Path) -> None:
    found = judged(own_file)
    assert "brake time        2.0 s" in table(found)
    run = replace(record(found.history), result=found)
    page = report(run).decode()
    assert "brake time" in page
    assert "too lively" in page
    told = text(rows([run, record(found.history, agent="other")])).splitlines()
    assert "brake" in told[0]
    assert "2.0 s" in told[3]
    assert told[4].count("\u2013") == 2  # the other run has none of the two
    assert {name: value for name, value in columns_of(found, user_metrics([own_file])).items() if "own_" in name} == {
        "own_brake_time": pytest.approx(2.0), "own_too_lively": 1,
    }  # fmt: skip


class BrakeTime(Metric):
    """All that is written for one more metric of BASU's own."""

    name = "time_on_the_brake"
    title = "time on the brake"
    unit = "s"
    digits = 1
    timeline_row = "brake"

    def compute(self, drive: Drive) -> float:
        return float((drive.history.frames["applied_brake"] > 0.1).sum() * drive.history.facts.step_s)

    def answers(self, result: JudgedRun) -> list[Answer]:
        return [Answer("braking", "yes", f"for {self.text(result)}")]

    def moments(self, result: JudgedRun, history: History) -> list[TimedMark]:
        return spans(history, history.frames["applied_brake"] > 0.1, "braked", "standing")


@pytest.fixture
def one_more(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """One more metric of BASU's own, as `register` enters it."""
    monkeypatch.setattr(registry, "_BUILT_IN", dict(registry._BUILT_IN))
    built_in.cache_clear()
    registry.register(BrakeTime)
    yield
    monkeypatch.undo()
    built_in.cache_clear()


@pytest.mark.usefixtures("one_more")
def test_a_class_is_all_that_a_metric_of_our_own_needs() -> None:
    """It stands in result, schema, console, page with timeline, comparison and the columns of a campaign."""
    history = driven([*at(4.0, 5.0), *ramp(4.0, 8.0, 4.0), *at(8.0, 5.0)])
    history.frames["applied_brake"][20:60] = 0.3
    found = judge(DONE, history, meta=META)
    document = json.loads(json.dumps(found.document()))
    assert document["time_on_the_brake"] == pytest.approx(2.0)
    assert list(mistakes(document, result_schema())) == []
    assert "time on the brake 2.0 s" in table(found)
    assert "braking           yes: for 2.0 s" in table(found)
    run = replace(record(history), result=found)
    page = report(run).decode()
    assert "for 2.0 s" in page
    assert re.search(r"time on the brake</th><td>2\.0 s", page)
    assert re.search(
        r">brake</span><div class=\"row timed\"><i class=\"span standing\" title=\"braked from 1\.0 s", page
    )
    told = text(rows([run])).splitlines()
    assert "brake" in told[1]
    assert "2.0 s" in told[3]
    assert columns_of(found)["time_on_the_brake"] == pytest.approx(2.0)
    assert "time_on_the_brake" in schema_of({}).names


def test_they_judge_an_earlier_run_anew(own_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Path(__file__).parents[1] / "cli" / "run_of_version_2"
    assert main(["score", str(folder), "--metrics", str(own_file)]) == 0
    assert "brake time        2.0 s" in capsys.readouterr().out


def test_without_them_the_score_is_the_thesiss(own_file: Path) -> None:
    history = judged(own_file).history
    found = judge(DONE, history)
    assert found.scores is not None
    assert found.scores.infraction == 1.0
    assert found.own == {}


class Jolts(Metric):
    """A metric of an installed package."""

    name = "jolts"
    title = "jolts"

    def compute(self, drive: object) -> int:
        return 3


def test_an_installed_package_offers_them_by_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    point = EntryPoint(name="jolts", value=f"{__name__}:Jolts", group="basu.metrics")
    monkeypatch.setattr(registry, "entry_points", lambda group: [point] if group == "basu.metrics" else [])
    monkeypatch.setattr(registry, "installed", registry.installed.__wrapped__)  # without its cache
    (found,) = user_metrics()
    assert judge(DONE, driven(at(5.0, 5.0)), own=[found]).own["jolts"].value == 3


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("x = 1", "defines no subclass of basu.metrics.Metric"),
        ("1 / 0", "raised ZeroDivisionError: division by zero"),
        ("class A(Metric):\n    title = 'a'\n    def compute(self, drive): return 1", "A has no name; give it one"),
        ("class A(Metric):\n    name = 'A b'\n    title = 'a'\n    def compute(self, drive): return 1", "is no name"),
        (
            "class A(Metric):\n    name = 'passengers'\n    title = 'a'\n    def compute(self, drive): return 1",
            "already",
        ),
        ("class A(Metric):\n    name = title = 'a'", "A cannot be made"),
        (
            "class A(Metric):\n    name = title = 'a'\n    penalties = {'a': 2}\n    compute = len",
            "the penalty of a is 2; it is a factor and must lie in 0..1",
        ),
    ],
)
def test_a_file_that_holds_no_metric_gets_a_sentence(tmp_path: Path, source: str, sentence: str) -> None:
    path = tmp_path / "mine.py"
    path.write_text(f"from basu.metrics import Metric\n{source}\n")
    with pytest.raises(UserError, match=sentence):
        user_metrics([path])


def test_a_file_that_is_not_there_is_refused_before_the_drive(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "basic", "--metrics", "nowhere.py"]) == 2
    assert "--metrics: nowhere.py is no Python file" in capsys.readouterr().err


def test_each_metric_of_our_own_says_what_its_value_is() -> None:
    for metric in built_in():
        assert metric.schema, metric.name
        assert metric.title, metric.name


def test_metrics_are_loaded_without_scipy() -> None:
    """Each run loads them, and the import of scipy takes 0.2 s."""
    program = "import sys; from basu.metrics.registry import built_in; print(len(built_in()), 'scipy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(len(built_in())), "False"]
