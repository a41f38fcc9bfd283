"""``basu score``: scores and infractions of a run again, from its folder."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from basu.cli.typed_options import scoring_of
from basu.errors import UserError
from basu.files import read_json
from basu.metrics.registry import user_metrics
from basu.metrics.result import judge
from basu.metrics.scoring import scoring_of_run, scoring_to_json
from basu.outcome import Outcome, Status
from basu.output.report.console import judgement, score_lines
from basu.output.report.documents import CONFIG_FILE, RESULT_FILE, write_json
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE
from basu.records.history.files import lacks, read_history
from basu.running.series import SERIES_FILE


def run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts, without a simulator."""
    folder: Path = arguments.folder
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    if (folder / SERIES_FILE).exists():
        raise UserError(f"{folder} is a series of runs; name one of them, a folder in it")
    if (folder / MATRIX_FILE).exists():
        again = f"`basu scenario run --config {folder / CONFIG_FILE}`"
        raise UserError(f"{folder} holds scenario cases, which are judged where they are played; {again} repeats them")
    kept = _kept(folder / RESULT_FILE)
    history = read_history(folder)
    if (missing := lacks(folder)) is not None:
        print(f"basu: warning: {missing}", file=sys.stderr)
    scoring = scoring_of(arguments, scoring_of_run(folder / CONFIG_FILE))
    outcome = Outcome(Status(kept["status"]), kept["message"]) if kept else Outcome(Status.COMPLETED, "scored again")
    kept_as = kept or {}
    result = judge(
        outcome,
        history,
        scoring,
        kept_as.get("meta"),
        own=user_metrics(arguments.metrics),
        scenarios=kept_as.get("scenarios", ()),
        case=kept_as.get("case"),
    )
    document = result.document()
    if kept is not None and kept["scoring"] == scoring_to_json(scoring) and kept["scores"] != document["scores"]:
        print(
            f"basu: {folder / RESULT_FILE} says {_scores(kept)}, and its record gives {_scores(document)}: the file "
            "was changed, or another version of basu wrote it",
            file=sys.stderr,
        )
    if arguments.write:
        write_json(folder / RESULT_FILE, document)
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
    if isinstance(document, dict) and "verdict" in document:
        raise UserError(
            f"{path.parent} is a case that an earlier version of basu played, without a score; play it again with "
            f"`basu scenario run --config {path.with_name('config.json')}`"
        )
    known = {status.value for status in Status}
    if not isinstance(document, dict) or document.get("status") not in known or "scores" not in document:
        raise UserError(f"{path} is no result of a run; remove the file to score the record alone")
    return document


def _scores(document: dict[str, Any]) -> str:
    """The scores in a few words."""
    return ", ".join(f"{name} {value:.6g}" for name, value in (document["scores"] or {"no score": math.nan}).items())
