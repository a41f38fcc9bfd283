"""The examples of the tutorials work: the village builds without findings, and its route leads through its streets."""

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import linden.cli
from docs.pages import ROOT

VILLAGE = ROOT / "examples" / "maps" / "village.geojson"


def test_the_village_builds_without_findings_and_with_its_route(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    town, route = tmp_path / "Village.xodr", tmp_path / "village.xml"
    command = ["-m", "linden.authoring.streets", str(VILLAGE), "-o", str(town), "--route", f"round={route}"]
    subprocess.run([sys.executable, *command], check=True, cwd=ROOT)
    assert linden.cli.main(["map", "check", str(town)]) == 0
    assert "0 findings" in capsys.readouterr().out
    (found,) = ElementTree.parse(route).getroot().findall("route")
    assert found.get("town") == "Village"
    assert len(found.findall("waypoints/position")) > 10
    assert [stop.get("id") for stop in found.findall("stops/stop")] == ["S1"]


@pytest.mark.parametrize("name", ["first_agent.py", "stopping_agent.py"])
def test_the_agents_of_the_tutorial_load(name: str) -> None:
    code = f"from basu.agents.loader import load_agent; print(load_agent('examples/{name}').class_name)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.strip() == {"first_agent.py": "FirstAgent", "stopping_agent.py": "StoppingAgent"}[name]
