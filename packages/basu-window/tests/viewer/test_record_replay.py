"""Claims about `basu replay --viewer`: what is in the record is in Rerun's recording, read back by its own reader."""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from basu.cli import main
from basu.extras import RERUN
from basu.records.history import OTHER, History
from basu.records.history.files import write_history
from fakes import recordings as made
from fakes.drives import at, driven, hit, ramp, stop_sign, straight_route
from fakes.rerun_files import read_rrd, timelines

LINDEN = Path(__file__).parents[4] / "packages" / "linden" / "src" / "linden" / "data" / "Linden.xodr"


@pytest.fixture(autouse=True)
def _no_screen(monkeypatch: pytest.MonkeyPatch) -> None:
    """No window opens in a test."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)


def drive() -> History:
    """Six seconds east, a pole hit after one, an actor ahead."""
    history = driven(
        [*ramp(0.0, 8.0, 2.0), *at(8.0, 4.0)],
        route=straight_route(controls=(stop_sign(150.0),)),
        lateral_m=1.0,
        limit_mps=11.0,
        collisions=[hit(20)],
    )
    others = np.zeros(len(history.frames), dtype=OTHER)
    others["tick"], others["id"], others["x_m"], others["y_m"] = history.frames["tick"], 9, 40.0, 3.0
    return replace(history, others=others)


def shown_again(folder: Path, *options: str) -> Path:
    rrd = folder / "shown.rrd"
    write_history(folder, drive())
    assert main(["replay", str(folder), "--viewer", "--save", str(rrd), *options]) == 0
    return rrd


def test_every_tick_is_shown_at_its_time_and_place(tmp_path: Path) -> None:
    history, rrd = drive(), shown_again(tmp_path)
    found = read_rrd(rrd)
    assert timelines(rrd) == {"simulated_time"}
    ego = found["/world/ego"]
    np.testing.assert_allclose([row.t_s for row in ego], history.frames["t_s"], atol=1e-6)
    places = np.array([row.values["Transform3D:translation"][0] for row in ego])
    np.testing.assert_allclose(places[:, 0], history.frames["x_m"], atol=1e-3)
    np.testing.assert_allclose(places[:, 1], -1.0)  # a metre to the south
    speeds = [row.values["Scalars:scalars"][0] for row in found["/signals/speed/driven"]]
    np.testing.assert_allclose(speeds, history.speed_mps())
    assert {row.values["Scalars:scalars"][0] for row in found["/signals/speed/limit"]} == {11.0}


def test_the_way_the_sign_and_the_other_are_shown(tmp_path: Path) -> None:
    found = read_rrd(shown_again(tmp_path))
    (way,) = found["/world/route"]
    assert way.t_s is None
    assert len(way.values["LineStrips3D:strips"][0]) == 201
    (sign,) = found["/world/controls"]
    assert sign.values["Points3D:labels"] == ["stop_sign"]
    other = found["/world/others"][0].values
    assert other["Boxes3D:labels"] == ["vehicle.audi.tt 9"]
    np.testing.assert_allclose(other["Boxes3D:centers"][0], [40.0, -3.0, 0.8], atol=1e-6)
    np.testing.assert_allclose(other["Boxes3D:half_sizes"][0], [2.0, 0.9, 0.8], atol=1e-6)


def test_scores_fall_when_something_is_held_against_the_driver(tmp_path: Path) -> None:
    found = read_rrd(shown_again(tmp_path))
    infraction = [(row.t_s, row.values["Scalars:scalars"][0]) for row in found["/signals/score/infraction"]]
    assert infraction[0] == (0.0, 1.0)
    assert infraction[-1][1] == pytest.approx(0.65)
    (event,) = found["/events"]
    assert event.t_s == pytest.approx(1.0)
    assert event.values["TextLog:text"][0].startswith("collision_static: ")
    (mark,) = found["/world/infractions"]
    assert mark.t_s == pytest.approx(1.0)


def test_lanes_are_drawn_where_there_is_a_map(tmp_path: Path) -> None:
    without, with_map = tmp_path / "a", tmp_path / "b"
    for folder in (without, with_map):
        folder.mkdir()
    assert "/world/map/lanes" not in read_rrd(shown_again(without))
    (lanes,) = read_rrd(shown_again(with_map, "--map", str(LINDEN)))["/world/map/lanes"]
    assert len(lanes.values["LineStrips3D:strips"]) > 100


def test_a_recorder_file_is_shown_by_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    actors = made.added(
        made.actor(9, "vehicle.easymile.ez10", 1, attributes=[(3, "role_name", "hero")]),
        made.actor(8, "walker.pedestrian.0001", 2),
    )
    frames = [
        made.frame(
            number,
            0.05 * (number - 1),
            *([actors] if number == 1 else []),
            made.positions((9, 100 * number, 200, 0, 0, 0, 90), (8, 500, 500, 0, 0, 0, 0)),
            made.several(12, "I6f", [(9, 20, 0, 0, 0, 0, 0)]),
        )
        for number in range(1, 11)
    ]
    log = made.write(tmp_path, made.header(), *frames)
    assert main(["replay", str(log), "--viewer"]) == 0
    found = read_rrd(tmp_path / "drive.rrd")
    places = [row.values["Transform3D:translation"][0] for row in found["/world/ego"]]
    np.testing.assert_allclose(places, [(number, -2.0, 0.0) for number in range(1, 11)], atol=1e-5)
    assert found["/world/others"][0].values["Boxes3D:labels"] == ["walker.pedestrian.0001 8"]
    assert "/signals/speed/limit" not in found


def test_a_window_that_does_not_open_is_reported_and_the_file_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    false = shutil.which("false")
    assert false is not None
    monkeypatch.setenv("DISPLAY", ":99")
    monkeypatch.setattr("basu_window.viewer.stream.sys.executable", false)  # what Rerun's program is started with
    found = read_rrd(shown_again(tmp_path))
    assert len(found["/world/ego"]) == len(drive().frames)
    assert "(kept; Rerun's window did not open, `rerun` by itself says why)" in capsys.readouterr().out


@pytest.mark.parametrize("command", [["run", "basic", "--viewer"], ["replay", "nowhere", "--viewer"]])
def test_without_rerun_there_is_a_sentence_before_anything_starts(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, command: list[str]
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert main(command) == 2
    assert capsys.readouterr().err == f"basu: {RERUN.missing}\n"


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["nowhere", "--viewer"], "nowhere is not there"),
        (["{folder}", "--viewer"], "is no run folder"),
        (["{folder}"], "has no recording.log: the run was not recorded; run it with --record"),
        (["{folder}", "--speed", "-1"], "--speed is -1.0; it is a factor, or 0"),
        (["{folder}", "--save", "a.rrd"], "--save and --map belong to --viewer"),
    ],
)
def test_a_mistake_is_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], sentence: str
) -> None:
    assert main(["replay", *(option.format(folder=tmp_path) for option in options)]) == 2
    said = capsys.readouterr().err.splitlines()[-1]
    assert said.startswith("basu: ")
    assert sentence in said
