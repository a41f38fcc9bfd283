"""``basu leaderboard results``: the leaderboard's result file from runs of BASU."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from basu.cli.later import later
from basu.errors import UserError
from basu.plugins import Command

if TYPE_CHECKING:
    import argparse

VERSIONS = ("2.0", "2.1")


def add_leaderboard(leaderboard: argparse.ArgumentParser) -> None:
    """Add the commands below ``basu leaderboard``."""
    leaderboard.description = "What the CARLA leaderboard writes of runs."
    commands = leaderboard.add_subparsers(title="commands", metavar="COMMAND", required=True)
    results = commands.add_parser("results", help="write the leaderboard's result file of runs")
    results.description = (
        "Write the JSON file that the leaderboard's evaluator leaves, as --checkpoint of it, from runs that were "
        "driven with --leaderboard-track. The runs stand in it in the order given."
    )
    results.add_argument("runs", type=Path, nargs="+", metavar="RUN", help="folders of runs, or of a series")
    results.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE.json", help="the file to write; it is replaced"
    )
    results.add_argument(
        "--version", choices=VERSIONS, default="2.0", help="the version of the rules of scoring (default: %(default)s)"
    )
    results.set_defaults(command=later("basu_leaderboard.commands:run"))


def run(arguments: argparse.Namespace) -> int:
    """Write the result file, and print its status and driving score."""
    from basu.output.report.documents import write_json  # noqa: PLC0415 - with what reads results, slow to import
    from basu.results import ScenarioResults, load  # noqa: PLC0415 - likewise
    from basu_leaderboard.submission import SubmittedRun, submission  # noqa: PLC0415 - likewise

    runs: list[SubmittedRun] = []
    seen: Counter[str] = Counter()
    for folder in arguments.runs:
        found = load(folder)
        if isinstance(found, ScenarioResults):
            raise UserError(f"{folder} is a matrix of scenarios; the leaderboard's file is of runs along routes")
        for each in found if isinstance(found, list) else [found]:
            history = None if each.result.scores is None else each.history
            runs.append(SubmittedRun(each.result, history, seen[each.route]))
            seen[each.route] += 1
    document = submission(runs, arguments.version)
    write_json(arguments.output, document)
    status, score = document["entry_status"], document["values"][0]
    sys.stdout.write(f"{arguments.output}: {status}, {len(runs)} routes, driving score {score}\n")
    return 0


LEADERBOARD = Command("write the CARLA leaderboard's result file of runs", add_leaderboard)
