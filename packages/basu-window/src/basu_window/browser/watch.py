"""``basu watch``: the page of recorded runs, with a slider, infractions as marks, and further runs as ghosts."""

from __future__ import annotations

import gzip
import re
import select
from functools import partial
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.metrics.incremental import SoFar
from basu.metrics.score import infractions, score
from basu.metrics.scoring import Scoring, scoring_of_run
from basu.output.report.documents import CONFIG_FILE, REPORT_FILE
from basu.records.history.files import HISTORY_FILE, lacks, read_history
from basu.records.recording_files import MAP_FILE
from basu.settings.resolve import resolve
from basu_window.browser.film import check_film, write_film
from basu_window.browser.frames import (
    RUN_COLOURS,
    actors_note,
    mark_of,
    moment_of,
    packed,
    panel_note,
    record_frames,
    route_note,
)
from linden.errors import UserError as LindenError
from linden_window.link import PageLink

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from basu.records.history import History

MOST_RUNS = 8
PANEL_EVERY_S = 1.0
_STARTED = re.compile(r"^\d{4}-\d\d-\d\dT\d\d-\d\d-\d\d-")


def run(arguments: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C, or write a film of it.

    Raises:
        UserError: a folder has no record, the runs are of different towns, the port is taken, or no film can be made.
    """
    folders: list[Path] = arguments.runs
    if arguments.film is not None:
        check_film(arguments.film)
    if arguments.at is not None and arguments.film is not None:
        raise UserError("--at is a moment of the page; name the first moment of a film with --film-from")
    if len(folders) > MOST_RUNS:
        raise UserError(f"a page shows at most {MOST_RUNS} runs at once; name fewer than {len(folders)}")
    histories = [_read(folder) for folder in folders]
    towns = sorted({history.facts.route.town for history in histories})
    if len(towns) > 1:
        raise UserError(f"the runs are of different towns ({', '.join(towns)}); name runs of one town")
    end_s = float(max(history.frames["t_s"][-1] for history in histories))
    if arguments.at is not None and not 0.0 <= arguments.at <= end_s:
        raise UserError(f"--at is {arguments.at:g}; the run lasts from 0 to {end_s:.1f} s of simulated time")
    text = map_text(folders[0], arguments.map, towns[0])
    try:
        link = PageLink.start(port=arguments.port)
    except LindenError as error:
        raise UserError(str(error)) from error
    try:
        _send(link, folders, histories, text)
        if arguments.film is not None:
            until_s = end_s if arguments.film_to is None else min(end_s, arguments.film_to)
            write_film(link, arguments.film, arguments.film_from, until_s)
            print(f"film              {arguments.film}")  # noqa: T201 - what a command says to its user
            return 0
        moment = "" if arguments.at is None else f"?t={arguments.at:g}"
        print(f"window            {link.address}{moment}", flush=True)  # noqa: T201 - what a command says to its user
        print("window            Ctrl-C ends it", flush=True)  # noqa: T201 - what a command says to its user
        while link.is_open:
            select.select([link], [], [], 1.0)
            link.orders()
    except KeyboardInterrupt:
        pass
    finally:
        link.close()
    return 0


def _read(folder: Path) -> History:
    """Read the record of a run.

    Raises:
        UserError: there is none. If folders below hold records, as those of series and scenarios do, it names one.
    """
    below = (
        []
        if (folder / HISTORY_FILE).exists()
        else sorted({each.resolve() for each in folder.glob(f"*/**/{HISTORY_FILE}")})
    )
    if below:
        raise UserError(f"{folder} holds {len(below)} runs; name up to {MOST_RUNS} of them, such as {below[0].parent}")
    return read_history(folder)


def map_text(folder: Path, named: Path | None, town: str) -> str:
    """Return the OpenDRIVE text of a run: of the file named, of its folder, or of the map of that name.

    Raises:
        UserError: there is none, or it cannot be read.
    """
    kept = folder / MAP_FILE
    try:
        if named is not None or kept.is_file():
            return (named or kept).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(
            f"the map {named or kept} cannot be read: {error}; name an OpenDRIVE file with --map"
        ) from error
    from linden.errors import Refusal  # noqa: PLC0415 - only without a map in the run's folder
    from linden.maps.cache import MapCache  # noqa: PLC0415 - likewise
    from linden.maps.library import MapLibrary  # noqa: PLC0415 - likewise

    try:
        return MapLibrary((), MapCache.of_user().read).load(town).text
    except Refusal:
        raise UserError(f"{folder} holds no map of {town}; name its OpenDRIVE file with --map FILE.xodr") from None


def _send(link: PageLink, folders: list[Path], histories: list[History], text: str) -> None:
    first = histories[0]
    link.note({"type": "map", "name": first.facts.route.town, "text": text})
    actors, marks, notices = list[dict[str, Any]](), list[dict[str, Any]](), list[str]()
    scorings = [resolve(Scoring, [scoring_of_run(folder / CONFIG_FILE)]) for folder in folders]
    for number, (folder, history, scoring) in enumerate(zip(folders, histories, scorings, strict=True)):
        actors += actors_note(history.facts, f"run {number + 1}" if len(folders) > 1 else "", number)
        marks += [mark_of(each, number) for each in infractions(history, scoring)]
        notice = lacks(folder)
        notices += [notice] if notice else []
    link.note({"type": "actors", "actors": actors})
    link.note(route_note(first.facts.route, drives=False))
    facts = {"panels": panels_of(first, scorings[0], _name(folders[0])), "marks": marks, "notice": " ".join(notices)}
    link.blob("frames.bin", record_frames(histories))
    link.blob("facts.json", packed(facts))
    links = {"frames": "record/frames.bin", "facts": "record/facts.json", "runs": _runs(link, folders)}
    link.note({"type": "record", **links})


def _name(folder: Path) -> str:
    """Return the name of a run's folder without the time of its start."""
    return _STARTED.sub("", folder.resolve().name)


def _runs(link: PageLink, folders: list[Path]) -> list[dict[str, Any]]:
    """Send the reports of the runs that have one, and return name, colour and the report's path of each run."""
    found = []
    for number, folder in enumerate(folders):
        path = ""
        if (folder / REPORT_FILE).is_file():
            link.blob(f"report-{number + 1}.html", gzip.compress((folder / REPORT_FILE).read_bytes(), 6, mtime=0))
            path = f"record/report-{number + 1}.html"
        found.append({"name": _name(folder), "colour": RUN_COLOURS[number], "report": path})
    return found


def panels_of(history: History, scoring: Scoring, title: str) -> list[dict[str, Any]]:
    """Return the panel of each second of a run; the last one has the scores of the whole run."""
    so_far = SoFar(scoring)
    step_s, route = history.facts.step_s, history.facts.route
    ticks = range(0, len(history.frames), max(1, round(PANEL_EVERY_S / step_s)))
    panels = []
    for tick in ticks:
        so_far.advance(partial(history.window, end=tick + 1))
        moment = moment_of(history.frames, tick, step_s)
        panels.append(panel_note(title, route, moment, so_far.scores, so_far.infractions))
    last = moment_of(history.frames, len(history.frames) - 1, step_s)
    panels.append(panel_note(title, route, last, score(history, scoring), infractions(history, scoring)))
    return panels
