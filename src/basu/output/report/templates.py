"""The environment of all page templates: Jinja2 with autoescape and strict undefined names.

Text is escaped wherever it comes from: names of agents and messages of theirs are somebody else's words. Drawings are
elements made by `markup.e`; the filter ``drawn`` is the only way by which an element gets into a page.
"""

from __future__ import annotations

import functools
from typing import Any
from xml.etree.ElementTree import Element

import jinja2
from markupsafe import Markup

from basu.output.report.markup import DASH, FORBIDDEN, MINUS, TIMES, figure, html, number, percent, words


@functools.cache
def environment() -> jinja2.Environment:
    """The environment; templates are named by their path in ``basu/output/report``, as ``html/templates/page.j2``."""
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
    """A template filled in; every name that it uses has to be among ``values``."""
    return Markup(environment().get_template(template).render(**values))  # noqa: S704 - the template has escaped it


def drawn(element: Element | Markup | None) -> Markup:
    """An element, or what another template made of one, as it stands in a page; nothing for None."""
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
