"""The list of scenarios and cases as text and as JSON: by group, with parameters and places."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from basu.scenarios.cases import ALL, snake
from basu.scenarios.characteristics import Characteristics, characteristics_of
from basu.scenarios.nhtsa import BURDENS, Group
from basu.scenarios.parameters import Number
from basu.scenarios.playable import Playable, having
from basu.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.cases import Library
    from basu.scenarios.parameters import Parameter

Listed = dict[type[Scenario], list[Playable]]  # the cases of each scenario
WIDTH = 120  # of a line


def listed(library: Library, words: list[str], where: Sequence[tuple[str, str]] = ()) -> Listed:
    """The chosen cases with the requested characteristics, below their scenarios.

    Without words and characteristics, scenarios that have no case are listed as well.

    Raises:
        ScenarioError: nothing is meant by a word, or no case has such characteristics.
    """
    found: Listed = {} if words or where else {scenario: [] for scenario in library.scenarios}
    for playable in having(library.choose(words or [ALL]), where):
        found.setdefault(playable.scenario, []).append(playable)
    return found


def as_text(cases_by_type: Listed, *, full: bool) -> list[str]:
    """A block a group, two lines or more a scenario."""
    lines = []
    for group in Group:
        scenarios = [scenario for scenario in cases_by_type if scenario.group is group]
        if not scenarios:
            continue
        burden = BURDENS.get(group)
        yearly = f": {burden.crashes:,} crashes a year, {burden.cost_musd:,} million dollars" if burden else ""
        lines.append(f"{group.value.upper()}{yearly}")
        for scenario in scenarios:
            cases = cases_by_type[scenario]
            sentence = f"{snake(scenario.__name__)} ({_many(len(cases), 'case')}): {scenario.title()}"
            lines += textwrap.wrap(sentence, WIDTH, initial_indent="  ", subsequent_indent="      ")
            lines += _in_full(scenario, cases) if full else _in_short(scenario, cases)
        lines.append("")
    groups = len({scenario.group for scenario in cases_by_type})
    total = sum(len(cases) for cases in cases_by_type.values())
    counts = f"{_many(len(cases_by_type), 'scenario')} of {_many(groups, 'group')}, {_many(total, 'case')}"
    return [*lines, counts + ("" if full else "; `basu scenario list NAME` shows one in full")]


def _many(count: int, noun: str) -> str:
    """A count with its noun."""
    return f"{count} {noun}{'s' * (count != 1)}"


def _in_short(scenario: type[Scenario], cases: list[Playable]) -> list[str]:
    """Where it happens and what may vary, a paragraph each."""
    places = "; ".join(dict.fromkeys(_place(playable) for playable in cases))
    sentence = "; ".join(f"{p.name} {_values(p)}" for p in scenario.parameters)
    return [*_paragraph("at", places), *_paragraph("with", sentence)]


def _paragraph(label: str, text: str) -> list[str]:
    """A label and a text beside it; nothing where there is no text."""
    indent = " " * 11
    return textwrap.wrap(text, WIDTH, initial_indent=f"      {label:<5}", subsequent_indent=indent) if text else []


def _in_full(scenario: type[Scenario], cases: list[Playable]) -> list[str]:
    """A line a parameter and a line a case."""
    return [
        *(f"      {p.name:<20} {_values(p):<32} {p.about}" for p in scenario.parameters),
        *(
            f"      {playable.case.name:<40} {_place(playable)}{_unread(playable)}{_unusual(playable)}"
            for playable in cases
        ),
    ]


def _unusual(playable: Playable) -> str:
    """The characteristics of a case that differ from a clear day on a dry straight street, as `--where` takes them."""
    usual, found = Characteristics().document(), characteristics_of(playable.case, playable.scenario).document()
    words = [f"{name}={value}" for name, value in found.items() if value != usual[name]]
    return f"; {', '.join(words)}" if words else ""


def _unread(playable: Playable) -> str:
    """Which values of its file have no effect."""
    return f" (not read: {', '.join(playable.unread)}, of ScenarioRunner's class)" if playable.unread else ""


def _place(playable: Playable) -> str:
    """Where a case is, in words."""
    case = playable.case
    place = case.place or f"({case.ego.pose.x_m:.0f}, {case.ego.pose.y_m:.0f}) of {case.town}"
    return f"{place}, on the route" if case.on_route else place


def _values(parameter: Parameter) -> str:
    """What a parameter may be; its default first."""
    if isinstance(parameter, Number):
        return f"{parameter.default:g} ({parameter.low:g} to {parameter.high:g}) {parameter.unit}".rstrip()
    return " | ".join(parameter.options)


def as_json(cases_by_type: Listed) -> dict[str, Any]:
    """Everything that is known of them."""
    return {
        "scenarios": [
            {
                "type": scenario.__name__,
                "name": snake(scenario.__name__),
                "group": scenario.group.value,
                "title": scenario.title(),
                "aliases": list(scenario.aliases),
                "parameters": [_parameter_as_json(parameter) for parameter in scenario.parameters],
                "cases": [_case_as_json(playable) for playable in cases],
            }
            for group in Group
            for scenario, cases in cases_by_type.items()
            if scenario.group is group
        ]
    }


def _parameter_as_json(parameter: Parameter) -> dict[str, Any]:
    """A number with its range, or a choice with its options."""
    sentence = {"name": parameter.name, "about": parameter.about, "unit": parameter.unit, "default": parameter.unsaid}
    if isinstance(parameter, Number):
        return {**sentence, "low": parameter.low, "high": parameter.high}
    return {**sentence, "options": list(parameter.options)}


def _case_as_json(playable: Playable) -> dict[str, Any]:
    """Where it is, with which values."""
    case = playable.case
    return {
        "id": case.name,
        "town": case.town,
        "place": case.place,
        "on_route": case.on_route,
        "values": dict(playable.values),
        "unread": list(playable.unread),
        "characteristics": characteristics_of(playable.case, playable.scenario).document(),
    }
