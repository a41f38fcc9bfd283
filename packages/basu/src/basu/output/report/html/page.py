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
from markupsafe import Markup

from basu.files import write_bytes
from basu.metrics.registry import built_in
from basu.output.report.documents import REPORT_FILE
from basu.output.report.events import events
from basu.output.report.html.evidence import evidence
from basu.output.report.html.score_card import rows, score_card, table
from basu.output.report.in_words import answers
from basu.output.report.plots.signals import charts, signals
from basu.output.report.plots.timeline import timeline
from basu.output.report.plots.town_map import town_map
from basu.output.report.scenarios.drawing.picture import film_script
from basu.output.report.scenarios.page.route_section import card_style, on_the_way
from basu.output.report.shuttles import links
from basu.output.report.streets import bounds_of
from basu.output.report.templates import e, extended, render

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.documents import RunRecord
    from basu.output.report.plots.signals import Signals
    from basu.records.history import History

HERE = Path(__file__).parent
SAMPLES = 1500  # moments that the script can show: about one for each pixel of a chart


def write_report(folder: Path, run: RunRecord) -> None:
    """Write ``report.html`` into the folder of a run.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_bytes(folder / REPORT_FILE, report(run))


def report(run: RunRecord) -> bytes:
    """Return the report of a run as a page."""
    result, document, history = run.result, run.result.document(), run.history
    meta = result.meta
    values: dict[str, Any] = {
        "agent": run.agent,
        "where": f"route {meta['route']} of {meta['town']}, {meta['vehicle']}, {meta['weather']}, seed {meta['seed']}",
        "meta": meta,
        "status": document["status"],
        "fault": document["fault"],
        "message": document["message"],
        "answers": answers(result),
        "shuttles": links(run.config.get("shuttle")),
        "score_card": score_card(result),
        "history": history is not None,
        "samples": "",
        "script": "",
        "kind": run.config.get("kind", "run"),
        "command": shlex.join(str(word) for word in run.config.get("command", [])),
        "config": table(rows({key: each for key, each in run.config.items() if key != "command"})),
    }
    title = f"{run.agent}: {document['status']}"
    if history is None:
        return page(title, render("templates/report.j2", **values))
    felt, found = signals(history), events(result)
    script = (HERE / "report.js").read_text(encoding="utf-8")
    values |= {
        "legend": legend(more=_map_legend(has_streets=bool(run.streets.lines))),
        "town_map": town_map(history, run.streets, found),
        "last_s": float(history.frames["t_s"][-1]),
        "samples_number": SAMPLES,
        "timeline": timeline(history, felt, result, found),
        "scenarios": on_the_way(result, run.config.get("command", []), history, run.streets.lines),
        "charts": charts(history, felt, found),
        "evidence": evidence(history, felt, found, run.streets),
        "sections": [
            (metric.name, f"{metric.title[0].upper()}{metric.title[1:]}", table(rows(result.metrics[metric.name])))
            for metric in built_in()
            if metric.has_figures and result.metrics.get(metric.name)
        ],
        "samples": _samples(history, felt),
        "script": script,
    }
    style = ""
    if result.scenarios or result.case is not None:
        style = card_style()
        values["script"] = script = script + film_script()
    return page(title, render("templates/report.j2", **values), script, style)


def page(title: str, body: Markup, script: str = "", style: str = "") -> bytes:
    """Return a page without network requests: its policy makes the browser enforce this, and run no script but ours.

    ``style`` comes after that of every report. The body holds the ``script`` already; the policy allows it.
    """
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    allowed = f"style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    text = render(
        "templates/page.j2",
        title=title,
        policy=Markup(f"default-src 'none'; {allowed}; base-uri 'none'; form-action 'none'"),  # noqa: S704
        style=f"{(HERE / 'report.css').read_text(encoding='utf-8')}{style}",
        body=body,
    )
    return f"{text}\n".encode()


def legend(more: Sequence[Element] = ()) -> Element:
    """Return what the lines of a map are; ``more`` stands behind."""
    found = e("p", class_="legends")
    for style, name in (("planned", "planned path"), ("driven", "driven path")):
        sample = e("svg", e("path", d="M0 5H26", class_=style), viewBox="0 0 26 10", class_="sample")
        found.append(e("span", sample, name, class_="legend"))
    return extended(found, more)


def _map_legend(*, has_streets: bool) -> list[Element]:
    """Return what the marks on the map of a report are."""
    found = [
        e("span", e("i", class_="sign"), "stop sign", class_="legend"),
        e("span", e("i", class_="last"), "end of the drive", class_="legend"),
        e("span", "numbers: infractions, letters: not scored; each opens its evidence", class_="legend"),
    ]
    return found if has_streets else [*found, e("span", "this run's folder has no streets", class_="legend")]


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
