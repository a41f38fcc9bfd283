"""Claims about `linden map pointcloud`, from the streets of a small map to a file and back."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fakes.pcd_files import pcd
from linden.cli import main
from linden.protocol.values.enums import SemanticTag
from linden_maps.pointcloud.pcd_reading import clouds_of
from opendrive_texts import lane, line, opendrive, road, section, street_through_junction

QUICK = ["--every", "20", "--columns", "300", "--channels", "16", "--range", "50"]


@pytest.fixture(autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))


@pytest.fixture
def town(tmp_path: Path) -> str:
    """A street from west to east on level ground."""
    file = tmp_path / "town.xodr"
    file.write_text(street_through_junction())
    return str(file)


def pointcloud(*arguments: object) -> int:
    return main(["map", "pointcloud", *map(str, arguments)])


def points_of(file: Path) -> np.ndarray:
    return np.concatenate([cloud.points_m for cloud in clouds_of(file)])


def test_a_drive_finds_the_street_where_it_is(town: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "town.pcd"
    assert pointcloud(town, "-o", file, "--labels", *QUICK) == 0
    (cloud,) = clouds_of(file)
    road = cloud.points_m[cloud.label == SemanticTag.ROADS]
    np.testing.assert_allclose(road[:, 2], 0.0, atol=0.02)
    assert np.abs(road[:, 1]).max() < 3.7  # two lanes of 3.5 m, a cell's mean aside
    assert road[:, 0].min() < 2.0
    assert road[:, 0].max() > 128.0
    told = capsys.readouterr()
    assert f"{file}: {len(cloud.points_m):,} of " in told.out
    assert "town: x east, y north, z up, m; x = y = 0 at latitude 40.0000000, longitude -83.0000000" in told.out
    assert "scans/s" in told.err  # the progress bar


def test_no_two_points_are_in_one_cell(town: str, tmp_path: Path) -> None:
    assert pointcloud(town, "-o", tmp_path / "town.pcd", "--voxel", "0.5", *QUICK) == 0
    cells = np.floor(points_of(tmp_path / "town.pcd") / 0.5)
    assert len(np.unique(cells, axis=0)) > 0.99 * len(cells)  # means are single precision, and may touch a side


def test_the_same_map_gives_the_same_file(town: str, tmp_path: Path) -> None:
    files = [tmp_path / "one.pcd", tmp_path / "two.pcd"]
    for file in files:
        assert pointcloud(town, "-o", file, "--labels", *QUICK) == 0
    assert files[0].read_bytes() == files[1].read_bytes()


def test_kept_scans_make_the_same_map_again(town: str, tmp_path: Path) -> None:
    assert pointcloud(town, "-o", tmp_path / "drive.pcd", "--scans", tmp_path / "scans", *QUICK) == 0
    assert pointcloud("--from", tmp_path / "scans", "-o", tmp_path / "again.pcd") == 0
    drive, again = points_of(tmp_path / "drive.pcd"), points_of(tmp_path / "again.pcd")
    assert abs(len(drive) - len(again)) < 0.02 * len(drive)  # scans are single precision: some points change cells
    np.testing.assert_allclose(again.mean(axis=0), drive.mean(axis=0), atol=0.05)


def test_the_two_steps_apart_are_the_two_at_once(town: str, tmp_path: Path) -> None:
    assert pointcloud(town, "-o", tmp_path / "drive.pcd", "--scans", tmp_path / "scans", "--voxel", 0, *QUICK) == 0
    whole, small = tmp_path / "whole.pcd", tmp_path / "small.pcd"
    assert pointcloud("--from", tmp_path / "scans", "-o", whole, "--voxel", "0") == 0
    assert pointcloud("--from", whole, "-o", small, "--voxel", "1") == 0
    assert pointcloud("--from", tmp_path / "scans", "-o", tmp_path / "both.pcd", "--voxel", "1") == 0
    assert len(points_of(whole)) == len(points_of(tmp_path / "drive.pcd")) > 3 * len(points_of(small))
    assert abs(len(points_of(small)) - len(points_of(tmp_path / "both.pcd"))) < 0.02 * len(points_of(small))


def test_scans_of_other_programs_are_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number, data in enumerate(("ascii", "binary", "binary_compressed")):
        columns = {"x": np.float32([number, 0.01]), "y": np.float32([5, 0.01]), "z": np.float32([0, 0.01])}
        pcd(tmp_path / f"{number}.pcd", {**columns, "intensity": np.float32([0, 1])}, data)
    (tmp_path / "poses.txt").write_text("".join(f"{number} 0 100 0 0 0 0 1\n" for number in range(3)))
    assert pointcloud("--from", tmp_path, "-o", tmp_path / "out", "--voxel", "0.5") == 0
    np.testing.assert_allclose(
        sorted(points_of(tmp_path / "out").tolist()),
        [[0, 105, 0], [0.01, 100.01, 0.01], [1, 105, 0], [2, 105, 0]],
        atol=1e-5,
    )
    assert "of 3 files, moved by their poses" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["Atlantis", "-o", "a.pcd"], "cannot read Atlantis"),
        (["Linden", "--from", "x", "-o", "a.pcd"], "leave the map and --scans out"),
        (["--from", "nowhere", "-o", "a.pcd"], "cannot read nowhere: No such file"),
        (["--poses", "p.txt", "-o", "a.pcd"], "--poses are those of existing scans"),
        (["--device", "abacus", "-o", "a.pcd"], "--device abacus"),
        (["--upper-fov", "-30", "-o", "a.pcd"], "--upper-fov -30 is below --lower-fov -25"),
    ],
)
def test_options_that_contradict_each_other_get_a_sentence(
    arguments: list[str], told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert pointcloud(*arguments) == 2
    assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_missing_labels_get_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = pcd(tmp_path / "a.pcd", {axis: np.float32([1.0]) for axis in "xyz"}, "ascii")
    assert pointcloud("--from", file, "--labels", "-o", tmp_path / "b.pcd") == 2
    assert f"--labels: not every file of {file} has a field label" in capsys.readouterr().err


def test_a_map_without_a_driving_lane_gets_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "path.xodr").write_text(
        opendrive(road(1, 9.0, line(0, 0, 0, 0, 9), section(right=lane(-1, "walking"))))
    )
    assert pointcloud(tmp_path / "path.xodr", "-o", tmp_path / "b.pcd") == 2
    assert "path has no driving lane, so there is nowhere to drive" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "value", "told"),
    [
        ("--voxel", "-1", "neither 0 nor a positive number"),
        ("--every", "0", "not a positive number"),
        ("--channels", "0", "less than 1"),
        ("--lower-fov", "-91", "not between -90 and 90"),
        ("--range", "inf", "not a positive number"),
    ],
)
def test_a_number_out_of_range_gets_a_sentence(
    option: str, value: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        pointcloud("-o", "a.pcd", f"{option}={value}")
    assert told in capsys.readouterr().err


def test_an_interrupted_command_leaves_nothing_behind(town: str, tmp_path: Path) -> None:
    tmp, file = tmp_path / "tmp", tmp_path / "town.pcd"
    tmp.mkdir()
    command = [sys.executable, "-m", "linden.cli", "map", "pointcloud", town, "-o", str(file), "--every", "0.05"]
    with subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(tmp)}
    ) as process:
        assert process.stderr is not None
        shown = ""
        while "scans" not in shown and process.poll() is None:  # the bar: it is at work
            shown += process.stderr.read(1)
        process.send_signal(signal.SIGTERM)
        told = process.stderr.read()
        assert process.wait() == 128 + signal.SIGTERM
    assert "Traceback" not in told
    assert list(tmp.iterdir()) == []
    assert not [left for left in tmp_path.iterdir() if left.name.startswith("town.pcd")]
