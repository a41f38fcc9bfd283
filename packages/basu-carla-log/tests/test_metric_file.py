"""Claims about metrics of a user's own: what is found in a file, what is handed over, what is told when it fails."""

import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from basu.errors import UserError
from basu_carla_log.metric_file import run_metric

GOOD = """
from basu_carla_log.metric_file import BasicMetric

class Mine(BasicMetric):
    def _create_metric(self, town_map, log, criteria):
        print(town_map, log, criteria)
"""


def doing(deed: str) -> str:
    """A metric that does this."""
    return GOOD.replace("print(town_map, log, criteria)", deed)


def run(folder: Path, text: str, wanted: str = "mine.py") -> str:
    """Run a file with this text."""
    (folder / "mine.py").write_text(text)
    handed: Any = "log"
    return run_metric(str(folder / wanted), "map", handed, {"a": 1})


def test_a_metric_is_handed_map_log_and_criteria(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, GOOD) == "Mine"
    assert capsys.readouterr().out == "map log {'a': 1}\n"


def test_a_file_written_for_scenario_runner_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = GOOD.replace("basu_carla_log.metric_file", "srunner.metrics.examples.basic_metric")
    assert run(tmp_path, text) == "Mine"
    assert capsys.readouterr().out.startswith("map log")
    assert "srunner" not in sys.modules


def test_scenario_runners_own_base_is_taken_where_it_is_installed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    base = ModuleType("srunner.metrics.examples.basic_metric")
    exec("class BasicMetric:\n    def __init__(self, *given):\n        print('theirs', *given)", base.__dict__)
    monkeypatch.setitem(sys.modules, "srunner", ModuleType("srunner"))
    for name in ("srunner.metrics", "srunner.metrics.examples"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    monkeypatch.setitem(sys.modules, base.__name__, base)
    run(tmp_path, f"from {base.__name__} import BasicMetric\nclass Mine(BasicMetric): pass")
    assert capsys.readouterr().out == "theirs map log {'a': 1}\n"


@pytest.mark.parametrize(
    ("text", "wanted", "sentence"),
    [
        (GOOD, "other.py", "other.py is not there; name a Python file"),
        (GOOD, "mine.txt", "mine.txt is not there; name a Python file"),
        ("x = 1", "mine.py", "has no class that is a BasicMetric"),
        (GOOD + GOOD.replace("Mine", "Second"), "mine.py", r"2 metrics \(Mine, Second\); name one as .*mine.py:Mine"),
        (GOOD, "mine.py:Third", "has no metric Third; it has Mine"),
        (GOOD.replace("_create_metric", "create"), "mine.py", "the metric Mine in .* has no _create_metric"),
        ("class", "mine.py", "is no Python: line 1"),
        ("\nimport nothing_of_this_name", "mine.py", r"does not load: ModuleNotFoundError: .* \(line 2 of .*mine.py\)"),
        (doing("1 / 0"), "mine.py", r"Mine raised ZeroDivisionError: division by zero \(line 6 of .*mine.py\)"),
        (doing("exit(3)"), "mine.py", "the metric Mine raised SystemExit: 3"),
        (doing("__import__('json').loads('{')"), "mine.py", "raised JSONDecodeError: .* .line 6 of"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_metric_is_a_sentence(tmp_path: Path, text: str, wanted: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        run(tmp_path, text, wanted)


def test_one_of_several_is_named(tmp_path: Path) -> None:
    assert run(tmp_path, GOOD + GOOD.replace("Mine", "Second"), "mine.py:Second") == "Second"
