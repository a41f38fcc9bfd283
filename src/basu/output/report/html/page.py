"""``report.html`` as a whole: its parts in order, style and script in it, and a policy that forbids any network."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from basu.output.report.findings import findings
from basu.output.report.html import figures
from basu.output.report.html.evidence import evidence
from basu.output.report.html.plots import charts
from basu.output.report.html.score_card import reported, score_card
from basu.output.report.markup import e, extended, html
from basu.output.report.plots.signals import signals
from basu.output.report.plots.timeline import timeline
from basu.output.report.plots.town_map import town_map
from basu.output.report.scenarios.page.on_route import on_the_way
from basu.output.report.scenarios.page.style import card_style
from basu.output.report.streets import bounds_of
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.findings import Finding
    from basu.output.report.plots.signals import Signals
    from basu.output.report.reading import RunRecord
    from basu.records.history import History

REPORT_FILE = "report.html"
HERE = Path(__file__).parent
SAMPLES = 1500  # moments that the script can show: about one for each pixel of a chart


def write_report(folder: Path, run: RunRecord) -> None:
    """Write ``report.html`` into the folder of a run.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_bytes(folder / REPORT_FILE, report(run))


def report(run: RunRecord) -> bytes:
    """The report of a run as a page."""
    document = run.result
    body = e("body", _head_of(run))
    history = run.history
    if history is None:
        extended(body, [score_card(document), _again(run)])
        return page(f"{run.agent}: {document['status']}", body)
    felt, found = signals(history), findings(document)
    extended(
        body,
        [
            score_card(document),
            _map(run, history, found),
            e("section", e("h2", "Timeline"), timeline(history, felt, document, found)),
            on_the_way(document, run.config.get("command", []), history, run.streets),
            charts(history, felt, found),
            *evidence(history, felt, found),
            reported(document),
            _again(run),
            e("script", _samples(history, felt), type="application/json", id="samples"),
        ],
    )
    script = (HERE / "report.js").read_text(encoding="utf-8")
    return page(f"{run.agent}: {document['status']}", body, script, card_style() if document.get("scenarios") else "")


def page(title: str, body: Element, script: str = "", style: str = "") -> bytes:
    """A page that asks nobody for anything: the browser itself holds it to that, and runs no script but ours.

    ``style`` comes after that of every report.
    """
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    allowed = f"style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    policy = f"default-src 'none'; {allowed}; base-uri 'none'; form-action 'none'"
    head = e(
        "head",
        e("meta", charset="utf-8"),
        e("meta", http_equiv="Content-Security-Policy", content=policy),
        e("meta", name="viewport", content="width=device-width, initial-scale=1"),
        e("title", title),
        e("style", f"{(HERE / 'report.css').read_text(encoding='utf-8')}{style}"),
    )
    if script:
        body.append(e("script", script))
    return f"<!DOCTYPE html>\n{html(e('html', head, body, lang='en'))}\n".encode()


def _head_of(run: RunRecord) -> Element:
    """Who drove what, and how it ended."""
    meta, document = run.result["meta"], run.result
    where = f"route {meta['route']} of {meta['town']}, {meta['vehicle']}, {meta['weather']}, seed {meta['seed']}"
    ended = e("p", e("b", document["status"], class_=f"status {document['fault']}"), f" {document['message']}")
    return e("header", e("h1", run.agent), e("p", f"{where}; started {meta['started']}"), ended)


def _map(run: RunRecord, history: History, found: Sequence[Finding]) -> Element:
    """The map, its legend, and the one control of the page: the moment that all plots show."""
    legend = e("p", class_="legends")
    for style, words in (("planned", "planned path"), ("driven", "driven path")):
        sample = e("svg", e("path", d="M0 5H26", class_=style), viewBox="0 0 26 10", class_="sample")
        legend.append(e("span", sample, words, class_="legend"))
    extended(
        legend,
        [
            e("span", e("i", class_="sign"), "stop sign", class_="legend"),
            e("span", e("i", class_="last"), "end of the drive", class_="legend"),
            e("span", "numbers: infractions, letters: not scored; each opens its evidence", class_="legend"),
            None if run.streets else e("span", "this run's folder has no streets", class_="legend"),
        ],
    )
    last_s = float(history.frames["t_s"][-1])
    slider = e("input", type="range", min=0, max=SAMPLES - 1, value=0, id="moment", aria_label="moment of the drive")
    control = e(
        "p",
        e("label", "Moment ", slider),
        e("output", f"of {last_s:.1f} s", id="now"),
        class_="moment",
        hidden="hidden",
    )
    return e("section", e("h2", "Map"), legend, town_map(history, run.streets, found), control)


def _again(run: RunRecord) -> Element:
    """What is needed to drive it once more."""
    section = e("section", e("h2", "Configuration"))
    if "command" in run.config:
        section.append(e("p", "To repeat this run: ", e("code", "basu run --config config.json"), " in its folder, or"))
        section.append(e("pre", shlex.join(str(word) for word in run.config["command"])))
    rest = {key: value for key, value in run.config.items() if key != "command"}
    section.append(e("div", figures.table(figures.rows(rest)), class_="columns"))
    return section


def _samples(history: History, felt: Signals) -> str:
    """Numbers for the script, as JSON that cannot end its element."""
    frames = history.frames
    chosen = np.unique(np.linspace(0, len(frames) - 1, min(SAMPLES, len(frames))).round().astype(np.int64))
    bounds = bounds_of(history)
    columns: dict[str, Any] = {
        "t": (felt.t_s, 2),
        "left": ((frames["x_m"] - bounds.west_m) / bounds.width_m * 100.0, 3),
        "top": ((frames["y_m"] - bounds.north_m) / bounds.height_m * 100.0, 3),
        "speed": (felt.speed_mps, 2),
        "limit": (felt.limit_mps, 2),
        "along": (felt.along_mps2, 2),
        "across": (felt.across_mps2, 2),
        "jerk": (felt.jerk_mps3, 2),
        "offset": (felt.offset_m if np.isfinite(felt.offset_m).any() else frames["lateral_m"], 2),
    }
    written = {
        name: [round(value, digits) if math.isfinite(value) else None for value in values[chosen].tolist()]
        for name, (values, digits) in columns.items()
    }
    return json.dumps(written, separators=(",", ":"), allow_nan=False)
