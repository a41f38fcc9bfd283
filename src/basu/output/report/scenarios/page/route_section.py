"""The section on scenarios in the report of a route, and the style of cards, matrices and maps."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.output.report.scenarios.drawing.picture import picture_style
from basu.output.report.scenarios.page import case_card
from basu.output.report.scenarios.page.case_card import card, parameters, verdict_mark
from basu.output.report.scenarios.sweep.success_map import map_style
from basu.output.report.templates import e

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.streets import Line
    from basu.records.history import History


HERE = Path(__file__).parent


@functools.lru_cache
def card_style() -> str:
    """All of it."""
    return "\n".join([(HERE / "scenarios.css").read_text(encoding="utf-8"), picture_style(), map_style()])


def on_the_way(
    document: dict[str, Any], command: Sequence[str], history: History, streets: Sequence[Line]
) -> Element | None:
    """The section of a run's report; None where there were none. ``document`` is the run's result."""
    met = document.get("scenarios")
    if not met:
        return None
    section = e("section", e("h2", "Scenarios on the way"), case_card.key(), id="scenarios")
    section.extend(_one(scenario, document["meta"], command, history, streets) for scenario in met)
    return section


def _one(
    scenario: dict[str, Any],
    meta: dict[str, Any],
    command: Sequence[str],
    history: History,
    streets: Sequence[Line],
) -> Element:
    """A scenario, closed at first; one that was not reached has no more than its sentence."""
    told = f"{scenario['title']} Its trigger point lies {scenario['trigger_s_m']:.0f} m along the route."
    name = (e("b", scenario["id"]), " ", e("small", told))
    if scenario["verdict"] is None:
        return e("p", *name, e("br"), scenario["message"], class_="not-reached")
    case = {
        **scenario,
        "agent": meta["agent"]["name"],
        "vehicle": meta["vehicle"],
        "seed": meta["seed"],
        "town": meta["town"],
        "command": command,
        "simulated_s": (scenario["ended_s"] or float(history.frames["t_s"][-1])) - (scenario["began_s"] or 0.0),
        "wall_s": meta["wall_s"],
    }
    shown = card(case, history, streets)
    summary = e("summary", verdict_mark(scenario["verdict"]), " ", *name)
    return e("details", summary, parameters(scenario["parameters"]), shown, class_="evidence")
