"""Plugins: distributions that bring readers of scenario files, which their entry points name, as for pytest.

A plugin acts where it is installed; nothing has to be configured. ``DISTRIBUTIONS`` names the plugins of this project,
so that a missing one is named with its ``pip install``.
"""

from __future__ import annotations

import functools
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from basu.errors import UserError

SCENARIO_FILES = "basu.scenario_files"  # by the suffix of the file's name: a `basu.scenarios.cases.ScenarioReader`

DISTRIBUTIONS = {SCENARIO_FILES: {"xosc": "basu-openscenario"}}
"""The plugins of this project: group -> name of the entry point -> distribution."""


@functools.cache
def offered(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by their names, as they are installed; none is imported."""
    return {each.name: each for each in sorted(entry_points(group=group), key=lambda each: each.name)}


def is_installed(group: str, name: str) -> bool:
    """Return whether a plugin brings this; it is not imported."""
    return name in offered(group)


def missing(group: str, name: str, what: str) -> str:
    """Return the sentence for a user without a plugin of this project; ``what`` is what needs it."""
    distribution = DISTRIBUTIONS[group][name]
    return f"{what} needs {distribution}, which is not installed; install it with: pip install {distribution}"


def load(group: str, name: str, what: str) -> Any:  # noqa: ANN401 - whatever the entry point names
    """Return what an entry point names, imported.

    Args:
        group: the group of entry points.
        name: the name of the entry point.
        what: what needs it, for the user: ``a file x.xosc``.

    Raises:
        UserError: no plugin brings it.
    """
    if not is_installed(group, name):
        raise UserError(missing(group, name, what))
    return offered(group)[name].load()
