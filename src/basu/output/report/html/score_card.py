"""The score card: the thesis's driving score and how it came about, other judgements of the same drive beside it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from basu.output.report.html import figures
from basu.output.report.markup import DASH, TIMES, e, figure, percent, words
from basu.output.report.plots import marks

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


AT_ONCE = 4  # reasons of the passengers that are shown without asking


def score_card(document: dict[str, Any]) -> Element:
    """The card of a result."""
    if document["scores"] is None:
        return e("section", e("h2", "Score"), e("p", "Nothing was driven, so there is no score."), class_="card")
    card = e("section", e("h2", "Score"), class_="card")
    card.append(e("div", _thesis(document), _penalties(document), class_="cards"))
    others = [
        render(document[key])
        for key, render in (("leaderboard", _leaderboard), ("passengers", _passengers))
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
            e("th", marks.symbol(kind), words(kind), scope="row"),
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


def _leaderboard(editions: dict[str, dict[str, Any]]) -> Element:
    """The same drive as the CARLA leaderboard would have scored it, an edition a column."""
    rows = (
        ("driving score, 0 to 100", "driving"),
        ("route completion, %", "route_completion"),
        ("infraction penalty", "infraction_penalty"),
        ("ended by", "ended_by"),
    )
    head = e("tr", e("th", "edition", scope="col"), *(e("th", name, scope="col") for name in editions))
    body = [
        e("tr", e("th", name, scope="row"), *(e("td", _plain(edition.get(key))) for edition in editions.values()))
        for name, key in rows
    ]
    table = e("table", e("caption", "CARLA leaderboard"), e("thead", head), e("tbody", *body), class_="editions")
    missing = sorted({words(what) for edition in editions.values() for what in edition["not_measured"]})
    return e("div", table, e("p", f"Not measured: {', '.join(missing)}.", class_="note") if missing else None)


def _plain(value: object) -> str:
    """A cell of the leaderboard's table."""
    return figure(value) if isinstance(value, float | int) else words(str(value)) if value else DASH


def _passengers(verdict: dict[str, Any]) -> Element:
    """Whether standing passengers would have stood the ride, and what they hold against it."""
    word, style = ("passed", "nobody") if verdict["passed"] else ("failed", "agent")
    comfort = figure(verdict["comfort_score"])
    shown: dict[str, Any] = {
        key: verdict[key] for key in ("comfort_parts", "largest", "balance", "vibration") if key in verdict
    }
    return e(
        "div",
        e("table", e("caption", "Standing passengers")),
        e("p", e("b", word, class_=f"status {style}"), f" comfort score {comfort}, from 0 (bad) to 1 (good)"),
        *_reasons(verdict["reasons"]),
        e("details", e("summary", "figures"), figures.table(figures.rows(shown))),
        _service(verdict["service"]) if verdict.get("service") else None,
    )


def _reasons(reasons: list[str]) -> list[Element]:
    """What they say, the first of it at once."""
    found = [e("ul", *(e("li", reason) for reason in reasons[:AT_ONCE]))] if reasons else []
    if len(reasons) > AT_ONCE:
        rest = e("ul", *(e("li", reason) for reason in reasons[AT_ONCE:]))
        found.append(e("details", e("summary", f"{len(reasons) - AT_ONCE} more"), rest))
    return found


def _service(visits: list[dict[str, Any]]) -> Element:
    """The service stops against the timetable."""
    head = e("tr", *(e("th", text, scope="col") for text in ("stop", "arrival", "planned", "late", "dwell")))
    seconds = ("arrival_s", "planned_arrival_s", "delay_s", "dwell_s")
    body = [
        e(
            "tr",
            e("th", f"{visit['stop_id']} {visit['name']}", scope="row"),
            *(e("td", DASH if visit[key] is None else f"{visit[key]:.0f} s") for key in seconds),
        )
        for visit in visits
    ]
    return e("table", e("caption", "Service"), e("thead", head), e("tbody", *body))


def _bar(score: float) -> Element:
    """A score as a length."""
    return e("i", e("i", style=f"width:{percent(min(1.0, max(0.0, score)))}"), class_="bar", aria_hidden="true")
