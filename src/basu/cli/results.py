"""``basu score``, ``report``, ``compare`` and ``list``: what is made from run folders, without a simulator."""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

from basu.errors import UserError
from basu.files import read_json


def add_score(score: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu score``."""
    from basu.cli.run import add_scoring  # noqa: PLC0415 - numpy, which the other commands here do not need

    score.description = score_run.__doc__
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    score.add_argument(
        "--metrics",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.py",
        help="metrics of your own; may be given several times",
    )
    add_scoring(score)
    score.set_defaults(command=score_run)


def add_report(report: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu report``."""
    report.description = write_reports.__doc__
    report.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    report.set_defaults(command=write_reports)


def add_compare(compare: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu compare``."""
    compare.description = compare_runs.__doc__
    compare.add_argument("folders", nargs="+", type=Path, metavar="RUN", help="two run folders or more")
    compare.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help="write compare.html and compare.png there (default: write no files)",
    )
    compare.set_defaults(command=compare_runs)


def add_list(listing: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu list``."""
    listing.description = list_all.__doc__
    listing.set_defaults(command=list_all)


def score_run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts, without a simulator."""
    from basu.cli.run import scoring_of  # noqa: PLC0415 - as above
    from basu.metrics.registry import user_metrics  # noqa: PLC0415 - numpy, likewise
    from basu.metrics.result import judge  # noqa: PLC0415 - likewise
    from basu.metrics.scoring import scoring_of_run, scoring_to_json  # noqa: PLC0415 - as above
    from basu.outcome import Outcome, Status  # noqa: PLC0415 - likewise
    from basu.output.report.console import judgement, score_lines  # noqa: PLC0415 - likewise
    from basu.output.report.documents import CONFIG_FILE, RESULT_FILE  # noqa: PLC0415 - likewise
    from basu.output.report.scenarios.matrix_documents import MATRIX_FILE  # noqa: PLC0415 - likewise
    from basu.records.history.files import lacks, read_history  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.running.series import SERIES_FILE  # noqa: PLC0415 - likewise

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
    meta, scenarios = (kept.get("meta"), kept.get("scenarios", ())) if kept else (None, ())
    result = judge(outcome, history, scoring, meta, own=user_metrics(arguments.metrics), scenarios=scenarios)
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
    from basu.outcome import Status  # noqa: PLC0415 - likewise

    if not path.exists():
        return None
    document = read_json(path, "the result", "drive the run again, or remove the file to score its record alone")
    if isinstance(document, dict) and "verdict" in document:
        raise UserError(
            f"{path.parent} is the folder of a played scenario case, whose verdict comes from its place in the town as "
            f"well: play it again with `basu scenario run --config {path.with_name('config.json')}`"
        )
    known = {status.value for status in Status}
    if not isinstance(document, dict) or document.get("status") not in known or "scores" not in document:
        raise UserError(f"{path} is no result of a run; remove the file to score the record alone")
    return document


def _scores(document: dict[str, Any]) -> str:
    """The scores in a few words."""
    return ", ".join(f"{name} {value:.6g}" for name, value in (document["scores"] or {"no score": math.nan}).items())


def write_reports(arguments: argparse.Namespace) -> int:
    """Write report.html: score card, map, timeline, plots and evidence in one file that opens offline."""
    from basu.output.report.documents import read_run  # noqa: PLC0415 - pyarrow, likewise
    from basu.output.report.html.page import REPORT_FILE, write_report  # noqa: PLC0415 - numpy, which `--help` does not need

    for folder in arguments.folders:
        write_report(folder, read_run(folder))
        print(folder / REPORT_FILE)
    return 0


def compare_runs(arguments: argparse.Namespace) -> int:
    """Print a table as table 5.1 of the thesis; with --output write compare.html, and compare.png as its figure 5.3."""
    from basu.output.report.comparison_page import compare, compared  # noqa: PLC0415 - plots, which `--help` does not need

    folders: list[Path] = arguments.folders
    if len(folders) < 2:
        raise UserError("one run alone cannot be compared; name two folders or more, or see `basu report RUN`")
    if arguments.output is None:
        print(compared(folders))
        print("no files were written; `-o DIR` writes compare.html and compare.png there")
    else:
        print(compare(folders, arguments.output))
    return 0


def list_all(_arguments: argparse.Namespace) -> int:
    """Show the agents and routes that come with BASU."""
    from basu.agents.loader import BUILT_IN  # noqa: PLC0415 - brings in the client
    from basu.files import PACKAGE_FOLDER  # noqa: PLC0415 - likewise
    from basu.routing.route_file import read_routes  # noqa: PLC0415 - likewise

    print("agents:")
    for name in BUILT_IN:
        print(f"  {name}")
    print("routes:")
    for path in sorted((PACKAGE_FOLDER / "routes").glob("*.xml")):
        for route in read_routes(path):
            stops = f", {len(route.stops)} service stops" if route.stops else ""
            print(f"  routes/{path.name}: {route.id} in {route.town}, {len(route.points)} points{stops}")
    return 0
