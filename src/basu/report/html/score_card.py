"""The score card: the thesis's driving score and how it came about, other judgements of the same drive beside it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.report.html import figures
from basu.report.markup import TIMES, e, figure, percent
from basu.report.plots import marks

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


def score_card(document: dict[str, Any]) -> Element:
    """The card of a result."""
    if document["scores"] is None:
        return e("section", e("h2", "Score"), e("p", "Nothing was driven, so there is no score."), class_="card")
    card = e("section", e("h2", "Score"), class_="card")
    card.append(e("div", _thesis(document), _penalties(document), class_="cards"))
    others = [
        figures.table(figures.rows(document[key]), caption)
        for key, caption in (("leaderboard", "CARLA leaderboard"), ("passengers", "Standing passengers"))
        if document.get(key)
    ]
    if others:
        card.append(e("div", *others, class_="cards"))
    return card


def reported(document: dict[str, Any]) -> Element | None:
    """What was measured and does not enter the score."""
    if not document.get("reported"):
        return None
    table = figures.table(figures.rows(document["reported"]))
    return e("section", e("h2", "Reported, not scored"), e("div", table, class_="columns"))


def _thesis(document: dict[str, Any]) -> Element:
    """The driving score as the weighted mean of its two parts (equation 5.5)."""
    scores, scoring = document["scores"], document["scoring"]
    parts = [
        ("infractions", scores["infraction"], scoring["infraction_weight"]),
        ("path following", scores["path_following"], scoring["path_following_weight"]),
    ]
    head = e("tr", *(e("th", text, scope="col") for text in ("part", "score", "weight", "gives")))
    body = [
        e(
            "tr",
            e("th", name, scope="row"),
            e("td", figure(score), _bar(score)),
            e("td", f"{TIMES} {weight:g}"),
            e("td", figure(score * weight)),
        )
        for name, score, weight in ((name, score, round(weight, 6)) for name, score, weight in parts)
    ]
    total = e(
        "tr", e("th", "driving score", colspan=3, scope="row"), e("td", figure(scores["driving"])), class_="total"
    )
    return e(
        "div",
        e("p", e("strong", figure(scores["driving"]), class_="score"), " driving score, from 0 (bad) to 1 (good)"),
        e("table", e("thead", head), e("tbody", *body, total)),
    )


def _penalties(document: dict[str, Any]) -> Element:
    """The infraction score as a product (equation 5.1)."""
    counts = Counter(infraction["kind"] for infraction in document["infractions"])
    penalties = document["scoring"]["penalties"]
    head = e("tr", *(e("th", text, scope="col") for text in ("infraction", "number", "factor", "gives")))
    body = [
        e(
            "tr",
            e("th", marks.symbol(kind), marks.words(kind), scope="row"),
            e("td", str(counts[kind])),
            e("td", f"{penalty:g}"),
            e("td", figure(penalty ** counts[kind])),
            class_=None if counts[kind] else "none",
        )
        for kind, penalty in penalties.items()
    ]
    total = e(
        "tr",
        e("th", "infraction score, the product", colspan=3, scope="row"),
        e("td", figure(document["scores"]["infraction"])),
        class_="total",
    )
    return e("div", e("table", e("thead", head), e("tbody", *body, total)))


def _bar(score: float) -> Element:
    """A score as a length."""
    return e("i", e("i", style=f"width:{percent(min(1.0, max(0.0, score)))}"), class_="bar", aria_hidden="true")
