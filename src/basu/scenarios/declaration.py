"""Whether a scenario's class declares itself well: its group, parameters, weather, and that nothing is missing."""

from __future__ import annotations

import difflib
import inspect
import math
import re
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.routing.route_weather import WEATHER_FIELDS
from basu.scenarios.config.read import RESERVED
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.scenario import Scenario

OPTION = re.compile(r"[A-Za-z0-9._+-]+")  # of a choice: it stands in ids, between ':', ',' and '='


def check_class(scenario: type[Scenario], where: str) -> None:
    """Pass a class that can be listed, sampled and made; ``where`` it comes from, for sentences.

    Raises:
        ScenarioError: it lacks a method or its group, or a declaration cannot be used.
    """
    named = f"the scenario {scenario.__name__} in {where}"
    if inspect.isabstract(scenario):
        missing = ", ".join(sorted(scenario.__abstractmethods__))
        raise ScenarioError(f"{named} lacks {missing}; a scenario has trigger, conflict and criteria")
    if not isinstance(getattr(scenario, "group", None), Group):
        raise ScenarioError(f"{named} names no group; write `group = Group.PEDESTRIAN`, or whichever of Group it is in")
    if isinstance(scenario.aliases, str):  # which is a sequence too, of letters
        raise ScenarioError(f"{named} has aliases = '{scenario.aliases}', a text; write ('{scenario.aliases}',)")
    for field in scenario.weather:
        if field not in WEATHER_FIELDS:
            close = difflib.get_close_matches(field, WEATHER_FIELDS, 1) or WEATHER_FIELDS
            raise ScenarioError(f"{named} has the weather '{field}', which weather does not have; use {close[0]}")
    if not (scenario.timeout_s > 0.0 and scenario.needs_m >= 0.0):
        raise ScenarioError(
            f"{named} has timeout_s {scenario.timeout_s:g} and needs_m {scenario.needs_m:g}; both count up"
        )
    _check_parameters(scenario.parameters, named)


def _check_parameters(parameters: Sequence[Parameter], named: str) -> None:
    """Each has a name of its own and can be what it says."""
    seen: set[str] = set()
    for parameter in parameters:
        if not isinstance(parameter, Number | Choice):
            raise ScenarioError(f"{named} has {parameter!r} among its parameters, which is no Number and no Choice")
        told = f"{named} has the parameter '{parameter.name}'"
        if not re.fullmatch(r"[a-z][a-z0-9_]*", parameter.name) or parameter.name in RESERVED:
            raise ScenarioError(f"{told}; it must be a word in snake case that is no element of a case's XML")
        if parameter.name in seen:
            raise ScenarioError(f"{told} twice; name one otherwise")
        seen.add(parameter.name)
        if isinstance(parameter, Number):
            _check_number(parameter, told)
        else:
            _check_choice(parameter, told)


def _check_number(number: Number, told: str) -> None:
    """A range with the default in it."""
    if not (math.isfinite(number.low) and math.isfinite(number.high) and number.low < number.high):
        raise ScenarioError(f"{told} from {number.low:g} to {number.high:g}; the range must go up and end")
    if not number.low <= number.default <= number.high:
        raise ScenarioError(
            f"{told} with default {number.default:g}, which is outside {number.low:g} to {number.high:g}"
        )


def _check_choice(choice: Choice, told: str) -> None:
    """Two words or more, each once, that can stand in an id."""
    if len(set(choice.options)) != len(choice.options) or len(choice.options) < 2:
        raise ScenarioError(f"{told} with options {choice.options!r}; it needs two different words or more")
    for option in choice.options:
        if not OPTION.fullmatch(option):
            raise ScenarioError(
                f"{told} with the option '{option}'; letters, digits, '.', '_', '+' and '-' may stand in it"
            )
