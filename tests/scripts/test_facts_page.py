"""The page of Linden's facts: each value with a confidence is counted, by the scale of the file."""

import importlib.util
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """Return the script as a module."""
    spec = importlib.util.spec_from_file_location("make_facts_page", ROOT / "scripts" / "make_facts_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def document(script: ModuleType) -> dict[str, Any]:
    """Return the facts."""
    found: dict[str, Any] = json.loads(script.FACTS.read_text(encoding="utf-8"))
    return found


def test_each_confidence_of_the_file_is_in_the_table(script: ModuleType, document: dict[str, Any]) -> None:
    counted = {(fact.feature, fact.confidence) for fact in script.FACTS_OF_MAP}
    for each in document["features"]:
        properties = each["properties"]
        if properties["feature"] == "route_alternative":
            continue  # a course that no map has
        for name in properties:
            if name.endswith("confidence"):
                assert (properties["feature"], name) in counted, name


def test_only_directions_and_surfaces_have_no_origin(script: ModuleType, document: dict[str, Any]) -> None:
    found = {fact.title for fact in script.FACTS_OF_MAP if script.counts(document, fact)[script.UNSAID]}
    assert found == {"one-way streets", "surfaces"}


def test_a_word_that_is_not_of_the_scale_is_an_error(script: ModuleType) -> None:
    fact = next(each for each in script.FACTS_OF_MAP if each.value == "lanes")
    assert script.origin_of(fact, {"lanes": 2, "lanes_confidence": "one source (records: 2)"}) == script.READ
    assert script.origin_of(fact, {"lanes": 2}) == script.UNSAID
    with pytest.raises(ValueError, match="'surely' is no word of the scale"):
        script.origin_of(fact, {"id": "x", "lanes": 2, "lanes_confidence": "surely"})
