"""``matrix.html``: one file with the matrix as a table, shares, success maps, and a card for each case."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import write_bytes
from basu.output.report.html.page import page
from basu.output.report.scenarios.matrix_documents import read_case
from basu.output.report.scenarios.page import case_card
from basu.output.report.scenarios.page.case_card import anchor_of, card, parameters, verdict_mark
from basu.output.report.scenarios.page.route_section import card_style
from basu.output.report.scenarios.shares import shares_view
from basu.output.report.scenarios.sweep.boundary import boundary_of, sentences
from basu.output.report.scenarios.sweep.study import studies
from basu.output.report.scenarios.sweep.success_map import drawing
from basu.output.report.scenarios.tally import LOOKS, blocks, counted, tally
from basu.output.report.templates import DASH, e, extended, html

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.scenarios.matrix_documents import CaseRecord


MOST_SIGNS = 16  # cases of a scenario that have a sign each; more of them are counted


def matrix_table(matrix: dict[str, Any], carded: Collection[str]) -> Element:
    """The table; ``carded`` are the anchors of the cards in the page."""
    agents = matrix["agents"]
    head = e("thead", e("tr", e("th", "scenario", scope="col"), *(e("th", agent, scope="col") for agent in agents)))
    table = e("table", head, class_="matrix")
    for block in blocks(matrix):
        body = e("tbody", e("tr", e("th", block.group, scope="rowgroup", colspan=len(agents) + 1), class_="group"))
        for row in block.rows:
            name = e("th", row.scenario, e("small", row.title), scope="row")
            body.append(e("tr", name, *(_cell(row.cases, agent, carded) for agent in agents)))
        table.append(body)
    total = e("tr", e("th", "all", scope="row"), *(_total(matrix["cases"], agent) for agent in agents), class_="total")
    table.append(e("tbody", total))
    return e("div", table, class_="wide-matrix")


def key() -> Element:
    """What the signs mean."""
    shown = {look.style: look for look in LOOKS.values()}
    words = {
        "absent": "not exercised: the conflict never came about",
        "unjudged": "not judged: a fault of simulator, set-up or benchmark, or interrupted",
    }
    return e(
        "p",
        *(
            e("span", e("i", look.sign, class_=f"chip {style}"), words.get(style, look.word), class_="legend")
            for style, look in shown.items()
        ),
        e(
            "span",
            "figures: passed of judged; of those passed, least distance and least time to a collision",
            class_="legend",
        ),
        class_="legends",
    )


def _cell(cases: Sequence[dict[str, Any]], agent: str, carded: Collection[str]) -> Element:
    """What one agent made of a scenario."""
    cell = _total(cases, agent)
    if len(cases) <= MOST_SIGNS:
        signs = [_sign(case, agent, carded) for case in cases if agent in case["results"]]
        cell.insert(0, e("span", *signs, class_="chips"))
    return cell


def _total(cases: Sequence[dict[str, Any]], agent: str) -> Element:
    """How many were passed, and how narrowly."""
    found = tally(cases, agent)
    narrowly = [found.narrowest, "" if found.ttc_s is None else f"{found.ttc_s:.1f} s"]
    absent = f"{found.absent} not exercised" if found.absent else ""
    style = "unjudged" if not found.judged else "passed" if found.passed == found.judged else "failed"
    share = f"{found.passed}/{found.judged}" if found.judged else DASH
    return e(
        "td",
        e("b", share, class_=f"share {style}"),
        e("small", ", ".join(text for text in (*narrowly, absent) if text)),
        class_="cell",
    )


def _sign(case: dict[str, Any], agent: str, carded: Collection[str]) -> Element:
    """One case, a link to its card where there is one."""
    result = case["results"][agent]
    look, anchor = LOOKS[result["verdict"]], anchor_of(case["id"], agent)
    told = f"{case['id']}, {agent}: {look.word}. {result['message']}"
    if anchor not in carded:
        return e("i", look.sign, class_=f"chip {look.style}", title=told)
    return e("a", look.sign, href=f"#{anchor}", class_=f"chip {look.style}", title=told, aria_label=told)


PAGE_FILE = "matrix.html"
HERE = Path(__file__).parent
MOST_CARDS = 400  # in one page: those that were not passed first, then the narrowest
MOST_BYTES = 8_000_000  # of cards; from there on they have no pictures
PARAMETERS_SHOWN = 4  # beside a case's name
MOST_OF_TITLE = 90  # characters of what was asked for


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
    """The page; ``record`` finds what a case left, or says why there is nothing."""
    cells = chosen(matrix)
    carded = {anchor_of(cell.case["id"], cell.agent) for cell in cells}
    cards = _cards(cells, record)
    body = e("body", _head(matrix))
    extended(body, [shares_view(matrix), *_sweeps(matrix)])
    table = e("section", e("h2", "Matrix"), key(), matrix_table(matrix, carded))
    extended(body, [table, _cases(matrix, cards)])
    script = (HERE / "matrix.js").read_text(encoding="utf-8")
    return page(f"Scenarios: {matrix['what']}", body, script=script, style=card_style())


def chosen(matrix: dict[str, Any]) -> list[Cell]:
    """Whose cards are in the page: all, or those that tell most."""
    cells = [Cell(case, agent) for case in matrix["cases"] for agent in matrix["agents"] if agent in case["results"]]
    if len(cells) <= MOST_CARDS:
        return cells

    def weight(cell: Cell) -> tuple[bool, float]:
        result = cell.case["results"][cell.agent]
        distance_m = result["margins"].get("distance_m")
        return result["verdict"] == "SUCCESS", float("inf") if distance_m is None else distance_m

    kept = {id(cell) for cell in sorted(cells, key=weight)[:MOST_CARDS]}
    return [cell for cell in cells if id(cell) in kept]


def _cards(cells: list[Cell], record: Callable[[Cell], CaseRecord | str]) -> dict[str, list[Element]]:
    """Cards by the case's id; those that were not passed have their pictures before the rest."""
    made: dict[int, Element] = {}
    size = 0
    order = sorted(range(len(cells)), key=lambda n: cells[n].case["results"][cells[n].agent]["verdict"] == "SUCCESS")
    for number in order:
        cell = cells[number]
        found = record(cell)
        if isinstance(found, str):
            made[number] = _bare(cell, found)
        else:
            made[number] = card(found.result, found.history, found.streets, picture=size < MOST_BYTES)
        size += len(html(made[number]))
    cards: dict[str, list[Element]] = {}
    for number, cell in enumerate(cells):
        cards.setdefault(cell.case["id"], []).append(made[number])
    return cards


def _bare(cell: Cell, why: str) -> Element:
    """A card of a case of which no more is known than its line in the matrix."""
    result = cell.case["results"][cell.agent]
    return e(
        "article",
        e("h4", e("span", cell.agent, class_="agent"), " ", verdict_mark(result["verdict"])),
        e("p", result["message"], class_="message"),
        e("p", why, class_="note"),
        class_=f"case-card {LOOKS[result['verdict']].style}",
        id=anchor_of(cell.case["id"], cell.agent),
        data_agent=cell.agent,
        data_verdict=result["verdict"],
    )


def _head(matrix: dict[str, Any]) -> Element:
    """What was driven, when and with what."""
    drives = sum(len(case["results"]) for case in matrix["cases"])
    versions = ", ".join(f"{name} {text}" for name, text in matrix["versions"].items())
    minutes, seconds = divmod(round(matrix["wall_s"]), 60)
    what = f"{counted(len(matrix['cases']), 'case')} with {', '.join(matrix['agents'])}: {counted(drives, 'drive')}"
    told = f"{what} in {minutes} min {seconds} s, started {matrix['started']}; {versions}"
    what = textwrap.shorten(matrix["what"], MOST_OF_TITLE, placeholder=" …")
    return e("header", e("h1", f"Scenarios: {what}"), e("p", told))


def _sweeps(matrix: dict[str, Any]) -> Iterator[Element]:
    """A section for each scenario that was sampled, a map for each agent."""
    found = studies(matrix)
    for scenario in dict.fromkeys(study.scenario for study in found):
        section = e("section", e("h2", f"Where failing begins: {scenario}"))
        maps = e("div", class_="maps")
        for study in found:
            if study.scenario == scenario:
                known = boundary_of(study)
                told = e("ul", *(e("li", text[0].upper() + text[1:]) for text in sentences(known)))
                maps.append(e("figure", e("figcaption", e("b", study.agent), told), drawing(known), class_="sweep"))
        section.append(maps)
        yield section


def _cases(matrix: dict[str, Any], cards: dict[str, list[Element]]) -> Element:
    """All cases by group and scenario, each to be opened."""
    section = e("section", e("h2", "Cases"), _filters(matrix), case_card.key(), id="cases")
    for block in blocks(matrix):
        group = e("section", e("h3", block.group), class_="of-group", data_group=block.group)
        for row in block.rows:
            shown = [case for case in row.cases if case["id"] in cards]
            if shown:
                group.append(e("p", e("b", row.scenario), f" {row.title}", class_="scenario-title"))
            group.extend(_case(case, cards[case["id"]]) for case in shown)
            if len(shown) < len(row.cases):
                left = len(row.cases) - len(shown)
                group.append(
                    e("p", f"{left} more cases of it were passed with more room; matrix.json has them.", class_="note")
                )
        section.append(group)
    return section


def _case(case: dict[str, Any], cards: list[Element]) -> Element:
    """A case with the cards of all agents, closed."""
    signs = [
        e("span", f"{LOOKS[result['verdict']].sign} {agent}", class_=f"chip {LOOKS[result['verdict']].style}")
        for agent, result in case["results"].items()
    ]
    summary = e("summary", e("b", case["id"]), e("span", *signs, class_="chips"), e("small", case["place"]))
    return e("details", summary, parameters(case["parameters"]), e("div", *cards, class_="side"), class_="case")


def _filters(matrix: dict[str, Any]) -> Element:
    """What the script shows and hides by; without it there is nothing here."""
    verdicts = dict.fromkeys(result["verdict"] for case in matrix["cases"] for result in case["results"].values())
    groups = dict.fromkeys(case["group"] for case in matrix["cases"])
    return e(
        "form",
        _choice("group", "Group", {group: group for group in groups}),
        _choice("verdict", "Verdict", {verdict: LOOKS[verdict].word for verdict in verdicts}),
        _choice("agent", "Agent", {agent: agent for agent in matrix["agents"]}),
        e("button", "Open all shown", type="button", id="open"),
        e("output", id="shown"),
        class_="filters",
        hidden="hidden",
    )


def _choice(name: str, label: str, options: dict[str, str]) -> Element:
    """One of them."""
    shown = [e("option", "all", value=""), *(e("option", text, value=value) for value, text in options.items())]
    return e("label", f"{label} ", e("select", *shown, id=f"by-{name}"))
