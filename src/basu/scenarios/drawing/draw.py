"""A scenario's tree before a run, in the form that is asked for."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from basu.scenarios.drawing.nodes import tree_of
from basu.scenarios.drawing.svg import as_svg
from basu.scenarios.drawing.text import as_dot, as_text
from basu.scenarios.tree import compose

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu.scenarios.drawing.nodes import TreeNode
    from basu.scenarios.scenario import Scenario

FORMS: dict[str, Callable[[TreeNode], str]] = {
    "text": as_text,
    "ascii": lambda tree: as_text(tree, plain=True),
    "svg": as_svg,
    "dot": as_dot,
    "json": lambda tree: json.dumps(tree, indent=2, ensure_ascii=False),
}


def draw(scenario: Scenario, form: str = "text") -> str:
    """The tree of a scenario at its place, with its criteria; ``form`` is one of ``FORMS``.

    Raises:
        ScenarioError: the scenario asks its place for what is not there.
    """
    return FORMS[form](tree_of(compose(scenario), criteria=scenario.criteria()))
