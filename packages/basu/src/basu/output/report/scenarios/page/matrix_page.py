"""``matrix.html``: one file with the matrix as a table, shares, success maps, and a card for each case."""

from __future__ import annotations

import textwrap
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import write_bytes
from basu.output.report.html.page import page
from basu.output.report.scenarios.drawing.picture import film_script
from basu.output.report.scenarios.matrix_documents import read_case
from basu.output.report.scenarios.page.case_card import KINDS, SIGNS, anchor_of, bare_card, card
from basu.output.report.scenarios.page.route_section import card_style
from basu.output.report.scenarios.shares import shares_view
from basu.output.report.scenarios.sweep.boundary import boundary_of, sentences
from basu.output.report.scenarios.sweep.study import studies
from basu.output.report.scenarios.sweep.success_map import drawing
from basu.output.report.scenarios.tally import LOOKS, blocks, counted, judged_share, name_of, tally, tracks
from basu.output.report.templates import DASH, render
from basu.output.report.tracks import apart, grouped, titled

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

    from markupsafe import Markup

    from basu.output.report.scenarios.matrix_documents import CaseRecord
    from basu.output.report.scenarios.tally import ScenarioGroup

PAGE_FILE = "matrix.html"
HERE = Path(__file__).parent
MOST_SIGNS = 16  # cases of a scenario that have a sign each; more of them are counted
MOST_CARDS = 400  # in one page: cases that were not passed first, then the narrowest
MOST_BYTES = 8_000_000  # of cards; from there on they have no pictures
MOST_OF_TITLE = 90  # characters of the requested cases
OF_STYLE = {  # what a sign means, where that is more than its word
    "absent": "not exercised: the conflict never came about",
    "unjudged": "not judged: a fault of simulator, set-up or benchmark, or interrupted",
}


class Cell(NamedTuple):
    """A case with an agent."""

    case: dict[str, Any]
    agent: str


def write_matrix_page(folder: Path, matrix: dict[str, Any]) -> None:
    """Write ``matrix.html`` into the folder of a run, with what lies in the folders of its cases.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """

    def record(cell: Cell) -> CaseRecord | str:
        at = cell.case["results"][cell.agent]["folder"]
        try:
            return read_case(folder / at) if at else "It left no folder."
        except UserError as error:
            return str(error)

    write_bytes(folder / PAGE_FILE, matrix_page(matrix, record))


def matrix_page(matrix: dict[str, Any], record: Callable[[Cell], CaseRecord | str]) -> bytes:
    """Return the page; ``record`` finds what a case left, or says why there is nothing."""
    cells = chosen(matrix)
    carded = {anchor_of(name_of(cell.case), cell.agent) for cell in cells}
    cards = _cards(cells, record)
    known = tracks(matrix)
    groups = grouped(matrix["agents"], known)
    script = (HERE / "matrix.js").read_text(encoding="utf-8") + film_script()
    body = render(
        "templates/matrix.j2",
        what=textwrap.shorten(matrix["what"], MOST_OF_TITLE, placeholder=" …"),
        summary=f"{_sentence(judged_share(matrix))} {_summary(matrix)}",
        shares=shares_view(matrix),
        sweeps=list(_sweeps(matrix)),
        verdict_key=[(style, look.sign, OF_STYLE.get(style, look.word)) for style, look in _looks().items()],
        apart=apart(matrix["agents"], known),
        tables=[_table(matrix, agents, carded, _heading(track, groups)) for track, agents in groups.items()],
        blocks=[_cases(block, cards) for block in blocks(matrix)],
        filters=_filters(matrix),
        kinds=KINDS,
        signs=SIGNS,
        script=script,
    )
    return page(f"Scenarios: {matrix['what']}", body, script=script, style=card_style())


def _looks() -> dict[str, Any]:
    """One look of each style."""
    return {look.style: look for look in LOOKS.values()}


def chosen(matrix: dict[str, Any]) -> list[Cell]:
    """Return the cases with cards in the page: all, or the most telling ones."""
    cells = [Cell(case, agent) for case in matrix["cases"] for agent in matrix["agents"] if agent in case["results"]]
    if len(cells) <= MOST_CARDS:
        return cells

    def weight(cell: Cell) -> tuple[bool, float]:
        result = cell.case["results"][cell.agent]
        distance_m = result["margins"].get("distance_m")
        return result["verdict"] == "SUCCESS", float("inf") if distance_m is None else distance_m

    kept = {id(cell) for cell in sorted(cells, key=weight)[:MOST_CARDS]}
    return [cell for cell in cells if id(cell) in kept]


def _cards(cells: list[Cell], record: Callable[[Cell], CaseRecord | str]) -> dict[str, list[Markup]]:
    """Cards by the case's id; cases that were not passed have their pictures before the rest."""
    made: dict[int, Markup] = {}
    size = 0
    order = sorted(range(len(cells)), key=lambda n: cells[n].case["results"][cells[n].agent]["verdict"] == "SUCCESS")
    for number in order:
        cell = cells[number]
        found = record(cell)
        if isinstance(found, str):
            made[number] = bare_card(name_of(cell.case), cell.agent, cell.case["results"][cell.agent], found)
        else:
            made[number] = card(
                found.case,
                found.history,
                found.streets.lines,
                name=name_of(cell.case),
                result=found.result,
                picture=size < MOST_BYTES,
            )
        size += len(made[number])
    cards: dict[str, list[Markup]] = {}
    for number, cell in enumerate(cells):
        cards.setdefault(name_of(cell.case), []).append(made[number])
    return cards


def _sentence(text: str) -> str:
    """Return a text with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}."


def _summary(matrix: dict[str, Any]) -> str:
    """Return what was driven, when and with what."""
    drives = sum(len(case["results"]) for case in matrix["cases"])
    versions = ", ".join(f"{name} {text}" for name, text in matrix["versions"].items())
    minutes, seconds = divmod(round(matrix["wall_s"]), 60)
    what = f"{counted(len(matrix['cases']), 'case')} with {', '.join(matrix['agents'])}: {counted(drives, 'drive')}"
    return f"{what} in {minutes} min {seconds} s, started {matrix['started']}; {versions}"


def _sweeps(matrix: dict[str, Any]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield each sampled scenario with a map for each agent."""
    found = studies(matrix)
    for scenario in dict.fromkeys(study.scenario for study in found):
        known = {study.agent: boundary_of(study) for study in found if study.scenario == scenario}
        yield (
            scenario,
            [
                {
                    "agent": agent,
                    "sentences": [text[0].upper() + text[1:] for text in sentences(boundary)],
                    "picture": drawing(boundary),
                }
                for agent, boundary in known.items()
            ],
        )


def _heading(track: str, groups: Mapping[str, Sequence[str]]) -> str:
    """Return the heading of a track's table; empty where the only track is not known."""
    return titled(track) if track or len(groups) > 1 else ""


def _table(matrix: dict[str, Any], agents: Sequence[str], carded: Collection[str], title: str) -> dict[str, Any]:
    """Return the table of the agents of one track."""
    return {
        "title": title,
        "agents": agents,
        "blocks": [
            {
                "group": block.group,
                "rows": [
                    {
                        "scenario": row.scenario,
                        "title": row.title,
                        "cells": [_cell(row.cases, agent, carded) for agent in agents],
                    }
                    for row in block.rows
                ],
            }
            for block in blocks(matrix)
        ],
        "totals": [_total(matrix["cases"], agent) for agent in agents],
    }


def _cases(block: ScenarioGroup, cards: dict[str, list[Markup]]) -> dict[str, Any]:
    """Return a group with its scenarios: the cases that have cards."""
    rows = []
    for row in block.rows:
        shown = [case for case in row.cases if name_of(case) in cards]
        headers = _headers(row.cases)
        rows.append(
            {
                "scenario": row.scenario,
                "title": row.title,
                "cases": [_case(case, headers[name_of(case)], cards[name_of(case)]) for case in shown],
                "left": len(row.cases) - len(shown),
            }
        )
    return {"group": block.group, "rows": rows}


def _cell(cases: Sequence[dict[str, Any]], agent: str, carded: Collection[str]) -> dict[str, Any]:
    """One agent's results in a scenario."""
    is_signed = len(cases) <= MOST_SIGNS
    signs = [_sign(case, agent, carded) for case in cases if agent in case["results"]] if is_signed else None
    return {**_total(cases, agent), "signs": signs}


def _total(cases: Sequence[dict[str, Any]], agent: str) -> dict[str, Any]:
    """Return how many were passed, and how narrowly."""
    found = tally(cases, agent)
    narrowly = [found.narrowest, "" if found.ttc_s is None else f"{found.ttc_s:.1f} s"]
    absent = f"{found.absent} not exercised" if found.absent else ""
    return {
        "signs": None,
        "style": "unjudged" if not found.judged else "passed" if found.passed == found.judged else "failed",
        "share": f"{found.passed}/{found.judged}" if found.judged else DASH,
        "narrowly": ", ".join(text for text in (*narrowly, absent) if text),
    }


def _sign(case: dict[str, Any], agent: str, carded: Collection[str]) -> dict[str, Any]:
    """One case, with the anchor of its card where there is one."""
    result = case["results"][agent]
    look, anchor = LOOKS[result["verdict"]], anchor_of(name_of(case), agent)
    sentence = f"{name_of(case)}, {agent}: {look.word}. {result['message']}"
    return {"look": look, "sentence": sentence, "anchor": anchor if anchor in carded else ""}


def _headers(cases: Sequence[dict[str, Any]]) -> dict[str, str]:
    """Return the header of each case, by its id: its place, and for samples of one place their own values."""
    by_place: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for case in cases:
        by_place[case["place"]].append(case)
    headers = {}
    for place, there in by_place.items():
        values = [{each["name"]: _value(each) for each in case["parameters"]} for case in there]
        for case, own in zip(there, values, strict=True):
            varied = {name for name, text in own.items() if any(other.get(name) != text for other in values)}
            headers[name_of(case)] = ", ".join(f"{name} {own[name]}" for name in own if name in varied) or place
    return headers


def _value(parameter: dict[str, Any]) -> str:
    """Return a parameter's value with its unit."""
    value = parameter["value"]
    return f"{value if isinstance(value, str) else f'{value:.4g}'} {parameter['unit']}".rstrip()


def _case(case: dict[str, Any], header: str, cards: list[Markup]) -> dict[str, Any]:
    """Return a case with the cards of all agents."""
    verdicts = [(LOOKS[result["verdict"]], agent) for agent, result in case["results"].items()]
    return {
        "id": name_of(case),
        "parameters": case["parameters"],
        "header": header,
        "verdicts": verdicts,
        "cards": cards,
    }


def _filters(matrix: dict[str, Any]) -> dict[str, dict[str, str]]:
    """Return the values that the script filters by."""
    verdicts = dict.fromkeys(result["verdict"] for case in matrix["cases"] for result in case["results"].values())
    groups = dict.fromkeys(case["group"] for case in matrix["cases"])
    return {
        "groups": {group: group for group in groups},
        "verdicts": {verdict: LOOKS[verdict].word for verdict in verdicts},
        "agents": {agent: agent for agent in matrix["agents"]},
    }
