"""``index.html``: a table of all runs of a folder, trends between versions of each agent, and pages of many drives."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from basu.files import write_bytes
from basu.output.report.documents import REPORT_FILE
from basu.output.report.html.page import page
from basu.output.report.index.found import contents
from basu.output.report.index.trends import trends
from basu.output.report.scenarios.tally import counted
from basu.output.report.templates import render

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.output.report.index.found import Contents, IndexedFolder, IndexedRun

INDEX_FILE = "index.html"
QUESTIONS = ("safe", "comfortable", "on time")


def write_index(folder: Path, seen: Callable[[], object]) -> tuple[Path, Contents]:
    """Write the index of a folder, and return its path with what was found; ``seen`` is called for each result.

    Raises:
        UserError: the folder is not there, or cannot be written.
    """
    found = contents(folder, seen)
    path = folder / INDEX_FILE
    write_bytes(path, index_page(folder.resolve().name, found))
    return path, found


def index_page(name: str, found: Contents) -> bytes:
    """Return the index of the folder ``name``."""
    runs = found.all_runs
    agents = dict.fromkeys(run.agent for run in runs)
    shown = trends(runs)
    body = render(
        "templates/index.j2",
        name=name,
        summary=_summary(found),
        questions=QUESTIONS,
        agents=[
            (agent, _anchor(list(agents).index(agent)), [trend for trend in shown if trend.agent == agent])
            for agent in agents
        ],
        runs=[_row(run, _anchor(list(agents).index(run.agent))) for run in reversed(runs)],
        groups=[
            ("Series", [_linked(each) for each in found.series]),
            ("Scenario runs", [_linked(each) for each in found.matrices]),
            ("Campaigns", [_linked(each) for each in found.campaigns]),
            ("Comparisons", [_linked(each) for each in found.comparisons]),
        ],
        unread=found.unread,
    )
    return page(f"Results in {name}", body)


def _summary(found: Contents) -> str:
    """Return what was found, in a line."""
    parts = [
        counted(len(found.runs), "run"),
        f"{len(found.series)} series",
        counted(len(found.matrices), "scenario run"),
        counted(len(found.campaigns), "campaign"),
        counted(len(found.comparisons), "comparison"),
    ]
    return ", ".join(part for part in parts if not part.startswith("0 ")) or "no results"


def _anchor(number: int) -> str:
    """Return the name of an agent's section in the page."""
    return f"agent-{number + 1}"


def _row(run: IndexedRun, anchor: str) -> dict[str, Any]:
    """Return a row of the table of runs."""
    return {
        "run": run,
        "anchor": anchor,
        "address": _address(run.page),
        "settings": f"{_address(run.page)}#configuration" if run.page is not None and _is_report(run.page) else None,
        "infractions": sum(run.row["infractions"].values()),
        "result": {True: "passed", False: "failed", None: "not judged"}[run.row["passed"]],
    }


def _linked(each: IndexedFolder) -> dict[str, Any]:
    """Return a folder of many drives with its address."""
    return {"folder": each, "address": _address(each.page)}


def _address(file: Path | None) -> str | None:
    """Return the address of a file below the index; a report learns from it the way back."""
    if file is None:
        return None
    back = "../" * (len(file.parts) - 1) + INDEX_FILE
    return quote(file.as_posix()) + (f"?index={back}" if _is_report(file) else "")


def _is_report(file: Path) -> bool:
    """Return whether a page is the report of a run."""
    return file.name == REPORT_FILE
