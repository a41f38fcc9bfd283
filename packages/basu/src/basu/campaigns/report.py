"""``campaign.html``: success with intervals, where each agent begins to fail, the worst cases, comfort and cost."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from basu.campaigns.campaign_folder import STOP_FILE, read_campaign_document
from basu.campaigns.conclusions import breakdown, costs, distinct, frequencies, means, pairs, rates, services
from basu.campaigns.drive_table import read_drives
from basu.campaigns.plan import CASE
from basu.campaigns.records import FAILURE, FAULT, SAMPLE, folder_of, kept_in
from basu.campaigns.search_part import SEARCH, search_plugin
from basu.errors import UserError
from basu.files import read_json, write_bytes
from basu.output.report.documents import read_run
from basu.output.report.html.page import page
from basu.output.report.plots.town_map import plain_map
from basu.output.report.scenarios.drawing.picture import case_drawing
from basu.output.report.scenarios.matrix_documents import read_case
from basu.output.report.scenarios.page.route_section import card_style
from basu.output.report.scenarios.sweep.boundary import boundary_of, sentences
from basu.output.report.scenarios.sweep.study import LEAST_CASES, Study, axis_of
from basu.output.report.scenarios.sweep.success_map import drawing
from basu.output.report.scenarios.tally import counted
from basu.output.report.streets import bounds_of
from basu.output.report.templates import render
from basu.output.report.tracks import apart as kept_apart
from basu.output.report.tracks import grouped, titled

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from xml.etree.ElementTree import Element

    from markupsafe import Markup

    from basu.campaigns.records import Kept

PAGE_FILE = "campaign.html"
STYLE_FILE = Path(__file__).with_name("campaign.css")
MOST_ROWS = 60  # of the breakdown
MOST_STUDIES = 12  # maps of success; the most mixed first
MOST_MARKS = 1_000  # drives in one map
MOST_WORST = 4  # drives of an agent with pictures
PARAMETER = "parameter_"
WORDS = {FAILURE: "failed", FAULT: "a fault that is not the agent's", SAMPLE: "of the sample"}


def write_campaign_report(folder: Path) -> Path:
    """Write the page into the folder of a campaign; its path.

    Raises:
        UserError: it is no folder of a campaign, nothing was driven yet, or the disk is full.
    """
    document, table = read_campaign_document(folder), read_drives(folder)
    path = folder / PAGE_FILE
    write_bytes(path, campaign_page(folder, document, table))
    return path


def campaign_page(folder: Path, document: dict[str, Any], table: pa.Table) -> bytes:
    """The page of a campaign with this document and these rows."""
    agents, confidence = document["agents"], document["settings"]["confidence"]
    apart = distinct(table)
    search, tracks = _search(folder, table, confidence), document.get("tracks", {})
    groups = grouped(agents, tracks)
    alike = [pair for pair in pairs(table, agents) if tracks.get(pair.first) == tracks.get(pair.second)]
    body = render(
        "templates/campaign.j2",
        name=document["name"],
        summary=_summary(document, table),
        remarks=list(_remarks(folder, document, table)),
        confidence=confidence,
        agents=agents,
        search=search,
        groups=[_group(apart, track, names, confidence) for track, names in groups.items()],
        pairs=alike if search is None else [],
        studies=_shown(studies_of(table, agents)) if search is None else [],
        worst=_worst(folder, agents),
        costs=costs(table, agents),
        made_with=_made_with(document),
    )
    style = f"{card_style()}\n{STYLE_FILE.read_text(encoding='utf-8')}"
    return page(f"Campaign {document['name']}", body, style=style)


def _group(table: pa.Table, track: str, agents: list[str], confidence: float) -> dict[str, Any]:
    """The tables of the agents of one track."""
    own = table.filter(pc.is_in(table["agent"], value_set=pa.array(agents)))
    parts = breakdown(own, agents, confidence)
    return {
        "title": f": {titled(track)}" if track else "",
        "agents": agents,
        "rates": rates(own, agents, confidence),
        "breakdown": parts[:MOST_ROWS],
        "left_out": max(0, len(parts) - MOST_ROWS),
        "means": means(own, agents, confidence),
        "services": services(own, agents, confidence),
        "frequencies": frequencies(own, agents),
    }


def _search(folder: Path, table: pa.Table, confidence: float) -> Markup | None:
    """The sections of searches and estimates; None where the campaign has none."""
    if not (folder / SEARCH).is_dir():
        return None
    return search_plugin().section(folder, table, confidence)


def _summary(document: dict[str, Any], table: pa.Table) -> str:
    """What was driven, in a line."""
    seeds = pc.min_max(table["seed"]).as_py()
    subjects = len(pc.unique(table["subject"]))
    hours = float(pc.sum(table["simulated_s"]).as_py() or 0.0) / 3600.0
    over = f"seeds {seeds['min']} to {seeds['max']}" if seeds["min"] != seeds["max"] else f"seed {seeds['min']}"
    return (
        f"{table.num_rows} of {counted(document['planned'], 'drive')}: {counted(len(document['agents']), 'agent')}, "
        f"{subjects} {'route or case' if subjects == 1 else 'routes or cases'}, "
        f"{counted(len(pc.unique(table['weather'])), 'weather')}, {over}; {hours:.2f} simulated hours"
    )


def _remarks(folder: Path, document: dict[str, Any], table: pa.Table) -> Iterator[str]:
    """What a reader must know before the figures."""
    different = kept_apart(document["agents"], document.get("tracks", {}))
    if different:
        yield different
    until = document["settings"]["until"]
    if (folder / STOP_FILE).exists() and until is not None:
        yield (
            f"The campaign stopped where every agent's interval was narrower than {until['width']:g}. Looks at "
            "intermediate results make such an interval cover slightly less than it says."
        )
    elif table.num_rows < document["planned"]:
        yield "The campaign is not finished: the figures are of the drives so far."
    repeated = table.num_rows - distinct(table).num_rows
    if repeated:
        yield (
            f"{counted(table.num_rows, 'drive')}, {table.num_rows - repeated} of them distinct: the others equal one "
            "of these in all but the seed. Equal drives count once in all rates, intervals and tests."
        )
    faults = table.filter(pc.is_in(table["fault"], value_set=pa.array(["simulator", "benchmark", "setup"])))
    if faults.num_rows:
        first = faults["message"][0].as_py()
        were = "drive was" if faults.num_rows == 1 else "drives were"
        yield f"{faults.num_rows} {were} ended by a fault that is not the agent's; the first: {first}"


def _made_with(document: dict[str, Any]) -> str:
    """Return the campaign's file and the versions that drove it."""
    identity = document["identity"]
    versions = [
        f"{name.removeprefix('the version of ')} {text}" for name, text in identity.items() if "version" in name
    ]
    return f"{document['file']}, with {', '.join(versions)}; the settings stand in campaign.json."


def studies_of(table: pa.Table, agents: Sequence[str]) -> list[Study]:
    """Each case that was sampled, with each agent, as columns of its parameters."""
    cases = table.filter(pc.and_(pc.equal(table["kind"], CASE), table["judged"]))
    found = []
    for subject in sorted(pc.unique(cases["subject"]).to_pylist()):
        of_subject = cases.filter(pc.equal(cases["subject"], subject))
        for agent in agents:
            study = _study(subject, agent, of_subject.filter(pc.equal(of_subject["agent"], agent)).slice(0, MOST_MARKS))
            if study is not None:
                found.append(study)
    return found


def _study(subject: str, agent: str, rows: pa.Table) -> Study | None:
    """One of them; None where too little was driven or nothing varied."""
    if rows.num_rows < LEAST_CASES:
        return None
    axes = []
    for name in rows.column_names:
        if name.startswith(PARAMETER) or name == "weather":
            values = rows[name].to_pylist()
            if None not in values and len(set(values)) > 1:
                axes.append(axis_of(name.removeprefix(PARAMETER), "", "", values))
    if not axes:
        return None
    failed = ~np.array(rows["success"].to_pylist(), dtype=np.bool_)
    distances = [np.nan if value is None else value for value in rows["margin_distance_m"].to_pylist()]
    return Study(
        scenario=subject,
        agent=agent,
        ids=rows["identity"].to_pylist(),
        axes=axes,
        failed=failed,
        broken=failed & np.array([fault == "agent" for fault in rows["fault"].to_pylist()]),
        distance_m=np.array(distances, dtype=np.float64),
        unjudged=0,
        absent=0,
    )


def _shown(studies: list[Study]) -> list[dict[str, Any]]:
    """The most mixed studies with their maps; those without a failure as a sentence."""
    order = sorted(studies, key=lambda study: abs(float(study.failed.mean()) - 0.5))[:MOST_STUDIES]
    shown = []
    for study in order:
        found = boundary_of(study)
        shown.append(
            {
                "subject": study.scenario,
                "agent": study.agent,
                "sentences": [text[0].upper() + text[1:] for text in sentences(found)],
                "picture": drawing(found) if study.is_mixed else None,
            }
        )
    return shown


def _worst(folder: Path, agents: Sequence[str]) -> list[tuple[str, list[dict[str, Any]]]]:
    """The worst drives of every agent with pictures: failures, then the narrowest successes."""
    kept = [each for each in kept_in(folder) if each.reason != SAMPLE]
    ranked = sorted(kept, key=lambda each: (each.reason != FAILURE, each.reason == FAULT, -each.severity, each.number))
    return [
        (agent, [_card(folder, each) for each in [one for one in ranked if one.agent == agent][:MOST_WORST]])
        for agent in agents
    ]


def _card(folder: Path, kept: Kept) -> dict[str, Any]:
    """One drive: its picture, and the address of its folder."""
    at = folder_of(folder, kept)
    row = read_json(at / "drive.json", "the drive's document")["row"]
    parameters = ", ".join(
        f"{name.removeprefix(PARAMETER)} {value if isinstance(value, str) else f'{value:g}'}"
        for name, value in row.items()
        if name.startswith(PARAMETER) and value is not None
    )
    return {
        "subject": row["subject"],
        "reason": WORDS.get(kept.reason, "narrowest success"),
        "message": row["message"],
        "about": f"weather {row['weather']}, seed {row['seed']}{f', {parameters}' if parameters else ''}",
        **_picture(at, row["kind"]),
        "address": quote(at.relative_to(folder).as_posix()),
    }


def _picture(at: Path, kind: str) -> dict[str, Element | str | None]:
    """The drive from above, or the reason why there is none: its record, older than this program, say."""
    try:
        drawn = _case_picture(at) if kind == CASE else _route_picture(at)
    except UserError as error:  # the row in the table stands all the same
        return {"picture": None, "without": f"no picture: {error}"}
    return {"picture": drawn, "without": None if drawn is not None else "no picture: nothing was driven"}


def _case_picture(at: Path) -> Element | None:
    """A case from above; None where nothing was driven."""
    case = read_case(at)
    return None if case.history is None else case_drawing(case.case, case.history, case.streets.lines)


def _route_picture(at: Path) -> Element | None:
    """A drive on a route from above; None where nothing was driven."""
    run = read_run(at)
    return None if run.history is None else plain_map(run.history, run.streets.lines, bounds_of(run.history), [])
