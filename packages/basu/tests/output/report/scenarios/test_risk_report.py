"""Claims about the risk report: from a run's folder to text, JSON and page."""

import json
from pathlib import Path
from typing import Any

from basu.output.report.scenarios.risk_report import PAGE_FILE, RISK_FILE, figure, risk_text, risks_of, write_risks


def matrix(folder: Path) -> dict[str, Any]:
    """A run of two cases with one agent: a pedestrian was hit, and a dog was not."""
    cases = []
    for name, scenario, group, partner, hit in (
        ("pedestrian_crossing_1", "PedestrianCrossing", "pedestrian", "walker", True),
        ("dog_on_the_road_1", "DogOnTheRoad", "animal", "animal", False),
    ):
        left = folder / "mine" / name
        left.mkdir(parents=True)
        (left / "result.json").write_text(json.dumps({"passengers": {"largest": {"braking_mps2": 3.0}}}))
        cell = {
            "verdict": "FAILURE" if hit else "SUCCESS",
            "message": "",
            "margins": {},
            "collisions": [{"speed_mps": 6.0, "at_fault": True}] if hit else [],
            "assessment": {"completed": {"holds": True, "sentence": "arrives"}},
            "folder": f"mine/{name}",
        }
        about = {"id": name, "scenario": scenario, "group": group, "characteristics": {"partner": partner}}
        cases.append({**about, "pre_crash": [], "results": {"mine": cell}})
    return {"agents": ["mine"], "cases": cases}


def test_a_runs_folder_gets_json_and_a_page_and_the_groups_without_a_case_are_named(tmp_path: Path) -> None:
    found = risks_of(tmp_path, matrix(tmp_path), {})
    write_risks(tmp_path, found)
    rates = json.loads((tmp_path / RISK_FILE).read_text(encoding="utf-8"))["mine"]["rates"]
    assert rates["crashes"]["value"] == 26 / 1000 * 830 / 12  # every conflict with a pedestrian
    assert rates["severe injuries on foot"]["value"] > 0.0
    assert rates["deaths of occupants"]["value"] == 0.0
    assert rates["falls of a standing passenger"]["value"] > 0.0
    page = (tmp_path / PAGE_FILE).read_text(encoding="utf-8")
    assert "Not played: control loss" in page
    text = "\n".join(risk_text(found))
    assert "2 of 9 groups played" in text
    assert "their risk is not in it" in text


def test_figures_have_three_digits_and_small_ones_are_below_a_limit() -> None:
    assert (figure(128.4), figure(0.01234), figure(1e-9), figure(0.0)) == ("128", "0.0123", "below 0.001", "0")
