"""Figures of a result as rows for people: names and units come from the keys, which carry them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.output.report.markup import DASH, e, words

if TYPE_CHECKING:
    from collections.abc import Mapping
    from xml.etree.ElementTree import Element

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


class Row(NamedTuple):
    """A figure by name, as text."""

    name: str
    text: str


def rows(document: Mapping[str, Any], before: str = "") -> list[Row]:
    """Every figure of a document, those within its parts under the parts' names; lists by their number."""
    found = []
    for key, value in document.items():
        name, unit = _unit(key)
        name = f"{before}{name}"
        if isinstance(value, dict):
            found += rows(value, f"{name}: ") if value else [Row(name, "none")]
        else:
            found.append(Row(name, _text(value, unit)))
    return found


def table(found: list[Row], caption: str | None = None) -> Element:
    """Rows as a table."""
    body = e("tbody", *(e("tr", e("th", row.name, scope="row"), e("td", row.text)) for row in found))
    return e("table", None if caption is None else e("caption", caption), body, class_="figures")


def _unit(key: str) -> tuple[str, str]:
    """The name and the unit that a key is made of."""
    stem, _, last = key.rpartition("_")
    if stem and last in UNITS:
        return words(stem), UNITS[last]
    return words(key), ""


def _text(value: object, unit: str) -> str:
    """A value as people read it."""
    if value is None:
        return DASH
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        plain = all(isinstance(item, str | int | float) for item in value)
        return ", ".join(_text(item, unit) for item in value) if value and plain else str(len(value))
    text = f"{value:.3f}" if isinstance(value, float) else str(value)
    return f"{text} {unit}" if unit else text
