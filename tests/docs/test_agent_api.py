"""The page Agent API has each public attribute and method of the base class, with a type, a meaning and a unit."""

import inspect
import re

from basu.agents.autonomous_agent import AutonomousAgent
from docs.pages import ROOT

PAGE = (ROOT / "docs/reference/agent-api.md").read_text("utf-8")
INTERNAL = {"bind", "bind_sensors"}  # BASU's own


def test_each_public_attribute_has_a_row_with_a_meaning() -> None:
    attributes = [name for name in AutonomousAgent.__annotations__ if not name.startswith("_")]
    assert len(attributes) > 8
    rows = dict(re.findall(r"^\| `self\.(\w+)` \| `[^`]+` \| (.+) \|$", PAGE, re.MULTILINE))
    assert sorted(rows) == sorted(attributes)
    assert all(len(meaning) > 20 for meaning in rows.values())


def test_each_public_method_has_a_section() -> None:
    methods = {name for name, _ in inspect.getmembers(AutonomousAgent, callable) if not name.startswith("_")}
    sections = set(re.findall(r"^### `(\w+)` \((?:to implement|optional|to call)\)$", PAGE, re.MULTILINE))
    assert sections == methods - INTERNAL


def test_each_field_of_the_route_has_a_meaning() -> None:
    for mark in ("route", "control", "stop", "other"):
        table = re.search(rf"<!-- {mark} -->(.*?)<!-- /{mark} -->", PAGE, re.DOTALL)
        assert table is not None
        rows = re.findall(r"^\| `(\w+)` \| `.+?` \| (.*?) ?\|$", table[1], re.MULTILINE)
        assert rows
        assert not [name for name, meaning in rows if not meaning], mark
