"""Claims about a service amid SUMO's traffic: the same bytes again, persons conserved, totals as in SUMO's own files."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from basu.cli import main
from basu.records.history.sumo import read_sumo
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
MINUTES = 0.5
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
    """Drive a service in a world of its own; return its folder."""
    words = ["service", "run", "basic", "--minutes", str(MINUTES), "--demand", str(demand), "--no-holding"]
    words += ["--sumo", "demand", "--sumo-scale", "3", "--sumo-output", "--seed", "4", "--output", str(output)]
    assert main(words) in {0, 1}
    return output / "latest"


@pytest.mark.slow
@pytest.mark.usefixtures("one_server")
def test_the_same_seed_gives_the_same_bytes_and_sumo_s_totals(demand: Path, tmp_path: Path) -> None:
    first, again = drive(tmp_path / "one", demand), drive(tmp_path / "two", demand)
    for name in SAME:
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    persons = read_service(first)["persons"]
    assert persons["came"] > 0
    assert persons["came"] == sum(persons[name] for name in ("carried", "riding", "stranded", "waiting", "gave_up"))
    ours = read_sumo(first)
    assert ours is not None
    trips = ET.parse(first / "sumo" / "tripinfo.xml").getroot().findall("tripinfo")
    print(
        ours.departed,
        ours.arrived,
        ours.delayed,
        ours.hidden,
        ours.people,
        ours.contacts,
        ours.seconds[-2:],
        [t.attrib for t in trips][:4],
        len(trips),
        (first / "sumo" / "summary.xml").read_text()[-900:],
    )
