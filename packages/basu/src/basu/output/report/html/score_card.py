"""The score card of a report: the driving score with its parts, other judgements, and figures as rows."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.output.report import events
from basu.output.report.console import is_by_hand, why_not_comparable, written
from basu.output.report.templates import DASH, e, render, words

if TYPE_CHECKING:
    from collections.abc import Mapping
    from xml.etree.ElementTree import Element

    from markupsafe import Markup

    from basu.metrics.result import Result


UNITS = {
    "mps3": "m/s³",
    "mps2": "m/s²",
    "mps": "m/s",
    "miles": "mi",
    "km": "km",
    "m": "m",
    "s": "s",
    "rad": "rad",
    "deg": "°",
}


class NamedFigure(NamedTuple):
    """A figure by name, as text."""

    name: str
    text: str


def rows(document: Mapping[str, Any], before: str = "") -> list[NamedFigure]:
    """Return every figure of a document, those within its parts under the parts' names; lists by their number."""
    found = []
    for key, value in document.items():
        name, unit = _unit(key)
        name = f"{before}{name}"
        if isinstance(value, dict):
            found += rows(value, f"{name}: ") if value else [NamedFigure(name, "none")]
        else:
            found.append(NamedFigure(name, _text(value, unit)))
    return found


def table(found: list[NamedFigure], caption: str | None = None) -> Element:
    """Rows as a table."""
    body = e("tbody", *(e("tr", e("th", row.name, scope="row"), e("td", row.text)) for row in found))
    return e("table", None if caption is None else e("caption", caption), body, class_="figures")


def _unit(key: str) -> tuple[str, str]:
    """Return the name and the unit that a key is made of."""
    stem, _, last = key.rpartition("_")
    if stem and last in UNITS:
        return words(stem), UNITS[last]
    return words(key), ""


def _text(value: object, unit: str) -> str:
    """Return a value as people read it."""
    if value is None:
        return DASH
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        plain = all(isinstance(item, str | int | float) for item in value)
        return ", ".join(_text(item, unit) for item in value) if value and plain else str(len(value))
    text = f"{value:.3f}" if isinstance(value, float) else str(value)
    return f"{text} {unit}" if unit else text


FIGURES = ("comfort_parts", "harm", "largest", "balance", "vibration")  # of the passengers, behind their verdict


def score_card(result: Result) -> Markup:
    """Return the card of a result: equation 5.5 on the left, equation 5.1 on the right, other judgements below."""
    if result.scores is None:
        return render("templates/score_card.j2", scores=None, success=result.success)
    counts = Counter(found.kind.value for found in result.infractions)
    passengers, leaderboard = result.metrics["passengers"], result.metrics["leaderboard"]
    shown = {key: passengers[key] for key in FIGURES if key in passengers} if passengers else {}
    scores, scoring = result.scores, result.scoring
    return render(
        "templates/score_card.j2",
        scores=scores,
        success=result.success,
        by_hand=is_by_hand(result),
        is_broken_off=result.is_broken_off,
        why_not_comparable=why_not_comparable(result),
        track=result.track,
        refused=result.meta["access"]["refused"] if result.track else {},
        score_parts=[
            ("infractions", scores.infraction, round(scoring["infraction_weight"], 6)),
            ("path following", scores.path_following, round(scoring["path_following_weight"], 6)),
        ],
        penalties=[
            (kind, events.symbol(kind), counts[kind], penalty) for kind, penalty in scoring["penalties"].items()
        ],
        leaderboard=leaderboard,
        not_measured=sorted({words(kind) for each in (leaderboard or {}).values() for kind in each["not_measured"]}),
        passengers=passengers,
        passenger_figures=table(rows(shown)),
        has_riders=bool(passengers) and any(visit.get("waiting") is not None for visit in passengers["service"]),
        own=[(own.title, written(own.value, own.unit, own.digits), bool(own.penalties)) for own in result.own.values()],
    )
