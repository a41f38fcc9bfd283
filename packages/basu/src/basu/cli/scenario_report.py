"""``basu scenario report``: the reports of a run of scenarios, made again."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.output.report.scenarios.matrix_documents import read_matrix
from basu.running.scenario_runs.command import report_again


def run(arguments: argparse.Namespace) -> int:
    """Make table, JUnit XML, page and maps of a run again, from what lies in its folder."""
    folder: Path = arguments.folder.resolve()
    report_again(folder, read_matrix(folder), arguments.junit)
    return 0
