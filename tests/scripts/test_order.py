"""The order in which files of tests start, and which tests measure coverage."""

import os
from pathlib import Path

import coverage
import pytest
from conftest import LONGEST

from tracing import untraced, untraced_processes

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", LONGEST)
def test_a_file_that_starts_early_exists(name: str) -> None:
    assert (ROOT / name).is_file()


def test_no_coverage_is_measured_within_the_block_and_it_goes_on_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with untraced():  # the run of these tests itself may be measured
        monkeypatch.setenv("COVERAGE_PROCESS_CONFIG", "all")
        measured = coverage.Coverage(data_file=tmp_path / "data", config_file=False)
        measured.start()
        with untraced():
            assert coverage.Coverage.current() is None
            assert "COVERAGE_PROCESS_CONFIG" not in os.environ
        assert coverage.Coverage.current() is measured
        assert os.environ["COVERAGE_PROCESS_CONFIG"] == "all"
        measured.stop()
        monkeypatch.undo()


def test_processes_are_not_measured_where_a_test_has_no_mark(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "COVERAGE_PROCESS_CONFIG" not in os.environ, "this test has no mark"
    monkeypatch.setenv("COVERAGE_PROCESS_CONFIG", "all")
    monkeypatch.setenv("COVERAGE_OF_SERVERS", "pyproject.toml")
    with untraced_processes():
        assert "COVERAGE_PROCESS_CONFIG" not in os.environ
        assert os.environ["COVERAGE_OF_SERVERS"] == "pyproject.toml"
    assert os.environ["COVERAGE_PROCESS_CONFIG"] == "all"


@pytest.mark.measured_processes
def test_processes_are_measured_with_the_mark_where_this_one_is() -> None:
    assert ("COVERAGE_PROCESS_CONFIG" in os.environ) == (coverage.Coverage.current() is not None)
