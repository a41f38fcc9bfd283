"""Results as Python objects: a run with scores, events, record and pictures; a matrix of cases; and how both are read.

Everything comes from the documents in a run's folder. So a result that was just driven and one that is read again later
are the same.
"""

from __future__ import annotations

from pathlib import Path

from basu.files import read_json
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE
from basu.results.picture import Picture
from basu.results.run_result import RunResult
from basu.results.scenario_results import CaseResult, ScenarioResults

__all__ = ["CaseResult", "Picture", "RunResult", "ScenarioResults", "load"]

SERIES_FILE = "series.json"


def load(folder: str | Path) -> RunResult | list[RunResult] | ScenarioResults:
    """Read the folder of a run, of a series (a list of its runs), or of a matrix of scenarios.

    Raises:
        UserError: it is none of these.
    """
    path = Path(folder)
    if (path / MATRIX_FILE).exists():
        return ScenarioResults(path)
    if (path / SERIES_FILE).exists():
        series = read_json(path / SERIES_FILE, "the series'", "drive the series again")
        assert isinstance(series, dict), "we have written it"
        return [RunResult(path / run["folder"]) for run in series["runs"]]
    return RunResult(path)
