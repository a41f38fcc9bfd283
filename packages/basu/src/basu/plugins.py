"""Plugins: distributions that bring commands, agents, outputs and more, which their entry points name, as for pytest.

A plugin acts where it is installed; nothing has to be configured. Each group says beside its constant what its entry
points name. docs/how-to/plugins.md shows a plugin. ``DISTRIBUTIONS`` names the plugins of this project, so that a
missing one is named with its ``pip install``.
"""

from __future__ import annotations

import functools
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

COMMANDS = "basu.commands"  # a `Command`
AGENTS = "basu.agents"  # the class of an agent
AGENT_FILES = "basu.agent_files"  # a `basu.agents.agent_files.AgentFiles`: reads agents' files of other programs
SCENARIO_FILES = "basu.scenario_files"  # by the suffix of the file's name: a `basu.scenarios.cases.ScenarioReader`
OUTPUTS = "basu.outputs"  # a `basu.running.outputs.Output`: shows or writes a drive while it lasts
PARTS = "basu.parts"  # the parts of the benchmark that this project's plugins bring; each caller knows its own

DISTRIBUTIONS = {
    COMMANDS: {
        "leaderboard": "basu-leaderboard",
        "metrics": "basu-carla-log",
        "replay": "basu-carla-log",
        "ros": "basu-ros",
        "serve": "basu-alpasim",
        "service": "basu-service",
        "sumo": "basu-sumo",
        "truth": "basu-truth",
        "watch": "basu-window",
    },
    AGENTS: {**dict.fromkeys(("autoware", "autoware-ai", "ros", "ros1"), "basu-ros"), "egodriver": "basu-alpasim"},
    AGENT_FILES: {"leaderboard": "basu-leaderboard"},
    SCENARIO_FILES: {"xosc": "basu-openscenario"},
    OUTPUTS: {"window": "basu-window", "ros": "basu-ros"},
    PARTS: {
        "person": "basu-window",
        "scenario_export": "basu-openscenario",
        "search": "basu-search",
        "sumo": "basu-sumo",
    },
}
"""The plugins of this project: group -> name of the entry point -> distribution."""


class Command(NamedTuple):
    """A command of ``basu`` that a plugin brings: a line of help, and what adds the arguments to its parser."""

    help: str
    add: Callable[[argparse.ArgumentParser], None]


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
        group: one of the groups above.
        name: the name of the entry point.
        what: what needs it, for the user: ``--watch``.

    Raises:
        UserError: no plugin brings it.
    """
    if not is_installed(group, name):
        raise UserError(missing(group, name, what))
    return offered(group)[name].load()
