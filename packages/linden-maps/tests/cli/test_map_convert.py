"""Bad input and bad places: one sentence, and nothing half-written."""

import os
from pathlib import Path

import pytest

from linden.cli import main
from linden_maps import output
from vector_map_town import document, lane, road, two_roads


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "small.xodr"
    path.write_text(two_roads())
    return path


def _fails(capsys, *words):
    assert main(["map", *map(str, words)]) != 0
    told = capsys.readouterr().err.strip()
    assert told.startswith("linden: ")
    assert "\n" not in told
    return told


def test_convert_then_check_then_show(tmp_path, source, capsys):
    target = tmp_path / "small.osm"
    assert main(["map", "convert", str(source), "-o", str(target)]) == 0
    assert (tmp_path / "map_projector_info.yaml").read_text() == "projector_type: Local\n"
    assert main(["map", "check", str(target), "--against", str(source)]) == 0
    told = capsys.readouterr().out
    assert "6 road" in told.replace("lanelet road", "road")
    assert "3 pairs of driving lanes lead into each other in both maps" in told
    assert main(["map", "show", str(target), "--over", str(source), "-o", str(tmp_path / "small.svg")]) == 0
    drawn = (tmp_path / "small.svg").read_text()
    assert '<g id="road"' in drawn
    assert '<g id="directions"' in drawn


def test_aisan_from_both_sources_is_the_same_folder(tmp_path, source):
    assert main(["map", "convert", str(source), "--walkways", "-o", str(tmp_path / "small.osm")]) == 0
    assert main(["map", "convert", str(source), "-o", str(tmp_path / "one")]) == 0
    assert main(["map", "convert", str(tmp_path / "small.osm"), "-o", str(tmp_path / "two")]) == 0
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "two").iterdir())
    differ = [n for n in names if (tmp_path / "one" / n).read_bytes() != (tmp_path / "two" / n).read_bytes()]
    assert differ == ["point.csv"]  # a Lanelet2 file names no projection, so latitudes begin at its first node
    assert main(["map", "check", str(tmp_path / "one")]) == 0
    assert main(["map", "show", str(tmp_path / "one"), "-o", str(tmp_path / "one.svg")]) == 0
    assert '<g id="whiteline"' in (tmp_path / "one.svg").read_text()


def test_sidewalks_are_written_on_request(tmp_path, source, capsys):
    target = tmp_path / "small.osm"
    assert main(["map", "convert", str(source), "-o", str(target)]) == 0
    assert 'v="walkway"' not in target.read_text()
    assert main(["map", "check", str(target), "--against", str(source)]) == 0
    assert "sidewalks   " not in capsys.readouterr().out
    assert main(["map", "convert", str(source), "--walkways", "-o", str(target)]) == 0
    assert 'v="walkway"' in target.read_text()
    assert main(["map", "check", str(target), "--against", str(source)]) == 0
    assert "sidewalks   " in capsys.readouterr().out


def test_stops_of_a_route_file_become_bus_stops(tmp_path, source, capsys):
    route, target = tmp_path / "route.xml", tmp_path / "small.osm"
    route.write_text(
        '<routes><route><stop id="A" name="Main" x="20" y="3"/><stop id="B" x="900" y="0"/></route></routes>'
    )
    assert main(["map", "convert", str(source), "--stops", str(route), "-o", str(target)]) == 0
    assert "stop B () is left out: no driving lane is near" in capsys.readouterr().out
    assert target.read_text().count('v="bus_stop_area"') == 2  # the area and its element
    assert "cannot read the stops of" in _fails(
        capsys, "convert", source, "--stops", tmp_path / "none.xml", "-o", tmp_path / "other.osm"
    )
    assert not (tmp_path / "other.osm").exists()


@pytest.mark.parametrize(
    "words", [["--walkways"], ["--format", "2"], ["--pairwise-priority"], ["--stops", "route.xml"]]
)
def test_what_is_for_lanelet2_is_refused_for_aisan(tmp_path, source, capsys, words):
    assert "are for Lanelet2; leave them out" in _fails(capsys, "convert", source, *words, "-o", tmp_path / "aisan")
    assert not (tmp_path / "aisan").exists()


def test_a_lost_lanelet_is_found(tmp_path, source, capsys):
    target = tmp_path / "small.osm"
    assert main(["map", "convert", str(source), "-o", str(target)]) == 0
    text = target.read_text()
    at = text.rindex("<relation", 0, text.index('<tag k="speed_limit"'))
    end = text.index("</relation>", at) + len("</relation>")
    target.write_text(text[:at] + text[end:])
    assert main(["map", "check", str(target), "--against", str(source)]) == 1
    told = capsys.readouterr().out
    assert "LOST" in told
    assert "error missing: road" in told


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "bad.xodr, line 1: this is no well-formed XML"),
        ("<OpenDRIVE><road", "bad.xodr, line 1: this is no well-formed XML"),
        (document(road(1, 0, 40, [(-1, lane(-1, 0.0))])), "no driving lane at least 0.3 m wide"),
        (
            document(road(2**40, 0, 40, [(-1, lane(-1))])),
            "bad.xodr, line 3: attribute 'id' of <road> is '1099511627776'; it should be a whole number of 32 bits",
        ),
        (two_roads().replace("+proj=tmerc", "+proj=merc"), "is no transverse Mercator"),
    ],
)
def test_bad_maps_are_one_sentence_and_leave_nothing(tmp_path, capsys, text, sentence):
    source = tmp_path / "bad.xodr"
    source.write_text(text)
    assert sentence in _fails(capsys, "convert", source, "-o", tmp_path / "out.osm")
    assert sentence in _fails(capsys, "convert", source, "-o", tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["bad.xodr"]


def test_a_map_without_georeference_is_converted_and_says_so(tmp_path, capsys):
    source = tmp_path / "nowhere.xodr"
    source.write_text(two_roads(geo=""))
    assert main(["map", "convert", str(source), "-o", str(tmp_path / "out.osm")]) == 0
    assert "no <geoReference>" in capsys.readouterr().out
    told = _fails(capsys, "convert", source, "-o", tmp_path / "other.osm", "--transverse-mercator")
    assert "no <geoReference>" in told
    assert not (tmp_path / "other.osm").exists()


def test_an_output_that_is_no_map_format_is_refused(tmp_path, source, capsys):
    assert "neither a .osm file nor a folder" in _fails(capsys, "convert", source, "-o", tmp_path / "map.json")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_as_a_plain_user(tmp_path, source, capsys):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    assert "cannot write" in _fails(capsys, "convert", source, "-o", closed)
    assert "cannot write" in _fails(capsys, "convert", source, "-o", closed / "out.osm")


def test_a_read_only_folder(tmp_path, source, capsys, monkeypatch):
    closed = tmp_path / "closed"
    closed.mkdir()
    monkeypatch.setattr(output.os, "access", lambda _path, _mode: False)
    told = _fails(capsys, "convert", source, "-o", closed)
    assert "the folder is read-only" in told
    assert not list(closed.iterdir())


def test_a_disk_that_fills_leaves_the_older_files(tmp_path, source, capsys, monkeypatch):
    for target in (tmp_path / "map.osm", tmp_path / "aisan"):
        assert main(["map", "convert", str(source), "-o", str(target)]) == 0
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    capsys.readouterr()

    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(output.os, "fsync", full)
    assert "No space left on device" in _fails(capsys, "convert", source, "-o", tmp_path / "map.osm")
    monkeypatch.setattr(Path, "write_bytes", full)
    assert "No space left on device" in _fails(capsys, "convert", source, "-o", tmp_path / "aisan")
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_windows_are_for_vector_maps(tmp_path, source, capsys):
    told = _fails(capsys, "show", source, "--window", 0, 0, 50, "-o", tmp_path / "x.svg")
    assert "--over and --window are for Lanelet2 and Aisan maps" in told
