"""``basu compare``: runs side by side, as a table, a page and a picture."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.errors import UserError


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``compare``."""
    compare = commands.add_parser("compare", help="put runs side by side", description=compare_runs.__doc__)
    compare.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="two run folders or more")
    compare.add_argument(
        "--output", type=Path, metavar="DIR", help="for compare.html and compare.png (default: beside the first run)"
    )
    compare.set_defaults(command=compare_runs)


def compare_runs(arguments: argparse.Namespace) -> int:
    """Print a table as table 5.1 of the thesis; write compare.html, and compare.png as its figure 5.3."""
    from basu.output.report.compare.writing import compare  # noqa: PLC0415 - plots, which `--help` does not need

    folders: list[Path] = arguments.folders
    if len(folders) < 2:
        raise UserError("one run alone cannot be compared; name two folders or more, or see `basu report RUN`")
    print(compare(folders, arguments.output or folders[0].resolve().parent))
    return 0
