"""``basu compare``: runs side by side."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.errors import UserError
from basu.output.report.comparison_page import compare, compared


def run(arguments: argparse.Namespace) -> int:
    """Print a table as table 5.1 of the thesis; with --output write compare.html, and compare.png as its figure 5.3."""
    folders: list[Path] = arguments.folders
    if len(folders) < 2:
        raise UserError("one run alone cannot be compared; name two folders or more, or see `basu report RUN`")
    if arguments.output is None:
        print(compared(folders))
        print("no files were written; `-o DIR` writes compare.html and compare.png there")
    else:
        print(compare(folders, arguments.output))
    return 0
