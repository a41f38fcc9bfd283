"""``basu scenario risk``: what the agents of a run or a campaign are expected to do in a million miles."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.campaigns.campaign_folder import CAMPAIGN_FILE
from basu.campaigns.risk_cases import played_in
from basu.output.report.scenarios.matrix_documents import read_matrix
from basu.output.report.scenarios.risk_report import PAGE_FILE, risk_text, risks_of, write_risks
from basu.scenarios.risk.estimate import risk
from basu.scenarios.risk.exposure import read_exposure


def run(arguments: argparse.Namespace) -> int:
    """Show and write the risk of each agent."""
    folder: Path = arguments.folder.resolve()
    counted = {} if arguments.encounters is None else read_exposure(arguments.encounters)
    if (folder / CAMPAIGN_FILE).exists():
        found = {agent: risk(cases, counted) for agent, cases in played_in(folder).items()}
    else:
        found = risks_of(folder, read_matrix(folder), counted)
    print("\n".join(risk_text(found)))
    write_risks(folder, found)
    print(f"\nreport  {folder / PAGE_FILE}")
    return 0
