"""A case with one agent as a card: verdict, picture, phases, judgements with evidence, tree, command."""

from __future__ import annotations

import re
import shlex
from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Any

from basu.output.report.plots.chart import share, times
from basu.output.report.scenarios.drawing.picture import case_drawing
from basu.output.report.scenarios.tally import LOOKS, counted
from basu.output.report.templates import DASH, percent, render
from basu.scenarios.characteristics import WEATHER_OF_CASE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from markupsafe import Markup

    from basu.metrics.result import Result
    from basu.output.report.streets import Line
    from basu.records.history import History

ANSWERS = {True: ("✓", "passed"), False: ("✗", "failed"), None: (DASH, "unjudged")}
JUDGEMENTS = {True: ("✓", "passed"), False: ("✗", "failed"), None: (DASH, "reported")}
SIGNS = {  # of what became of a node: a sign and a style
    "success": ("✓", "passed"),
    "failure": ("✗", "failed"),
    "running": ("…", "running"),
    "waiting": ("○", "waiting"),
    "broken off": ("⊘", "waiting"),
    "not judged": (DASH, "waiting"),
}
KINDS = {"sequence": "→", "parallel": "⇉", "selector": "?", "trigger": "⚑", "action": "▸", "criterion": "="}


PHASES = {  # as a scenario passes them, and what the line calls each
    "setup": "set-up",
    "trigger": "before",
    "conflict": "conflict",
    "resolution": "resolution",
}
LEAST_SHARE = 0.09  # of the line; the name of a shorter phase would not fit in it


def card(
    case: Mapping[str, Any],
    history: History | None,
    streets: Sequence[Line],
    *,
    name: str | None = None,
    result: Result | None = None,
    picture: bool = True,
) -> Markup:
    """Return the card, open; its place in a page is the ``anchor_of`` of ``name``, else of the case's id.

    ``result`` is that of the drive, where the case had one to itself: scores, users' metrics and conditions.
    """
    is_pictured = picture and history is not None and len(history.frames) > 0
    return render(
        "templates/case_card.j2",
        result=case,
        look=LOOKS[case["verdict"]],
        anchor=anchor_of(name or case["id"], case["agent"]),
        answers=list(_answers(case.get("assessment") or {})),  # a run made before them has none
        collisions=case.get("collisions") or [],
        picture=case_drawing(case, history, streets, moves=True) if is_pictured and history is not None else None,
        situation=_situation(case, history, result),
        phases=phase_line(case),
        judgements=list(_judgements(case["judgements"])),
        command=shlex.join(str(word) for word in case["command"]),
        terms=[*_conditions(case), *_of_drive(result)],
        kinds=KINDS,
        signs=SIGNS,
    )


def bare_card(id_: str, agent: str, result: dict[str, Any], why: str) -> Markup:
    """A card of a case of which no more is known than its line in the matrix."""
    return render(
        "templates/bare_card.j2",
        look=LOOKS[result["verdict"]],
        anchor=anchor_of(id_, agent),
        agent=agent,
        verdict=result["verdict"],
        message=result["message"],
        why=why,
    )


def anchor_of(case: str, agent: str) -> str:
    """The name of a card in a page; characters that no address may hold are written as numbers, so that all differ."""
    return "case-" + re.sub(r"[^A-Za-z0-9_-]", lambda found: f".{ord(found[0]):x}.", f"{case}--{agent}")


def _answers(assessment: dict[str, Any]) -> Iterable[tuple[str, str, str, str]]:
    """The policy's three answers: name, sign, style and sentence of each."""
    for name, found in assessment.items():
        is_absent = name == "exercised" and found["holds"] is False
        sign, style = ("○", "absent") if is_absent else ANSWERS[found["holds"]]
        yield name, sign, style, found["sentence"]


def _judgements(found: Iterable[dict[str, Any]]) -> Iterable[tuple[dict[str, Any], str, str]]:
    """Each criterion's judgement with sign and style, the deciding ones first."""
    for judgement in sorted(found, key=lambda one: not one["deciding"]):
        sign, style = JUDGEMENTS[judgement["passed"]]
        yield judgement, sign, style if judgement["deciding"] else "reported"


def _situation(case: Mapping[str, Any], history: History | None, result: Result | None) -> list[tuple[str, str]]:
    """Return the case's route, weather and traffic, as names and texts."""
    place = [str(case["place"])] if case.get("place") else []
    if history is not None:
        route = history.facts.route
        controls = Counter(control.kind.value.replace("_", " ") for control in route.controls)
        place += [f"{route.length_m:.0f} m", *(counted(count, kind) for kind, count in controls.items())]
    known = case.get("characteristics", {})
    weather = [] if result is None or result.meta["weather"] == WEATHER_OF_CASE else [str(result.meta["weather"])]
    weather = weather or [known[name] for name in ("atmosphere", "lighting", "surface") if name in known]
    return [
        (name, ", ".join(texts))
        for name, texts in (("route", place), ("weather", weather), ("traffic", _traffic(case, result)))
        if texts
    ]


def _traffic(case: Mapping[str, Any], result: Result | None) -> list[str]:
    """Return the scenario's actors and things by their models, and the traffic around them."""
    roles: dict[str, list[str]] = defaultdict(list)
    for actor in case["actors"]:
        roles[actor["type"]].append(actor["role"])
    found = [f"{', '.join(names)} ({type_})" for type_, names in roles.items()]
    if result is not None:
        around = result.meta["traffic"]
        found += [f"{counted(around[f'{kind}s'], kind)} around" for kind in ("vehicle", "walker") if around[f"{kind}s"]]
    return found or ["none"]


def _of_drive(result: Result | None) -> list[tuple[str, str]]:
    """The score of the drive and users' metrics, as names and texts."""
    if result is None:
        return []
    return [
        *([("driving score", f"{result.scores.driving:.3f}")] if result.scores is not None else []),
        *((each.heading, text) for each in result.shown() if (text := each.text(result)) is not None),
    ]


def _conditions(result: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The conditions of the case, as names and texts."""
    return [
        ("town", result["town"]),
        ("vehicle", result["vehicle"]),
        ("seed", str(result["seed"])),
        *result.get("characteristics", {}).items(),
        *_speeds(result.get("measured")),
        ("from", result["scenarios_file"]),
        ("simulated", f"{result['simulated_s']:.1f} s in {result['wall_s']:.1f} s"),
    ]


def _speeds(measured: dict[str, Any] | None) -> list[tuple[str, str]]:
    """The posted speed and the ego's where the conflict began."""
    if measured is None:
        return []
    posted_mps = measured["posted_mps"]
    posted = "none" if posted_mps is None else f"{posted_mps:.1f} m/s"
    return [("posted", posted), ("ego's speed at the conflict", f"{measured['travel_mps']:.1f} m/s")]


def phase_line(result: Mapping[str, Any]) -> dict[str, Any] | None:
    """The phases on a line of time with the failed criteria's moments and the axis; None where no phase began."""
    begun_s: dict[str, float] = result["phases_s"]
    if not begun_s:
        return None
    begin_s = min(begun_s.values())
    end_s = max(begun_s.get("end", begin_s + result["simulated_s"]), *begun_s.values(), begin_s + 0.1)
    order = [name for name in PHASES if name in begun_s]
    parts = []
    for name, following in zip(order, [*order[1:], None], strict=True):
        from_s = begun_s[name]
        to_s = end_s if following is None else begun_s[following]
        part = (to_s - from_s) / (end_s - begin_s)
        if part > 0.0:
            parts.append(
                {
                    "name": name,
                    "left": share(from_s, begin_s, end_s),
                    "width": percent(part),
                    "label": PHASES[name] if part >= LEAST_SHARE else "",
                    "title": f"{PHASES[name]} from {from_s:.1f} s to {to_s:.1f} s",
                }
            )
    return {"parts": parts, "moments": _moments(result, begin_s, end_s), "axis": times(begin_s, end_s)}


def _moments(result: Mapping[str, Any], begin_s: float, end_s: float) -> list[dict[str, str]]:
    """When the criteria that failed decided."""
    return [
        {
            "left": share(judgement["t_s"], begin_s, end_s),
            "title": f"{judgement['criterion']} at {judgement['t_s']:.1f} s",
        }
        for judgement in result["judgements"]
        if judgement["passed"] is False and judgement["deciding"] and judgement["t_s"] is not None
    ]
