"""The pages are up to date: generated parts, commands, paths and modules that they name."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = [
    "make_supported.py",
    "make_options_tables.py",
    "make_command_line_page.py",
    "make_agent_page.py",
    "make_example_blocks.py",
]


@pytest.mark.parametrize("script", SCRIPTS)
def test_the_generated_parts_are_up_to_date(script: str) -> None:
    done = subprocess.run(
        [sys.executable, f"scripts/{script}", "--check"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_no_page_names_a_place_on_this_machine() -> None:
    for page in [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]:
        text = page.read_text("utf-8")
        assert str(ROOT) not in text, page
        assert str(Path.home()) not in text, page
