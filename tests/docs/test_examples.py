"""The examples of the tutorials work: the village builds without findings, and its route leads through its streets."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import linden.cli
from basu.agents.loader import load_agent
from docs.pages import ROOT

VILLAGE = ROOT / "examples" / "maps" / "village.geojson"


def test_the_village_builds_without_findings_and_with_its_route(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    town, route = tmp_path / "Village.xodr", tmp_path / "village.xml"
    assert linden.cli.main(["map", "build", str(VILLAGE), "-o", str(town), "--route", f"round={route}"]) == 0
    assert linden.cli.main(["map", "check", str(town)]) == 0
    assert "0 findings" in capsys.readouterr().out
    (found,) = ET.parse(route).getroot().findall("route")
    assert found.get("town") == "Village"
    assert len(found.findall("waypoints/position")) > 10
    assert [stop.get("id") for stop in found.findall("stops/stop")] == ["S1"]


@pytest.mark.parametrize("name", ["first_agent.py", "stopping_agent.py"])
def test_the_agents_of_the_tutorial_load(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    found = load_agent(f"examples/{name}").class_name
    assert found == {"first_agent.py": "FirstAgent", "stopping_agent.py": "StoppingAgent"}[name]
