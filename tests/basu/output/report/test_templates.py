"""Claims about the environment of page templates: text is escaped, and a missing name is an error."""

import jinja2
import pytest
from markupsafe import Markup

from basu.output.report.html.page import page
from basu.output.report.markup import e
from basu.output.report.templates import environment


def filled(source: str, **values: object) -> str:
    return environment().from_string(source).render(**values)


def test_text_is_escaped() -> None:
    assert filled("<p>{{ name }}</p>", name="<script>alert('x')</script>") == (
        "<p>&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;</p>"
    )


def test_a_name_that_is_not_given_is_an_error() -> None:
    with pytest.raises(jinja2.UndefinedError, match="'nobody' is undefined"):
        filled("{{ nobody }}")
    with pytest.raises(jinja2.UndefinedError):
        filled("{% if row.missing %}x{% endif %}", row={})


def test_an_element_gets_in_by_its_filter_and_its_text_stays_escaped() -> None:
    assert filled("{{ part|drawn }}", part=e("b", "<i>")) == "<b>&lt;i&gt;</b>"
    assert filled("{{ part|drawn }}", part=None) == ""
    with pytest.raises(TypeError, match="'drawn' takes an element, not str"):
        filled("{{ part|drawn }}", part="<b>")


def test_what_no_page_may_hold_is_replaced() -> None:
    assert filled("{{ name }}", name="a\x00b") == "a\ufffdb"


def test_what_stands_verbatim_cannot_end_its_element() -> None:
    with pytest.raises(AssertionError):
        filled("{{ style|verbatim }}", style="</style><script>")


def test_a_title_is_escaped() -> None:
    assert b"<title>&lt;/title&gt;</title>" in page("</title>", Markup("<body></body>"))
