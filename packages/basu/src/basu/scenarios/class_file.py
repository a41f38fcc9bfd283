"""Scenario classes from Python files, BASU's own and a user's, and the check of their declarations."""

from __future__ import annotations

import difflib
import importlib
import inspect
import math
import pkgutil
import re
import traceback
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.files import module_of
from basu.routing.weather import WEATHER_FIELDS
from basu.scenarios import library as catalogue
from basu.scenarios.case_xml import RESERVED
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.scenarios.parameters import Parameter


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
        subject = f"{named} has the parameter '{parameter.name}'"
        if not re.fullmatch(r"[a-z][a-z0-9_]*", parameter.name) or parameter.name in RESERVED:
            raise ScenarioError(f"{subject}; it must be a word in snake case that is no element of a case's XML")
        if parameter.name in seen:
            raise ScenarioError(f"{subject} twice; name one otherwise")
        seen.add(parameter.name)
        if isinstance(parameter, Number):
            _check_number(parameter, subject)
        else:
            _check_choice(parameter, subject)


def _check_number(number: Number, subject: str) -> None:
    """A range with the default in it."""
    if not (math.isfinite(number.low) and math.isfinite(number.high) and number.low < number.high):
        raise ScenarioError(f"{subject} from {number.low:g} to {number.high:g}; the range must go up and end")
    if not number.low <= number.default <= number.high:
        raise ScenarioError(
            f"{subject} with default {number.default:g}, which is outside {number.low:g} to {number.high:g}"
        )


def _check_choice(choice: Choice, subject: str) -> None:
    """Two words or more, each once, that can stand in an id."""
    if len(set(choice.options)) != len(choice.options) or len(choice.options) < 2:
        raise ScenarioError(f"{subject} with options {choice.options!r}; it needs two different words or more")
    for option in choice.options:
        if not OPTION.fullmatch(option):
            raise ScenarioError(
                f"{subject} with the option '{option}'; letters, digits, '.', '_', '+' and '-' may stand in it"
            )


def own_scenarios() -> list[type[Scenario]]:
    """Every scenario of ``basu.scenarios.library``, by its name in alphabetical order.

    Raises:
        ScenarioError: one declares itself badly.
    """
    names = [module.name for module in pkgutil.walk_packages(catalogue.__path__, catalogue.__name__ + ".")]
    modules = [importlib.import_module(name) for name in names]  # all first: a base is known by its subclasses
    found = [scenario for module in modules for scenario in _scenarios_in(module)]
    for scenario in found:
        check_class(scenario, scenario.__module__)
    return sorted(found, key=lambda scenario: scenario.__name__)


def users_scenarios(path: Path) -> list[type[Scenario]]:
    """Every scenario that a user's file defines, in its order.

    Raises:
        ScenarioError: the file is missing, does not load, or defines none that can be played.
    """
    if path.suffix != ".py":
        raise ScenarioError(f"{path} is no Python file; scenario classes are in FILE.py")
    if not path.is_file():
        raise ScenarioError(f"the scenario file {path} does not exist; check the name and the folder you are in")
    found = _scenarios_in(_executed(path))
    if not found:
        raise ScenarioError(f"{path} holds no subclass of Scenario; see docs/reference/scenarios.md for how one looks")
    for scenario in found:
        check_class(scenario, str(path))
    return found


def _scenarios_in(module: ModuleType) -> list[type[Scenario]]:
    """Scenario classes that a module defines itself, without what is there to be derived from only."""
    return [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, Scenario)
        and value.__module__ == module.__name__
        and not _is_base(value)
    ]


def _is_base(scenario: type[Scenario]) -> bool:
    """Whether a class is there to be derived from: it has subclasses, and is abstract or has no parameters."""
    return bool(scenario.__subclasses__()) and (inspect.isabstract(scenario) or not scenario.parameters)


def _executed(path: Path) -> ModuleType:
    """The file as a module."""
    module, loader = module_of(path.resolve(), f"basu_scenario_{path.stem}")
    try:
        loader.exec_module(module)
    except SyntaxError as error:
        raise ScenarioError(f"the scenario file {path} is no Python: line {error.lineno}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == module.__file__]
        line = f"line {lines[-1]}: " if lines else ""
        raise ScenarioError(f"the scenario file {path} does not load: {line}{type(error).__name__}: {error}") from error
    return module
