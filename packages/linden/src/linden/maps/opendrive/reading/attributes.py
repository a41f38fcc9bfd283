"""Typed reading of XML attributes: a number that is a number, or a sentence with the line."""

import math
from math import isfinite
from typing import Any, NoReturn

from lxml.etree import _Element as Element

from linden.maps.opendrive.limits import LARGEST_NUMBER, MapError

_MPS_PER_UNIT = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}


def line_of(node: Any) -> int:  # noqa: ANN401 - lxml's stubs have no type for sourceline
    """Return the line of the file on which an element begins, 0 where that is not known."""
    return int(node.sourceline or 0)


def reject(node: Element, attribute: str, expected: str) -> NoReturn:
    """Raise a MapError that names the element, the attribute and what should stand there."""
    found = node.get(attribute)
    shown = "is missing" if found is None else f"is {found[:40]!r}"
    raise MapError(f"attribute {attribute!r} of <{node.tag}> {shown}; it should be {expected}", line_of(node))


def number(node: Element, attribute: str) -> float:
    """Return a finite number that has to be there."""
    text = node.get(attribute, "")
    try:
        value = float(text)
    except ValueError:
        reject(node, attribute, "a number")
    if not isfinite(value) or "_" in text:  # only Python takes 1_000 for a number
        reject(node, attribute, "a finite number")
    if abs(value) > LARGEST_NUMBER:
        reject(node, attribute, f"between {-LARGEST_NUMBER:g} and {LARGEST_NUMBER:g}")
    return value


def number_or(node: Element, attribute: str, default: float) -> float:
    """Return a finite number, ``default`` where the attribute is missing or empty."""
    return number(node, attribute) if node.get(attribute) else default


def within(node: Element, attribute: str, least: float, most: float) -> float:
    """Return a number that has to be there, between two others."""
    value = number(node, attribute)
    if not least <= value <= most:
        reject(node, attribute, f"between {least:g} and {most:g}")
    return value


def whole(node: Element, attribute: str) -> int:
    """Return a whole number that has to be there, in the range of the 32-bit ids CARLA keeps."""
    try:
        value = int(node.get(attribute, ""))
    except ValueError:
        reject(node, attribute, "a whole number (CARLA reads anything else as 0)")
    if not -(2**31) <= value < 2**31:
        reject(node, attribute, "a whole number of 32 bits")
    return value


def cubic_coefficients(node: Element) -> tuple[float, float, float, float]:
    """Return a, b, c, d; what is missing counts as 0, as in LibCarla."""
    get = node.get
    try:
        a, b, c, d = float(get("a") or 0.0), float(get("b") or 0.0), float(get("c") or 0.0), float(get("d") or 0.0)
    except ValueError:
        a = b = c = d = math.nan
    if abs(a) + abs(b) + abs(c) + abs(d) <= LARGEST_NUMBER:
        return a, b, c, d
    return number_or(node, "a", 0.0), number_or(node, "b", 0.0), number_or(node, "c", 0.0), number_or(node, "d", 0.0)


def speed_mps(node: Element) -> float | None:
    """Return the limit of a <speed> element in m/s; None for "no limit" and "undefined". Without a unit it is m/s."""
    text = node.get("max", "")
    if text in {"no limit", "undefined", ""}:
        return None
    factor = _MPS_PER_UNIT.get(node.get("unit") or "m/s")
    if factor is None:
        reject(node, "unit", "one of m/s, km/h, mph")
    value = number(node, "max")
    if value < 0.0:
        reject(node, "max", "0 or more")
    return value * factor


def user_data(node: Element) -> tuple[tuple[str, str], ...]:
    """Return the (code, value) pairs of an element's own <userData> children."""
    return tuple((child.get("code", ""), child.get("value", "")) for child in node.iterchildren("userData"))
