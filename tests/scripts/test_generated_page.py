"""Scripts that generate pages: --check names a page that is out of date and leaves it, and a place is filled once."""

import sys
from pathlib import Path

import pytest
from generated_page import replaced, write_or_check


def test_a_page_is_written_and_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page, other = tmp_path / "page.md", tmp_path / "other.md"
    other.write_text("other")

    def run(*arguments: str) -> int:
        monkeypatch.setattr(sys, "argv", ["make_page.py", *arguments])
        return write_or_check("scripts/make_page.py", "Makes a page.", lambda: {page: "text", other: "other"})

    assert run("--check") == 1
    assert capsys.readouterr().err == "out of date: page.md; run `python scripts/make_page.py`\n"
    assert not page.exists()
    assert run() == 0
    assert page.read_text() == "text"
    assert run("--check") == 0
    assert capsys.readouterr().err == ""


def test_a_place_is_filled_and_must_be_there_once() -> None:
    page = "<!-- a -->\nold\n<!-- /a -->\n"
    assert replaced(page, "a", "new") == "<!-- a -->\n\nnew\n\n<!-- /a -->\n"
    for wrong in ("", page + page):
        with pytest.raises(SystemExit, match="places for 'a'; it must have one"):
            replaced(wrong, "a", "new")
