import os
from pathlib import Path

import numpy as np
import pytest

from linden.errors import Refusal
from linden.replay.file.folder import RecordingFolder
from linden.replay.file.layouts import SCENE_LIGHT
from linden.replay.file.read import Recording
from linden.replay.file.write import RecordingWriter
from linden.replay.frame_records import states


@pytest.mark.parametrize(
    ("name", "where"),
    [("drive.log", "drive.log"), ("runs/1.log", "runs/1.log"), ("runs\\1.log", "runs/1.log"), ("a/../b.log", "b.log")],
)
def test_names_mean_files_below_the_folder(tmp_path: Path, name: str, where: str) -> None:
    assert RecordingFolder(tmp_path).file(name) == tmp_path / where


def test_an_absolute_path_below_the_folder_is_itself(tmp_path: Path) -> None:
    assert RecordingFolder(tmp_path).file(str(tmp_path / "runs" / "1.log")) == tmp_path / "runs" / "1.log"


@pytest.mark.parametrize(
    "name", ["../drive.log", "/drive.log", "runs/../../drive.log", ".", "runs/..", "C:\\drive.log\\..\\.."]
)
def test_a_name_that_leads_out_of_the_folder_is_refused_with_a_way_out(tmp_path: Path, name: str) -> None:
    with pytest.raises(Refusal, match="start the server with --recordings DIR"):
        RecordingFolder(tmp_path / "recordings").file(name)


def test_a_link_that_leads_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "recordings").mkdir()
    (tmp_path / "recordings" / "link").symlink_to(tmp_path)
    with pytest.raises(Refusal, match="lies outside"):
        RecordingFolder(tmp_path / "recordings").file("link/drive.log")


@pytest.mark.parametrize("name", ["", "a\0b"])
def test_a_name_is_needed(tmp_path: Path, name: str) -> None:
    with pytest.raises(Refusal, match="needs a name"):
        RecordingFolder(tmp_path).file(name)


def test_without_a_folder_it_is_the_users_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert RecordingFolder().path == tmp_path / "linden" / "recordings"
    monkeypatch.setenv("XDG_DATA_HOME", "relative/paths/are/to/be/ignored")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert RecordingFolder().path == tmp_path / "home" / ".local" / "share" / "linden" / "recordings"


def test_a_pipe_among_recordings_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "drive.log")
    with pytest.raises(OSError, match="it is a pipe"):
        Recording(tmp_path / "drive.log")
    with pytest.raises(OSError, match=r"drive\.log"):
        RecordingWriter(tmp_path / "drive.log", "Linden", 0)


def test_a_damaged_colour_of_a_lamp_is_black() -> None:
    lamp = np.zeros(1, SCENE_LIGHT)
    lamp["rgba"] = [np.nan, 1.0, np.inf, 1.0]
    assert states(lamp)[0].color == (0, 255, 255)
