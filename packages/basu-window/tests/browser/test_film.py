"""Claims about films of recorded runs."""

import sys
from pathlib import Path

import pytest

from basu.cli import main
from basu.errors import UserError
from basu_window.browser import film
from basu_window.browser.film import PICTURES_PER_S, SIZE_PX, check_film
from browsers import NAMES
from fakes.run_records import crashing, record, written
from linden_window.link import PageLink
from opendrive_texts import SIGNS_AND_LIGHTS


@pytest.mark.slow
def test_a_film_shows_the_moments_of_the_record(tmp_path: Path) -> None:
    av = pytest.importorskip("av", reason="the extra `film` of basu-window brings PyAV")
    folder = written(tmp_path / "a-run", record(crashing()))
    (folder / "config.json").unlink()  # its fake has no scoring, and the default is meant
    (tmp_path / "street.xodr").write_text(SIGNS_AND_LIGHTS)
    file = tmp_path / "drive.mp4"
    words = ["--map", str(tmp_path / "street.xodr"), "--film", str(file), "--film-from", "2", "--film-to", "3"]
    assert main(["watch", str(folder), *words]) == 0
    with av.open(str(file)) as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
        assert container.streams.video[0].average_rate == PICTURES_PER_S
    assert len(pictures) == PICTURES_PER_S + 1
    assert pictures[0].shape == (SIZE_PX[1], SIZE_PX[0], 3)
    assert pictures[0].std() > 10.0, "something is shown"
    assert (pictures[0] != pictures[-1]).any(), "the vehicle moves"


def test_a_page_that_loads_nothing_ends_the_film_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("av", reason="the extra `film` of basu-window brings PyAV")
    monkeypatch.setattr(film, "PATIENCE_S", 3.0)
    link = PageLink.start()  # and no record is sent
    try:
        with pytest.raises(UserError, match="nothing new for 3 s"):
            film.write_film(link, tmp_path / "drive.mp4", 0.0, 1.0)
    finally:
        link.close()


def test_a_film_without_its_packages_or_a_browser_gets_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["watch", str(tmp_path), "--film", str(tmp_path / "drive.mp4")]
    monkeypatch.setattr("basu.extras.importlib.util.find_spec", lambda _name: None)
    assert main(words) == 2
    assert "pip install 'basu-window[film]'" in capsys.readouterr().err
    monkeypatch.setattr("basu.extras.importlib.util.find_spec", lambda name: sys)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(words) == 2
    assert f"none of {', '.join(NAMES)} is installed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "sentence"), [("drive.gif", "a film is an MP4 file"), ("no/drive.mp4", "there is no folder")]
)
def test_a_film_that_cannot_be_written_is_refused_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, sentence: str
) -> None:
    monkeypatch.setattr("basu.extras.importlib.util.find_spec", lambda name: sys)
    monkeypatch.setattr("basu_window.browser.film.shutil.which", lambda name: f"/usr/bin/{name}")
    with pytest.raises(UserError, match=sentence):
        check_film(tmp_path / name)
