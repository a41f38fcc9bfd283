"""HTML and SVG: elements, numbers as text, and the Jinja2 environment with autoescape and strict undefined names.

Text is escaped wherever it comes from: names and messages of agents are foreign text. Pages are templates; drawings are
elements made by `e`. The filter ``drawn`` is the only way by which an element gets into a page.
"""

from __future__ import annotations

import functools
import math
import re
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, tostring

import jinja2
from markupsafe import Markup

if TYPE_CHECKING:
    from collections.abc import Iterable


TIMES, DASH, MINUS = "\u00d7", "\u2013", "\u2212"  # signs as printers set them
# what no HTML page may hold: control characters but for tab and line feed, and halves of surrogate pairs
FORBIDDEN = re.compile("[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]")


def e(tag: str, *children: Element | str | None, **attributes: object) -> Element:
    """Return an element. ``class_`` means class, ``stroke_width`` stroke-width; an attribute of None is left out."""
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
    """Return a name as it stands in a file, as people write it."""
    return name.replace("_", " ")


def number(value: float, digits: int = 2) -> str:
    """Return a number as short as it can be at so many digits."""
    text = f"{value:.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def figure(value: float | None, digits: int = 3) -> str:
    """Return a number for people to compare: its digits kept, a dash where there is none."""
    return DASH if value is None or not math.isfinite(value) else f"{value:.{digits}f}"


def percent(share: float) -> str:
    """Return a share as a length in CSS."""
    return f"{number(100.0 * share, 3)}%"


def html(element: Element) -> str:
    """Return an element and all that is in it as HTML."""
    return tostring(element, encoding="unicode", method="html")


def _written(value: object) -> str:
    """Return an attribute's value as text."""
    return number(value) if isinstance(value, float) else str(value)


def _plain(text: str) -> str:
    """Text without what an HTML page may not hold."""
    return FORBIDDEN.sub("\ufffd", text)


@functools.cache
def environment() -> jinja2.Environment:
    """Return the environment; templates are named by their path in ``basu/output/report``, as ``templates/page.j2``."""
    made = jinja2.Environment(
        loader=jinja2.PackageLoader("basu.output", "report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=printable,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=False,
    )
    made.filters |= {"drawn": drawn, "words": words, "figure": figure, "number": number, "percent": percent}
    made.filters["verbatim"] = verbatim
    made.globals |= {"DASH": DASH, "TIMES": TIMES, "MINUS": MINUS}
    return made


def render(template: str, **values: Any) -> Markup:  # noqa: ANN401 - whatever the template shows
    """Return a template filled in; every name that it uses has to be among ``values``."""
    return Markup(environment().get_template(template).render(**values))  # noqa: S704 - the template has escaped it


def drawn(element: Element | Markup | None) -> Markup:
    """Return an element, or what another template made of one, as it stands in a page; nothing for None."""
    if element is None:
        return Markup("")
    if isinstance(element, Markup):
        return element
    if not isinstance(element, Element):
        raise TypeError(f"'drawn' takes an element, not {type(element).__name__}: text is escaped without it")
    return Markup(html(element))  # noqa: S704 - ElementTree has escaped it


def verbatim(text: str) -> Markup:
    """BASU's own style, script or figures as they stand; they cannot end their element."""
    assert "</" not in text, "nothing of BASU's own ends an element"
    return Markup(text)  # noqa: S704 - the assertion above


def printable(value: object) -> object:
    """Text without what an HTML page may not hold; everything else as it is."""
    return FORBIDDEN.sub("\ufffd", value) if isinstance(value, str) and not isinstance(value, Markup) else value
