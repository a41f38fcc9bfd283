"""``basu report``: writes the report of a run again, from its folder alone."""

from __future__ import annotations

import argparse
from pathlib import Path


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``report``."""
    report = commands.add_parser(
        "report", help="write report.html of a run again, from its folder alone", description=write.__doc__
    )
    report.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    report.set_defaults(command=write)


def write(arguments: argparse.Namespace) -> int:
    """Write report.html: score card, map, timeline, plots and evidence in one file that opens offline."""
    from basu.output.report.html.page import REPORT_FILE, write_report  # noqa: PLC0415 - numpy, which `--help` does not need
    from basu.output.report.reading import read_run  # noqa: PLC0415 - pyarrow, likewise

    for folder in arguments.folders:
        write_report(folder, read_run(folder))
        print(folder / REPORT_FILE)
    return 0
