"""HTML by construction: elements of the standard library's tree, so that whatever is text is escaped.

Names of agents and messages of theirs are somebody else's words. There is no place here where text could pass for
markup, and nothing to forget: that is why no template language is used.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, tostring

if TYPE_CHECKING:
    from collections.abc import Iterable

TIMES, DASH, MINUS = "\u00d7", "\u2013", "\u2212"  # signs as printers set them
# what no HTML page may hold: control characters but for tab and line feed, and halves of surrogate pairs
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]")


def e(tag: str, *children: Element | str | None, **attributes: object) -> Element:
    """An element. ``class_`` means class, ``stroke_width`` stroke-width; an attribute of None is left out."""
    element = Element(tag)
    for key, value in attributes.items():
        if value is not None:
            element.set(key.rstrip("_").replace("_", "-"), _plain(_written(value)))
    return extended(element, children)


def extended(element: Element, children: Iterable[Element | str | None]) -> Element:
    """``element`` with more children; None is left out."""
    for child in children:
        if isinstance(child, Element):
            element.append(child)
        elif child is not None and len(element):
            element[-1].tail = (element[-1].tail or "") + _plain(child)
        elif child is not None:
            element.text = (element.text or "") + _plain(child)
    return element


def words(name: str) -> str:
    """A name as it stands in a file, as people write it."""
    return name.replace("_", " ")


def number(value: float, digits: int = 2) -> str:
    """A number as short as it can be at so many digits."""
    text = f"{value:.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def figure(value: float | None, digits: int = 3) -> str:
    """A number for people to compare: its digits kept, a dash where there is none."""
    return DASH if value is None or not math.isfinite(value) else f"{value:.{digits}f}"


def percent(share: float) -> str:
    """A share as a length in CSS."""
    return f"{number(100.0 * share, 3)}%"


def html(element: Element) -> str:
    """An element and all that is in it as HTML."""
    return tostring(element, encoding="unicode", method="html")


def _written(value: object) -> str:
    """An attribute's value."""
    return number(value) if isinstance(value, float) else str(value)


def _plain(text: str) -> str:
    """Text without what an HTML page may not hold."""
    return FORBIDDEN.sub("\ufffd", text)
