"""A service amid SUMO's traffic: the same bytes again, persons conserved, totals as in SUMO's own files."""

import json
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from basu.records.history.sumo import read_sumo
from basu_fixtures import BASU
from basu_service.document import read_service

pytest.importorskip("sumo", reason="the extra for SUMO is not installed")

SAME = (
    "service.json",
    "service.html",
    "history.parquet",
    "shuttle_2/history.parquet",
    "sumo.json",
    "sumo/tripinfo.xml",
    "sumo/summary.xml",
    "sumo/collisions.xml",
)
MINUTES, SHUTTLES = 0.5, 2
STEP_S = 0.05
DEMAND = {
    "schema_version": 1,
    "stops": {"S1": {"rates": [{"from": "06:00", "to": "20:00", "per_hour": 1500}], "to": {"S4": 1}}},
    "patience_min": 20,
}


@pytest.fixture(scope="module")
def demand(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A demand with a person every few seconds at the first stop."""
    path = tmp_path_factory.mktemp("demand") / "busy.json"
    path.write_text(json.dumps(DEMAND), encoding="utf-8")
    return path


def drive(output: Path, demand: Path) -> Path:
    """Drive a service and return its folder.

    It has a server of its own, because SUMO's files name actors by their ids. It has a process of its own, because
    libsumo keeps the vehicles of its first simulation that have a device for safety measures.
    """
    words = ["service", "run", "basic", "--minutes", str(MINUTES), "--demand", str(demand), "--no-holding"]
    words += ["--sumo", "demand", "--sumo-scale", "3", "--sumo-output", "--seed", "4", "--step-limit", "120"]
    done = subprocess.run([*BASU, *words, "--output", str(output)], capture_output=True, text=True, check=False)
    assert done.returncode in {0, 1}, done.stderr
    return output / "latest"


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bytes_and_sumo_s_totals(demand: Path, tmp_path: Path) -> None:
    first, again = drive(tmp_path / "one", demand), drive(tmp_path / "two", demand)
    for name in SAME:
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    persons = read_service(first)["persons"]
    assert persons["came"] > 0
    assert persons["came"] == sum(persons[name] for name in ("carried", "riding", "stranded", "waiting", "gave_up"))
    ours = read_sumo(first)
    assert ours is not None
    trips = [each.attrib for each in ET.parse(first / "sumo" / "tripinfo.xml").getroot().findall("tripinfo")]
    shuttles = [each for each in trips if each["id"].startswith("carla")]
    others = [each for each in trips if each not in shuttles]
    assert len(shuttles) == SHUTTLES
    assert ours.departed == len(others) > 50
    assert ours.arrived == sum(float(each["arrival"]) >= 0.0 for each in others) > 0
    summary = [each.attrib for each in ET.parse(first / "sumo" / "summary.xml").getroot()]
    running = {round(float(each["time"]), 2): int(each["running"]) for each in summary}
    for second in ours.seconds:  # a line of SUMO bears the time of its step's beginning; one may come or go in a step
        assert abs(running[round(second.t_s - STEP_S, 2)] - SHUTTLES - second.vehicles) <= 1
    driven_m = sum(float(each["routeLength"]) for each in others)
    left_m = driven_m - sum(each.driven_m for each in ours.seconds)  # since the last second that was noted
    assert 0.0 <= left_m < 1.5 * ours.seconds[-1].driven_m
