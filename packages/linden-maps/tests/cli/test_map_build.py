"""Claims about `linden map build` with an OpenStreetMap extract: what it writes, tells and refuses."""

import json
from pathlib import Path

import pytest

from fakes.osm_quarter import Drawing
from linden.cli import main

ROOT = Path(__file__).parents[4]


@pytest.fixture
def extract(tmp_path: Path) -> Path:
    """Two streets that cross, one building beside them, and one over a street."""
    draw = Drawing()
    draw.way(1, (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0), highway="residential", name="A", maxspeed="30")
    draw.way(2, (0.0, -100.0), (0.0, 0.0), (0.0, 100.0), highway="residential", name="B")
    draw.building(3, (20.0, 20.0), (30.0, 20.0), (30.0, 30.0), (20.0, 30.0))
    draw.building(4, (50.0, -4.0), (60.0, -4.0), (60.0, 4.0), (50.0, 4.0))
    file = tmp_path / "small.osm"
    file.write_bytes(draw.text())
    return file


def test_the_map_and_its_facts_are_written_and_guesses_are_counted(
    extract: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, facts = tmp_path / "Small.xodr", tmp_path / "small.geojson"
    assert main(["map", "build", str(extract), "-o", str(out), "--facts", str(facts)]) == 0
    told = capsys.readouterr().out
    assert "2 building, 1 intersection, 4 street" in told
    assert "street speed limit            2 tagged      2 guessed" in told
    assert "left out: 1 buildings or things that would stand on a street" in told
    assert main(["map", "check", str(out)]) == 0
    again = tmp_path / "again.xodr"
    assert json.loads(facts.read_text())["metadata"]["licence"].startswith("Map data from OpenStreetMap")
    assert main(["map", "build", str(facts), "-o", str(again)]) == 0
    assert again.read_bytes() == out.read_bytes()


def test_the_extract_that_comes_with_the_project_is_built_as_its_guide_has_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    extract, out = ROOT / "examples" / "maps" / "quarter.osm", tmp_path / "Quarter.xodr"
    guide = (ROOT / "docs" / "how-to" / "maps-import.md").read_text()
    assert "linden map build examples/maps/quarter.osm -o Quarter.xodr --facts quarter.geojson" in guide
    assert "pip install 'linden-maps[elevation]'" in guide
    assert main(["map", "build", str(extract), "-o", str(out), "--facts", str(tmp_path / "quarter.geojson")]) == 0
    assert main(["map", "check", str(out)]) == 0
    assert "warning" not in capsys.readouterr().out


def test_an_older_map_stays_where_the_extract_is_broken(
    extract: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "Small.xodr"
    out.write_text("older")
    extract.write_bytes(extract.read_bytes()[:-40])
    assert main(["map", "build", str(extract), "-o", str(out)]) == 2
    assert f"{extract}, line " in capsys.readouterr().err
    assert out.read_text() == "older"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["Small.xodr", "small.osm"]


def test_facts_are_those_of_an_extract(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["map", "build", "-o", str(tmp_path / "x.xodr"), "--facts", str(tmp_path / "x.geojson")]
    assert main(words) == 2
    assert "--facts writes the streets of an OpenStreetMap extract" in capsys.readouterr().err
