"""``basu score``: scores a run again, from its folder alone."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from basu.cli.scoring import add_scoring, adjusted, read_scoring
from basu.errors import UserError
from basu.metrics.scoring_json import scoring_to_json


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``score``."""
    score = commands.add_parser("score", help="score a run again, from its folder alone", description=score_run.__doc__)
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    add_scoring(score)
    score.set_defaults(command=score_run)


def score_run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts; no simulator is asked."""
    from basu.output.report.folder import CONFIG_FILE, RESULT_FILE  # noqa: PLC0415 - likewise
    from basu.output.report.measures_table import measured  # noqa: PLC0415 - likewise
    from basu.output.report.passengers_table import felt  # noqa: PLC0415 - likewise
    from basu.output.report.result import judgement  # noqa: PLC0415 - likewise
    from basu.output.report.schema import read_result  # noqa: PLC0415 - likewise
    from basu.records.history.files import read_history  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.running.series import SERIES_FILE  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    if (folder / SERIES_FILE).exists():
        raise UserError(f"{folder} is a series of runs; name one of them, a folder in it")
    kept = read_result(folder) if (folder / RESULT_FILE).exists() else None
    history = read_history(folder)
    scoring = adjusted(read_scoring(folder / CONFIG_FILE), arguments)
    document = judgement(history, scoring)
    if kept is not None and kept["scoring"] == scoring_to_json(scoring) and kept["scores"] != document["scores"]:
        print(
            f"basu: {folder / RESULT_FILE} says {_scores(kept)}, and its record gives {_scores(document)}: the file "
            "was changed, or another version of basu wrote it",
            file=sys.stderr,
        )
    if arguments.json:
        print(json.dumps(document, indent=2, ensure_ascii=False))
        return 0
    for name, value in document["scores"].items():
        print(f"{name:<16}{value:8.3f}")
    for row in document["infractions"]:
        print(f"  {row['t_s']:8.1f} s  {row['kind']:<21} {row['detail']}")
    for line in (*measured(document), *felt(document)):
        print(line)
    return 0


def _scores(document: dict[str, Any]) -> str:
    """The scores in a few words."""
    return ", ".join(f"{name} {value:.6g}" for name, value in (document["scores"] or {"no score": math.nan}).items())
