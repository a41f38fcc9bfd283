"""The section on scenarios in the report of a route, and the style of cards, matrices and maps."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.output.report.scenarios.drawing.picture import picture_style
from basu.output.report.scenarios.page.case_card import KINDS, SIGNS, card
from basu.output.report.scenarios.sweep.success_map import map_style
from basu.output.report.scenarios.tally import LOOKS, Look
from basu.output.report.templates import render

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from markupsafe import Markup

    from basu.metrics.result import Result
    from basu.output.report.streets import Line
    from basu.records.history import History


HERE = Path(__file__).parent


@functools.lru_cache
def card_style() -> str:
    """The style of all of them."""
    return "\n".join([(HERE / "scenarios.css").read_text(encoding="utf-8"), picture_style(), map_style()])


def on_the_way(result: Result, command: Sequence[str], history: History, streets: Sequence[Line]) -> Markup | None:
    """Return the section of a drive's report on its own case, or on the scenarios of its route; None without any."""
    case = result.case
    told: list[tuple[dict[str, Any], Look | None, Markup | None]]
    if case is not None:
        told = [(dict(case), LOOKS[case["verdict"]], card(case, history, streets, result=result))]
    else:
        told = [_one(dict(scenario), result.meta, command, history, streets) for scenario in result.scenarios]
    if not told:
        return None
    return render(
        "templates/route_scenarios.j2",
        title="Scenarios on the way" if case is None else "The case",
        scenarios=told,
        kinds=KINDS,
        signs=SIGNS,
    )


def _one(
    scenario: dict[str, Any],
    meta: Mapping[str, Any],
    command: Sequence[str],
    history: History,
    streets: Sequence[Line],
) -> tuple[dict[str, Any], Look | None, Markup | None]:
    """A scenario with the look of its verdict and its card; one that was not reached has neither."""
    if scenario["verdict"] is None:
        return scenario, None, None
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
    return scenario, LOOKS[scenario["verdict"]], card(case, history, streets)
