"""Claims about `linden map`: what it prints, what it writes, and how it ends."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from linden.cli import NOBODY_READS, main
from opendrive_texts import street_through_junction


@pytest.fixture
def good_map(tmp_path: Path) -> Path:
    file = tmp_path / "good.xodr"
    file.write_text(street_through_junction())
    return file


def test_check_of_a_good_map_ends_with_0_and_a_summary(good_map: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "check", str(good_map)]) == 0
    assert capsys.readouterr().out == f"{good_map}: 0 findings, 2 notes; --notes tells them\n"


def test_check_tells_notes_on_request(good_map: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "check", "--notes", str(good_map)]) == 0
    assert capsys.readouterr().out.startswith("note dead end road 1 s=0.00 (x=0.00, y=")


def test_check_of_a_bad_map_ends_with_1_and_tells_each_finding(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.xodr"
    file.write_text(street_through_junction().replace('x="70" y="0" hdg="0"', 'x="70" y="0.05" hdg="0"'))
    assert main(["map", "check", str(file)]) == 1
    *lines, summary = capsys.readouterr().out.splitlines()
    assert all(line.startswith("error gap road") for line in lines)
    assert summary.startswith(f"{file}: {len(lines)} findings")


@pytest.mark.parametrize("text", ["", "<OpenDRIVE>", "no map at all", "<svg/>"])
def test_a_file_that_is_no_map_ends_with_2_and_a_sentence(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "none.xodr"
    file.write_text(text)
    assert main(["map", "check", str(file)]) == 2
    assert capsys.readouterr().err.startswith(f"linden: {file}, line ")


def test_a_missing_file_is_refused_with_the_built_in_maps(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "info", "Atlantis"]) == 2
    told = capsys.readouterr().err
    assert "cannot read Atlantis: No such file or directory" in told
    assert "built-in map: Linden" in told


@pytest.mark.parametrize("name", ["Linden", "Linden.xodr"])
def test_a_built_in_map_is_known_by_its_name(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "info", name]) == 0
    assert "junctions" in capsys.readouterr().out


def test_info_names_the_places_of_linden(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "info", "Linden"]) == 0
    told = capsys.readouterr().out
    assert "Linden Transit Center, 50 m by 24 m, 8 m high" in told
    assert "railroad crossings       1" in told


def test_list_names_the_built_in_maps(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["map", "list"]) == 0
    assert capsys.readouterr().out.split() == ["Linden", "Linden_thesis"]


def test_export_writes_what_is_seen_as_gltf(good_map: Path, tmp_path: Path, capsys) -> None:
    scene = tmp_path / "map.glb"
    assert main(["map", "export", str(good_map), "-o", str(scene)]) == 0
    assert scene.read_bytes()[:4] == b"glTF"
    assert "triangles" in capsys.readouterr().out


def test_show_writes_a_picture(good_map: Path, tmp_path: Path) -> None:
    picture = tmp_path / "map.svg"
    assert main(["map", "show", str(good_map), "-o", str(picture)]) == 0
    assert picture.read_text().startswith("<svg")


def test_a_picture_that_cannot_be_written_gets_a_sentence(
    good_map: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["map", "show", str(good_map), "-o", str(tmp_path / "no" / "map.svg")]) == 2
    assert "name a file in a folder that exists" in capsys.readouterr().err


def test_streets_that_are_no_geojson_get_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    streets = tmp_path / "streets.geojson"
    streets.write_text("{")
    assert main(["map", "build", str(streets), "-o", str(tmp_path / "map.xodr")]) == 2
    assert "is no GeoJSON" in capsys.readouterr().err


STREETS = """{"type": "FeatureCollection", "metadata": {"name": "Town", "origin": [-83.0, 40.0]}, "features": [
{"type": "Feature", "geometry": {"type": "LineString", "coordinates": [[-83.0, 40.0], [-82.998, 40.0]]},
 "properties": {"feature": "street", "id": "east", "name": "East Street", "street_class": "local", "lanes": 2,
 "width_m": 8.0, "speed_limit_mph": 25, "oneway": "no", "parking": "none", "sidewalk": "both",
 "confidence": "estimated"}},
{"type": "Feature", "geometry": {"type": "LineString", "coordinates": [[-83.0, 40.0], [-82.998, 40.0]]},
 "properties": {"feature": "route", "id": "there", "name": "There", "stops": [], "closed": false}}]}"""


@pytest.mark.parametrize(
    ("option", "code", "said"),
    [
        (["--route", "there={file}"], 0, "there.xml: "),
        ([], 0, "not written: there; `--route there=FILE.xml` writes a route feature"),
        (["--route", "ther={file}"], 2, "the streets have no route 'ther'; did you mean 'there'?"),
        (["--route", "there"], 2, "give the name of a route feature and a file"),
    ],
)
def test_a_route_feature_becomes_a_route_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: list[str], code: int, said: str
) -> None:
    streets, file = tmp_path / "streets.geojson", tmp_path / "there.xml"
    streets.write_text(STREETS)
    words = [word.format(file=file) for word in option]
    assert main(["map", "build", str(streets), "-o", str(tmp_path / "Town.xodr"), *words]) == code
    assert said in "".join(capsys.readouterr())
    assert file.exists() == (code == 0 and bool(option))


def test_a_closed_output_ends_it_quietly(good_map: Path) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        ended = subprocess.run(
            [sys.executable, "-m", "linden.cli", "map", "info", str(good_map)],
            stdout=writer,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    finally:
        os.close(writer)
    assert (ended.returncode, ended.stderr) == (NOBODY_READS, "")
