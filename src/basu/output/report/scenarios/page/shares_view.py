"""What the passed situations stand for: a bar for each group, as long as the group's cost, filled as far as passed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.markup import e, percent
from basu.output.report.scenarios.shares import SHARES, assumptions, is_weighed, percent_of

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MUSD_IN_BUSD = 1000.0


def shares_view(matrix: dict[str, Any]) -> Element | None:
    """The section; None where fewer than two groups were measured."""
    if not is_weighed(matrix):
        return None
    shares = {agent: matrix["shares"][agent] for agent in matrix["agents"]}
    return e(
        "section",
        e("h2", "What the passed situations stand for"),
        e("div", *(_score(agent, share) for agent, share in shares.items()), class_="cards scores"),
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
    rest = ", ".join(f"{percent_of(share[key])} of {name}" for key, name in list(SHARES.items())[1:])
    return e(
        "div",
        e(
            "p",
            e("strong", percent_of(share["share_of_cost"]), class_="score"),
            e("b", agent),
            " of crash cost in situations passed",
        ),
        e(
            "p",
            f"{rest}; of the groups measured, which make {percent_of(share['measured_of_cost'])} of all cost",
            class_="note",
        ),
    )


def _table(shares: dict[str, dict[str, Any]]) -> Element:
    """A row for each group."""
    tolls: dict[str, dict[str, Any] | None] = {}
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for agent, share in shares.items():
        for group in share["groups"]:
            tolls[group["group"]] = group["toll"]
            found[group["group"], agent] = group
    greatest = max((toll["cost_musd"] for toll in tolls.values() if toll is not None), default=1)
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
            e("td", "weighs nothing" if toll is None else f"{toll['cost_musd'] / MUSD_IN_BUSD:.1f} bn $"),
            *(
                _bar(found.get((group, agent)), None if toll is None else toll["cost_musd"] / greatest)
                for agent in shares
            ),
        )
        for group, toll in tolls.items()
    ]
    missing = sorted({name for share in shares.values() for name in share["unmeasured"]})
    if missing:
        rows.append(
            e("tr", e("th", f"not measured: {', '.join(missing)}", colspan=len(shares) + 2, scope="row"), class_="none")
        )
    return e("table", e("thead", head), e("tbody", *rows), class_="matrix shares")


def _bar(group: dict[str, Any] | None, weight: float | None) -> Element:
    """One group with one agent: the outline is the weight, the filled part what was passed."""
    if group is None:
        return e("td", e("small", "not measured"))
    filled = e("i", style=f"width:{percent(group['survived'])}")
    bar = (
        None
        if weight is None
        else e("i", filled, class_="weight", style=f"width:{percent(weight)}", aria_hidden="true")
    )
    counts = [f"{group[key]} {key[: None if group[key] != 1 else -1]}" for key in ("cases", "scenarios")]
    told = f"{percent_of(group['survived'])} of {' of '.join(counts)}"
    return e("td", e("span", bar, class_="weights"), e("small", told))
