"""Claims of ASAM's checker of OpenDRIVE about every kind of map that is built or shipped here."""

import json
from collections.abc import Callable
from importlib import resources
from pathlib import Path

import pytest

from fakes import asam, osm_forks
from fakes.osm_quarter import quarter
from linden_maps.openstreetmap.convert import convert
from linden_maps.streets.build import assembled, build
from linden_maps.streets.geojson import read
from linden_maps.streets.writing import text

EXAMPLES = Path(__file__).parents[4] / "examples" / "maps"


def shipped(name: str) -> bytes:
    return (resources.files("linden") / "data" / name).read_bytes()


def of_extract(data: bytes) -> bytes:
    return text(assembled(read(convert(data, "extract.osm").streets)).document)


def village() -> dict[str, object]:
    return json.loads((EXAMPLES / "village.geojson").read_text("utf-8"))


def in_kmh() -> bytes:
    streets = json.dumps(village()).replace('"speed_limit_mph": 25', '"speed_limit_kmh": 42.5')
    assert "kmh" in streets
    return build(json.loads(streets))


MAPS: dict[str, Callable[[], bytes]] = {
    "Linden": lambda: shipped("Linden.xodr"),
    "Linden of the thesis": lambda: shipped("Linden_thesis.xodr"),
    "village": lambda: build(village()),
    "village in km/h, with a fraction": in_kmh,
    "quarter": lambda: of_extract(quarter().text()),
    "fork": lambda: of_extract(osm_forks.fork(11.0)),
    "star": lambda: of_extract(osm_forks.star(range(0, 360, 40))),
    "carriageways": lambda: of_extract(osm_forks.joining_carriageways(15.0, 60.0)),
    "mapped twice": lambda: of_extract(osm_forks.mapped_twice()),
    **{f"tangle {seed}": lambda seed=seed: of_extract(osm_forks.tangle(seed)) for seed in range(8)},
}


@pytest.mark.parametrize("name", MAPS)
def test_asams_checker_finds_nothing_wrong(name: str) -> None:
    assert asam.issues(MAPS[name]()) == []


def test_asams_checker_finds_what_is_wrong() -> None:
    wrong = build(village()).replace(b'max="25"', b'max="31.069"')
    assert any(one.startswith("check_asam_xodr_xml_valid_schema") for one in asam.issues(wrong))
