"""Tests of ``basu.output.report.templates``."""

from html.parser import HTMLParser

import jinja2
import pytest
from hypothesis import given
from hypothesis import strategies as st
from markupsafe import Markup

from basu.output.report.html.page import page
from basu.output.report.templates import e, environment, figure, html, number


class Reader(HTMLParser):
    """Collects what a browser would see."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, list[tuple[str, str | None]]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, attrs))

    def handle_data(self, data: str) -> None:
        self.text += data


def read(page: str) -> Reader:
    reader = Reader()
    reader.feed(page)
    reader.close()
    return reader


@given(st.text(st.characters(exclude_categories=["Cs", "Cc"])))
def test_any_text_comes_back_as_that_text_and_brings_no_tag(text: str) -> None:
    reader = read(html(e("p", text, title=text)))
    assert reader.tags == [("p", [("title", text)])]
    assert reader.text == text


@pytest.mark.parametrize("text", ["\x00", "\x1b[31m", "\ud800", "\r"])
def test_what_no_page_may_hold_becomes_a_replacement_character(text: str) -> None:
    page = html(e("p", text, title=text))
    page.encode()
    assert text[0] not in page
    assert "\ufffd" in page


def test_attributes_of_none_and_children_of_none_are_left_out() -> None:
    assert html(e("a", "x", None, e("b", "y"), "z", href=None, class_="k", stroke_width=1.50)) == (
        '<a class="k" stroke-width="1.5">x<b>y</b>z</a>'
    )


def test_numbers_are_as_short_as_they_can_be() -> None:
    assert [number(value, 2) for value in (1.0, 0.5, 100.0, 1.239, -0.001)] == ["1", "0.5", "100", "1.24", "-0"]


def test_a_figure_that_is_none_is_a_dash() -> None:
    assert figure(None) == figure(float("nan")) == "\u2013"
    assert figure(0.5) == "0.500"


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
