"""``basu report``: report.html of a run again, from its folder."""

from __future__ import annotations

import argparse

from basu.output.report.documents import REPORT_FILE, read_run
from basu.output.report.html.page import write_report


def run(arguments: argparse.Namespace) -> int:
    """Write report.html: score card, map, timeline, plots and evidence in one file that opens offline."""
    for folder in arguments.folders:
        write_report(folder, read_run(folder))
        print(folder / REPORT_FILE)
    return 0
