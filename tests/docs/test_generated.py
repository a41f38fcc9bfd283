"""The pages are up to date: generated parts, commands, paths and modules that they name."""

from pathlib import Path

import pytest

from docs.pages import ROOT, run_script

SCRIPTS = [
    "make_supported.py",
    "make_options_tables.py",
    "make_command_line_page.py",
    "make_agent_page.py",
    "make_gate_page.py",
    "make_facts_page.py",
    "make_fault_page.py",
    "make_openscenario_page.py",
    "make_rules_page.py",
    "make_example_blocks.py",
]


@pytest.mark.parametrize("script", SCRIPTS)
def test_the_generated_parts_are_up_to_date(
    script: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_script(monkeypatch, script, "--check") == 0, capsys.readouterr().err


def test_no_page_names_a_place_on_this_machine() -> None:
    for page in [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]:
        text = page.read_text("utf-8")
        assert str(ROOT) not in text, page
        assert str(Path.home()) not in text, page
