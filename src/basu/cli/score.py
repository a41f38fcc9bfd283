"""``basu score``: scores a run again, from its folder alone."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from basu.cli.scoring import add_metrics, add_scoring, adjusted, read_scoring
from basu.errors import UserError
from basu.metrics.scoring_json import scoring_to_json
from basu.outcome import Outcome, Status
from basu.utils.json_file import read_json


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``score``."""
    score = commands.add_parser("score", help="score a run again, from its folder alone", description=score_run.__doc__)
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    add_scoring(score)
    add_metrics(score)
    score.set_defaults(command=score_run)


def score_run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts; no simulator is asked."""
    from basu.metrics.registry import user_metrics  # noqa: PLC0415 - likewise
    from basu.metrics.result import judge  # noqa: PLC0415 - likewise
    from basu.output.report.console import judgement, score_lines  # noqa: PLC0415 - likewise
    from basu.output.report.folder import CONFIG_FILE, RESULT_FILE  # noqa: PLC0415 - likewise
    from basu.records.history.files import read_history  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.running.series import SERIES_FILE  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    if (folder / SERIES_FILE).exists():
        raise UserError(f"{folder} is a series of runs; name one of them, a folder in it")
    kept = _kept(folder / RESULT_FILE)
    history = read_history(folder)
    scoring = adjusted(read_scoring(folder / CONFIG_FILE), arguments)
    outcome = Outcome(Status(kept["status"]), kept["message"]) if kept else Outcome(Status.COMPLETED, "scored again")
    result = judge(outcome, history, scoring, own=user_metrics(arguments.metrics))
    document = result.document()
    if kept is not None and kept["scoring"] == scoring_to_json(scoring) and kept["scores"] != document["scores"]:
        print(
            f"basu: {folder / RESULT_FILE} says {_scores(kept)}, and its record gives {_scores(document)}: the file "
            "was changed, or another version of basu wrote it",
            file=sys.stderr,
        )
    if arguments.json:
        print(json.dumps(document, indent=2, ensure_ascii=False))
        return 0
    print("\n".join([*score_lines(result), *judgement(result)] if result.scores else ["nothing was driven"]))
    return 0


def _kept(path: Path) -> dict[str, Any] | None:
    """The result that lies in the folder, of whatever version; None where there is none."""
    if not path.exists():
        return None
    document = read_json(path, "the result", "drive the run again, or remove the file to score its record alone")
    known = {status.value for status in Status}
    if not isinstance(document, dict) or document.get("status") not in known or "scores" not in document:
        raise UserError(f"{path} is no result of a run; remove the file to score the record alone")
    return document


def _scores(document: dict[str, Any]) -> str:
    """The scores in a few words."""
    return ", ".join(f"{name} {value:.6g}" for name, value in (document["scores"] or {"no score": math.nan}).items())
