"""Arguments of ``basu report``, ``compare``, ``index`` and ``list``, which need no simulator."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.later import later


def add_report(report: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu report``."""
    report.description = (
        "Write report.html: score card, map, timeline, plots and evidence in one file that opens offline."
    )
    report.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    report.set_defaults(command=later("basu.cli.report:run"))


def add_compare(compare: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu compare``."""
    compare.description = (
        "Print a table as table 5.1 of the thesis; with --output write compare.html, and compare.png as its figure 5.3."
    )
    compare.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="two run folders or more")
    compare.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help="write compare.html and compare.png there (default: write no files)",
    )
    compare.set_defaults(command=later("basu.cli.compare:run"))


def add_index(index: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu index``."""
    index.description = (
        "Write index.html: all runs, series, scenario runs, campaigns and comparisons below a folder on one page, with "
        "the trend between versions of each agent."
    )
    index.add_argument(
        "folder", nargs="?", type=Path, default=Path("runs"), metavar="FOLDER", help="folder of results (default: runs)"
    )
    index.set_defaults(command=later("basu.cli.index:run"))


def add_list(listing: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu list``."""
    listing.description = "Show the agents and routes that come with BASU."
    listing.set_defaults(command=later("basu.cli.listing:run"))
