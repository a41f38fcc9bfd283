"""The matrix as a table: groups, scenarios, agents; each case a sign that opens its card."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.markup import DASH, e
from basu.output.report.scenarios.page.card import anchor_of
from basu.output.report.scenarios.tally import blocks, tally
from basu.output.report.scenarios.verdicts import LOOKS

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from xml.etree.ElementTree import Element

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
