"""``basu score``: scores a run again, from its folder alone."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from basu.cli.scoring import add_scoring, adjusted, read_scoring
from basu.errors import UserError


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``score``."""
    score = commands.add_parser("score", help="score a run again, from its folder alone", description=score_run.__doc__)
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    add_scoring(score)
    score.set_defaults(command=score_run)


def score_run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts; no simulator is asked."""
    from basu.history.files import read_history  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.report.folder import CONFIG_FILE  # noqa: PLC0415 - likewise
    from basu.report.passengers_table import felt  # noqa: PLC0415 - likewise
    from basu.report.result import judgement  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    history = read_history(folder)
    scoring = adjusted(read_scoring(folder / CONFIG_FILE), arguments)
    document = judgement(history, scoring)
    if arguments.json:
        print(json.dumps(document, indent=2, ensure_ascii=False))
        return 0
    for name, value in document["scores"].items():
        print(f"{name:<16}{value:8.3f}")
    for row in document["infractions"]:
        print(f"  {row['t_s']:8.1f} s  {row['kind']:<21} {row['detail']}")
    for line in felt(document):
        print(line)
    return 0
