"""The score card of a report: the driving score with its parts, other judgements, and figures as rows."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.metrics.registry import built_in
from basu.output.report import events
from basu.output.report.console import why_not_comparable
from basu.output.report.templates import DASH, e, render, words
from basu.units import parted

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from xml.etree.ElementTree import Element

    from markupsafe import Markup

    from basu.metrics.result import Result


class NamedFigure(NamedTuple):
    """A figure by name, as text."""

    name: str
    text: str


def rows(document: Mapping[str, Any], before: str = "") -> list[NamedFigure]:
    """Return every figure of a document, those within its parts under the parts' names; lists by their number."""
    found = []
    for key, value in document.items():
        stem, unit = parted(key)
        name = f"{before}{words(stem)}"
        if isinstance(value, dict):
            found += rows(value, f"{name}: ") if value else [NamedFigure(name, "none")]
        else:
            found.append(NamedFigure(name, _text(value, unit)))
    return found


def table(found: list[NamedFigure], caption: str | None = None) -> Element:
    """Return rows as a table of HTML."""
    body = e("tbody", *(e("tr", e("th", row.name, scope="row"), e("td", row.text)) for row in found))
    return e("table", None if caption is None else e("caption", caption), body, class_="figures")


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


CARDS = Path(__file__).parents[1] / "templates" / "metrics"  # of metrics with a card of their own, by name


def figures(value: Mapping[str, Any], keys: Sequence[str]) -> Element:
    """Return some figures of a value as a table."""
    return table(rows({key: value[key] for key in keys if key in value}))


def cards(result: Result) -> dict[str, Markup]:
    """Return the card of each metric that has a template of its own, by the metric's name."""
    return {
        metric.name: render(f"templates/metrics/{metric.name}.j2", value=value, figures=figures)
        for metric in built_in()
        if (value := result.metrics.get(metric.name)) and (CARDS / f"{metric.name}.j2").is_file()
    }


def further(result: Result) -> list[tuple[str, str, bool]]:
    """Return heading, text and whether it is scored of each metric that is a number or a user's own."""
    found = [(each.heading, each.text(result), each.is_scored) for each in result.shown()]
    return [(heading, text, is_scored) for heading, text, is_scored in found if text is not None]


def score_card(result: Result) -> Markup:
    """Return the card of a result: equation 5.5 on the left, equation 5.1 on the right, other judgements below."""
    if result.scores is None:
        return render("templates/score_card.j2", scores=None, success=result.success)
    counts = Counter(found.kind.value for found in result.infractions)
    scores, scoring = result.scores, result.scoring
    shown = cards(result)
    return render(
        "templates/score_card.j2",
        scores=scores,
        success=result.success,
        remarks=result.remarks(),
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
        passengers=shown.pop("passengers", None),
        cards=list(shown.values()),
        further=further(result),
    )
