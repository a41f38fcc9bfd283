"""The pages say what is: the generated one is up to date, and every command of the two programs stands in a page."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


def test_the_supported_page_is_what_the_code_says() -> None:
    done = subprocess.run(
        [sys.executable, "scripts/make_supported.py", "--check"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_the_tables_of_options_are_what_the_code_says() -> None:
    done = subprocess.run(
        [sys.executable, "scripts/make_options_tables.py", "--check"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "command",
    [
        "linden serve",
        "linden map",
        "basu run",
        "basu score",
        "basu list",
        "basu report",
        "basu compare",
        "basu metrics",
        "basu replay",
        "basu experiment",
        "basu scenario list",
        "basu scenario run",
        "basu scenario draw",
        "basu scenario report",
    ],
)
def test_every_command_has_a_place_in_the_pages(command: str) -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    assert any(command in page.read_text("utf-8") for page in pages)


def test_no_page_names_a_place_on_this_machine() -> None:
    for page in [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]:
        text = page.read_text("utf-8")
        assert str(ROOT) not in text, page
        assert str(Path.home()) not in text, page
