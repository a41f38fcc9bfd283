"""Claims about charts and axes: round ticks, whole ranges, the places of things in time."""

import re

import numpy as np
import pytest

from basu.output.report.plots.chart import Curve, Flag, Shade, chart, clock, ticks, time_ticks
from basu.output.report.templates import html

T_S = np.linspace(0.0, 100.0, 201)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [(0.0, 10.0, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]), (-1.0, 1.0, [-1.0, -0.5, 0.0, 0.5, 1.0]), (3.0, 3.0, [3.0])],
)
def test_ticks_are_round_and_inside(low: float, high: float, expected: list[float]) -> None:
    assert ticks(low, high) == pytest.approx(expected)


def test_long_times_are_reported_in_minutes() -> None:
    assert [clock(t_s, long=True) for t_s in time_ticks(0.0, 1122.0)] == [
        "0:00", "2:00", "4:00", "6:00", "8:00", "10:00", "12:00", "14:00", "16:00", "18:00",
    ]  # fmt: skip
    assert clock(7.5, long=False) == "7.5"


def test_days_have_ticks_too() -> None:
    assert len(time_ticks(0.0, 86_400.0)) <= 11


def test_a_chart_shows_its_extremes() -> None:
    values = np.sin(T_S)
    page = html(chart(T_S, [Curve("a", values, "first")], title="A", unit="m"))
    assert ">1<" in page
    assert ">\u22121<" in page  # a printer's minus


def test_a_chart_of_nothing_is_still_a_chart() -> None:
    nothing = np.full(len(T_S), np.nan)
    assert "<figure" in html(chart(T_S, [Curve("a", nothing, "first")], title="A", unit="m"))


def test_a_chart_of_one_moment_is_still_a_chart() -> None:
    assert "<figure" in html(chart(np.array([0.0]), [Curve("a", np.array([1.0]), "first")], title="A", unit="m"))


def test_marks_and_shades_stand_at_their_time() -> None:
    page = html(
        chart(
            T_S,
            [Curve("a", T_S, "first")],
            title="A",
            unit="m",
            shades=[Shade(25.0, 50.0, "manual"), Shade(200.0, 300.0, "manual")],
            marks=[Flag(75.0, "3", "a thing", "#infraction-3")],
        )
    )
    assert "left:25%;right:50%" in page
    assert page.count("shade") == 1  # the other lies outside
    assert 'href="#infraction-3"' in page
    assert "left:75%" in page


def test_a_limit_jumps_and_a_speed_does_not() -> None:
    values = np.where(T_S < 50.0, 5.0, 10.0)
    steps = html(chart(T_S, [Curve("limit", values, "limit", steps=True)], title="A", unit="m/s"))
    slopes = html(chart(T_S, [Curve("limit", values, "limit")], title="A", unit="m/s"))
    drawn, straight = (re.findall(r'd="([^"]*)" class="line limit"', page)[-1] for page in (steps, slopes))
    assert re.fullmatch(r"M\S+ \S+(H\S+?V\S+?)+", drawn)
    assert "V" not in straight


def test_names_of_levels_that_would_overlap_are_left_out() -> None:
    levels = [(1.0, "one"), (2.5, "two and a half")]
    small = html(chart(T_S, [Curve("a", np.sin(T_S) * 4.0, "first")], title="A", unit="m", levels=levels))
    large = html(chart(T_S, [Curve("a", np.sin(T_S) * 400.0, "first")], title="A", unit="m", levels=levels))
    assert "two and a half" in small
    assert "two and a half" not in large
