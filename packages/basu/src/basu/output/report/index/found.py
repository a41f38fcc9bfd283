"""The results below a folder: runs with figures, and pages of series, scenario runs, campaigns and comparisons."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import read_json
from basu.metrics.result import Result
from basu.output.report.comparison_page import PAGE_FILE as COMPARISON
from basu.output.report.documents import CONFIG_FILE, REPORT_FILE, RESULT_FILE, TEXT_FILE, read_result
from basu.output.report.drive_row import row_of
from basu.output.report.in_words import answers
from basu.output.report.scenarios.matrix_documents import MATRIX_FILE
from basu.output.report.scenarios.page.matrix_page import PAGE_FILE as MATRIX_PAGE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

SERIES_FILE, SERIES_TEXT = "series.json", "series.txt"
CAMPAIGN_FILE, CAMPAIGN_PAGE = "campaign.json", "campaign.html"


class IndexedRun(NamedTuple):
    """A run or a case as a row."""

    folder: Path  # below the folder of the index
    page: Path | None  # its report, or its text; None where neither is there
    started: str
    agent: str
    version: str  # "file 3f2a91c", of the agent's file; "basu 0.1.0" for an agent that comes with BASU
    subject: str  # the route with its town, or the case
    conditions: tuple[str, ...]  # weather, traffic, vehicle: runs with others are not compared
    seed: int
    row: Mapping[str, Any]  # of `row_of`
    answers: Mapping[str, str]  # question: word
    comfort: float | None
    is_comparable: bool  # a gate stood before the agent, and the route was the benchmark's
    is_broken_off: bool

    @property
    def driving(self) -> float | None:
        """The driving score; None where nothing was driven or the run was not completed."""
        scores = self.row["scores"]
        return None if scores is None or self.is_broken_off else float(scores["driving"])

    @property
    def kind(self) -> tuple[str, ...]:
        """Runs of one kind differ in version and seed only."""
        return (self.agent, self.subject, str(self.row["track"]), *self.conditions)


class IndexedFolder(NamedTuple):
    """A folder with results of many drives."""

    folder: Path
    page: Path | None
    name: str
    lines: tuple[str, ...]  # what is known of it, in sentences
    runs: tuple[IndexedRun, ...] = ()


class Contents(NamedTuple):
    """All that was found."""

    runs: list[IndexedRun]
    series: list[IndexedFolder]
    matrices: list[IndexedFolder]
    campaigns: list[IndexedFolder]
    comparisons: list[IndexedFolder]
    unread: list[str]  # what could not be read, in sentences

    @property
    def all_runs(self) -> list[IndexedRun]:
        """The runs by themselves and those of series, by their start."""
        return sorted([*self.runs, *(run for each in self.series for run in each.runs)], key=lambda run: run.started)


def contents(folder: Path, seen: Callable[[], object]) -> Contents:
    """Return the results below a folder; ``seen`` is called for each.

    Raises:
        UserError: the folder is not there.
    """
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name one with results, such as runs")
    found = Contents([], [], [], [], [], [])
    for each in _folders(folder):
        try:
            _take(folder, each, found)
        except (UserError, KeyError, TypeError, ValueError, AttributeError, OSError) as error:
            said = str(error) if isinstance(error, UserError) else f"{each}: its documents are damaged ({error!r})"
            found.unread.append(said)
        seen()
    found.runs.sort(key=lambda run: (run.started, run.folder))
    return found


def _folders(folder: Path) -> Iterator[Path]:
    """Yield the folders with results below a folder, in the order of their names; not the drives within others."""
    for at, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith(".") and not (Path(at) / name).is_symlink())
        holds = {CAMPAIGN_FILE, MATRIX_FILE, SERIES_FILE, RESULT_FILE, COMPARISON} & set(files)
        if holds:
            yield Path(at)
        if holds - {COMPARISON}:
            folders.clear()


def _take(root: Path, folder: Path, found: Contents) -> None:
    """Add a folder with results."""
    if (folder / CAMPAIGN_FILE).is_file():
        found.campaigns.append(_campaign(root, folder))
    elif (folder / MATRIX_FILE).is_file():
        found.matrices.append(_matrix(root, folder))
    elif (folder / SERIES_FILE).is_file():
        found.series.append(_series(root, folder, found.unread))
    elif (folder / RESULT_FILE).is_file():
        found.runs.append(indexed_run(root, folder))
    else:
        page = (folder / COMPARISON).relative_to(root)
        found.comparisons.append(IndexedFolder(page.parent, page, str(page.parent), ()))


def indexed_run(root: Path, folder: Path) -> IndexedRun:
    """Return the row of a run's folder.

    Raises:
        UserError: it holds no result of this version.
    """
    result = Result.from_document(read_result(folder))
    meta, passengers = result.meta, result.metrics.get("passengers")
    config = read_json(folder / CONFIG_FILE, "the run's") if (folder / CONFIG_FILE).is_file() else {}
    traffic = meta.get("traffic") or {}
    subject = (
        str(result.case["id"]) if result.case is not None else f"route {meta.get('route')}, {meta.get('town', '')}"
    )
    return IndexedRun(
        folder=folder.relative_to(root),
        page=_page(root, folder, REPORT_FILE, TEXT_FILE),
        started=str(meta.get("started", "")),
        agent=str(meta["agent"]["name"]),
        version=version_of(meta, config),
        subject=subject,
        conditions=(
            str(meta.get("vehicle", "")),
            str(meta.get("weather", "")),
            f"{traffic.get('vehicles') or 0} vehicles, {traffic.get('walkers') or 0} walkers",
        ),
        seed=int(meta.get("seed") or 0),
        row=row_of(result),
        answers={answer.question: answer.word for answer in answers(result)},
        comfort=None if passengers is None else passengers["comfort_score"],
        is_comparable=not (result.is_open or result.has_own_route),
        is_broken_off=result.is_broken_off,
    )


def version_of(meta: Mapping[str, Any], config: Mapping[str, Any]) -> str:
    """Return the version of a run's agent: the beginning of its file's SHA-256, or BASU's version without a file."""
    name = Path(str(meta["agent"].get("file", ""))).name
    for file in config.get("files", []):
        if Path(str(file["path"])).name == name:
            return f"file {str(file['sha256'])[:7]}"
    return f"basu {meta.get('versions', {}).get('basu', 'of an unknown version')}"


def _page(root: Path, folder: Path, *names: str) -> Path | None:
    """Return the first of these files that is there, from the folder of the index."""
    return next(((folder / name).relative_to(root) for name in names if (folder / name).is_file()), None)


def _series(root: Path, folder: Path, unread: list[str]) -> IndexedFolder:
    """Return a series with its runs."""
    document = read_json(folder / SERIES_FILE, "the series")
    total = document["totals"]
    read = [_run_of_series(root, folder / each["folder"], unread) for each in document["runs"]]
    runs = [run for run in read if run is not None]
    driving = total["scores"]["driving"]
    lines = (
        f"{total['done']} of {total['planned']} runs done",
        f"driving score {driving['mean']:.3f} ± {driving['deviation']:.3f}",
        ", ".join(f"{count} {word}" for word, count in total.get("passed", {}).items() if count),
    )
    page = _page(root, folder, SERIES_TEXT)
    return IndexedFolder(
        folder.relative_to(root), page, folder.name, tuple(line for line in lines if line), tuple(runs)
    )


def _run_of_series(root: Path, folder: Path, unread: list[str]) -> IndexedRun | None:
    """Return a run of a series; None, and a sentence, where it cannot be read."""
    try:
        return indexed_run(root, folder)
    except UserError as error:
        unread.append(str(error))
        return None


def _matrix(root: Path, folder: Path) -> IndexedFolder:
    """Return a run of scenarios."""
    document = read_json(folder / MATRIX_FILE, "the matrix")
    lines = []
    for agent in document["agents"]:
        results = [case["results"][agent] for case in document["cases"] if agent in case["results"]]
        passed = sum(each["verdict"] == "SUCCESS" for each in results)
        judged = sum(each["verdict"] in ("SUCCESS", "FAILURE", "AGENT_FAULT") for each in results)
        lines.append(f"{agent}: {passed} of {judged} judged cases passed, {len(results)} played")
    return IndexedFolder(folder.relative_to(root), _page(root, folder, MATRIX_PAGE), folder.name, tuple(lines))


def _campaign(root: Path, folder: Path) -> IndexedFolder:
    """Return a campaign."""
    document = read_json(folder / CAMPAIGN_FILE, "the campaign's document")
    lines = (f"{document['planned']} drives planned", f"agents: {', '.join(document['agents'])}")
    return IndexedFolder(folder.relative_to(root), _page(root, folder, CAMPAIGN_PAGE), str(document["name"]), lines)
