"""A class name means one thing within a distribution."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # reads all sources and runs none of them, so it measures no coverage
ROOT = Path(__file__).parents[1]
OF_OTHERS = {"basu-leaderboard": {"AutonomousAgent"}}
"""Agents of the leaderboard and of ScenarioRunner import these base classes by name, each from its own module."""


def classes_by_name(source: Path) -> dict[str, list[str]]:
    """Return the places of the classes below a folder of sources, nested classes too, by name."""
    places = defaultdict(list)
    for path in sorted(source.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(f"{path.relative_to(source)}:{node.lineno}")
    return places


@pytest.mark.parametrize("source", sorted(ROOT.glob("packages/*/src")), ids=lambda source: source.parent.name)
def test_no_two_classes_of_a_distribution_have_one_name(source: Path) -> None:
    allowed = OF_OTHERS.get(source.parent.name, set())
    places = classes_by_name(source)
    assert {name: found for name, found in places.items() if len(found) > 1 and name not in allowed} == {}
    assert all(len(places[name]) > 1 for name in allowed), "the list names a class that has its name alone"
