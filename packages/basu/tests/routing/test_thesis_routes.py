"""The routes of Linden without traffic lights: those of Linden, with their scenarios and stops."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import basu.routes
from basu.cli import main
from basu.routing.route_file import read_routes

ROUTES = Path(basu.routes.__path__[0])
pytestmark = pytest.mark.slow  # the second test drives


@pytest.mark.parametrize(("route_id", "of"), [("0", "linden_leap.xml"), ("1", "linden_scenarios.xml")])
def test_each_route_is_that_of_linden_in_the_town_without_lights(route_id: str, of: str) -> None:
    (ours,) = (route for route in read_routes(ROUTES / "linden_thesis.xml") if route.id == route_id)
    (theirs,) = read_routes(ROUTES / of)
    assert ours.town == "Linden_thesis"
    assert replace(ours, town=theirs.town, source=theirs.source) == theirs


@pytest.mark.usefixtures("one_server")
def test_the_short_route_is_driven_to_its_end(tmp_path: Path) -> None:
    words = ["run", "basic", "--routes", "routes/linden_thesis.xml", "--route-id", "1", "--no-scenarios"]
    assert main([*words, "--output", str(tmp_path)]) == 0
    result = json.loads((tmp_path / "latest" / "result.json").read_text(encoding="utf-8"))
    assert (result["status"], result["scores"]["driving"]) == ("Completed", pytest.approx(1.0, abs=0.01))
    assert result["meta"]["town"] == "Linden_thesis"
