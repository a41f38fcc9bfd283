"""Scenario classes out of Python files: those that come with BASU, and a user's own with what goes wrong in it."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import traceback
from pathlib import Path
from types import ModuleType

from basu.errors import ScenarioError
from basu.scenarios import library as catalogue
from basu.scenarios.declaration import check_class
from basu.scenarios.scenario import Scenario
from basu.utils.user_module import module_of


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
        raise ScenarioError(f"{path} holds no subclass of Scenario; see docs/scenarios.md for how one looks")
    for scenario in found:
        check_class(scenario, str(path))
    return found


def _scenarios_in(module: ModuleType) -> list[type[Scenario]]:
    """Those that a module defines itself, without what is there to be derived from only."""
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
