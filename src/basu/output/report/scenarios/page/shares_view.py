"""The crash cost that passed cases stand for: a bar for each group, as long as its cost, filled as far as passed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.markup import e, percent
from basu.output.report.scenarios.shares import (
    SHARES,
    assumptions,
    control_notes,
    controls_last,
    interval,
    is_weighed,
    percent_of,
)

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MUSD_IN_BUSD = 1000.0


def shares_view(matrix: dict[str, Any]) -> Element | None:
    """The section; None where fewer than two groups were measured."""
    if not is_weighed(matrix):
        return None
    shares = {agent: matrix["shares"][agent] for agent in controls_last(matrix["agents"])}
    return e(
        "section",
        e("h2", "What the passed situations stand for"),
        e("div", *(_score(agent, share) for agent, share in shares.items()), class_="cards scores"),
        e("p", " ".join(control_notes(list(shares))), class_="note"),
        e("div", _table(shares), class_="wide-matrix"),
        e(
            "details",
            e("summary", "What this assumes"),
            e("ul", *(e("li", text) for text in assumptions(matrix))),
            open="open",
        ),
    )


def _score(agent: str, share: dict[str, Any]) -> Element:
    """One agent's shares."""
    cost = share["share_of_cost"]
    others = ", ".join(f"{interval(share[key])} of {name}" for key, name in list(SHARES.items())[1:])
    part = percent_of(share["measured_of_cost"])
    rest = "" if cost is None else f"{others}; the groups exercised make {part} of all cost. "
    return e(
        "div",
        e(
            "p",
            e("strong", percent_of(None if cost is None else cost["share"]), class_="score"),
            e("b", agent),
            f" {_words(cost)}",
        ),
        e(
            "p",
            f"{interval(share['shown_of_cost'])} shown of all crash cost. {rest}"
            f"{share['not_exercised']} cases not exercised; {share['collisions']} collisions, {share['at_fault']} at "
            "fault.",
            class_="note",
        ),
    )


def _words(cost: dict[str, float] | None) -> str:
    """What the figure beside an agent's name is, with its interval."""
    if cost is None:
        return "exercised no situation of the typology"
    return f"passed, of the crash cost of exercised situations ({100.0 * cost['low']:.0f}-{100.0 * cost['high']:.0f} %)"


def _table(shares: dict[str, dict[str, Any]]) -> Element:
    """A row for each group."""
    burdens: dict[str, dict[str, Any] | None] = {}
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for agent, share in shares.items():
        for group in share["groups"]:
            burdens[group["group"]] = group["burden"]
            found[group["group"], agent] = group
    greatest = max((burden["cost_musd"] for burden in burdens.values() if burden is not None), default=1)
    head = e(
        "tr",
        e("th", "group", scope="col"),
        e("th", "cost a year", scope="col"),
        *(e("th", a, scope="col") for a in shares),
    )
    rows = [
        e(
            "tr",
            e("th", group, scope="row"),
            e("td", "weighs nothing" if burden is None else f"{burden['cost_musd'] / MUSD_IN_BUSD:.1f} bn $"),
            *(
                _bar(found.get((group, agent)), None if burden is None else burden["cost_musd"] / greatest)
                for agent in shares
            ),
        )
        for group, burden in burdens.items()
    ]
    return e("table", e("thead", head), e("tbody", *rows), class_="matrix shares")


def _bar(group: dict[str, Any] | None, weight: float | None) -> Element:
    """One group with one agent: the outline is the weight, the filled part what was passed."""
    if group is None:
        return e("td", e("small", "not played"))
    passed, absent = group["passed"], group["not_exercised"]
    if passed is None:
        return e("td", e("small", f"{absent} not exercised"))
    filled = e("i", style=f"width:{percent(passed['share'])}")
    bar = (
        None
        if weight is None
        else e("i", filled, class_="weight", style=f"width:{percent(weight)}", aria_hidden="true")
    )
    counts = [f"{group[key]} {key[: None if group[key] != 1 else -1]}" for key in ("cases", "scenarios")]
    text = f"{interval(passed)} of {' of '.join(counts)}" + (f", {absent} not exercised" if absent else "")
    return e("td", e("span", bar, class_="weights"), e("small", text))
