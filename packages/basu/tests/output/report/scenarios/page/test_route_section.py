"""Claims about a route's report with scenarios on its way: a card for each that was reached, else a sentence."""

from dataclasses import replace
from typing import Any

from basu.output.report.html.page import report
from fakes.run_records import record
from fakes.scenario_documents import case_result, crossing


def on_way(**changes: Any) -> dict[str, Any]:
    """As a route's result tells a scenario."""
    keys = ("id", "scenario", "title", "group", "parameters", "verdict", "fault", "message", "phases_s", "judgements")
    known = {key: case_result()[key] for key in (*keys, "margins", "tree", "actors", "things", "scenarios_file")}
    more = {"unread": [], "trigger_s_m": 24.0, "reached": True, "began_s": 0.0, "ended_s": 11.5, "timeout_s": 60.0}
    return {**known, **more, **changes}


def page_with(*scenarios: dict[str, Any]) -> str:
    run = record(crossing())
    run = replace(run, result=replace(run.result, scenarios=scenarios))
    return report(run).decode()


def test_each_that_was_reached_has_a_card_with_its_picture_and_tree() -> None:
    page = page_with(on_way(), on_way(id="second", ended_s=None))
    assert "Scenarios on the way" in page
    assert page.count('class="case-picture"') == 2
    assert page.count('class="tree"') == 2
    assert "1.20 m to walker at 8.1 s" in page


def test_a_card_names_route_weather_and_traffic() -> None:
    page = page_with(on_way())
    for text in ("<dt>route</dt><dd>", "<dt>traffic</dt><dd>walker (walker.pedestrian."):
        assert text in page


def test_one_that_was_not_reached_has_its_sentence() -> None:
    page = page_with(
        on_way(verdict=None, reached=False, message="not reached: it waits at 300 m of the route", phases_s={})
    )
    assert "not reached: it waits at 300 m of the route" in page
    assert 'class="case-picture"' not in page


def test_a_run_without_scenarios_has_neither_section_nor_their_style() -> None:
    page = report(record(crossing())).decode()
    assert "Scenarios on the way" not in page
    assert ".case-picture" not in page
