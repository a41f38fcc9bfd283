"""``basu scenario risk``: what the agents of a run are expected to do in a million miles."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.output.report.scenarios.matrix_documents import read_matrix
from basu.output.report.scenarios.risk_report import PAGE_FILE, risk_text, risks_of, write_risks
from basu.scenarios.risk.exposure import read_exposure


def run(arguments: argparse.Namespace) -> int:
    """Show and write the risk of each agent."""
    folder: Path = arguments.folder.resolve()
    counted = {} if arguments.encounters is None else read_exposure(arguments.encounters)
    found = risks_of(folder, read_matrix(folder), counted)
    print("\n".join(risk_text(found)))
    write_risks(folder, found)
    print(f"\nreport  {folder / PAGE_FILE}")
    return 0
