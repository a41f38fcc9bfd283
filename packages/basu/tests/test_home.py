"""Claims about a home folder that cannot be written: a temporary one takes its place, and one sentence says so."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from basu.home import CLIENT_CACHE, replaced_home


@pytest.fixture(autouse=True)
def looked_at_anew() -> Iterator[None]:
    replaced_home.cache_clear()
    yield
    replaced_home.cache_clear()


def test_a_home_that_cannot_be_written_is_replaced_for_this_process_and_its_children(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", "/proc/none")
    found = [replaced_home(), replaced_home()]
    assert found == [Path(os.environ["HOME"])] * 2
    assert Path(os.environ["HOME"]).is_dir()
    assert capsys.readouterr().err.count("the home folder cannot be written") == 1


def test_a_home_that_can_be_written_stays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert replaced_home() is None
    assert os.environ["HOME"] == str(tmp_path)
    assert [each.name for each in tmp_path.iterdir()] == [CLIENT_CACHE]
    assert not list((tmp_path / CLIENT_CACHE).iterdir())
