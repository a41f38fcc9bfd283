"""Claims about docs/reference/scenarios.md: its tables and files are what the code says, and its ids mean cases."""

import re

import pytest

from basu.scenarios.cases import by_id
from docs.pages import ROOT, run_script


def test_the_page_is_what_the_code_says(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_script(monkeypatch, "make_scenarios_page.py", "--check") == 0, capsys.readouterr().err


def test_every_id_on_the_page_means_a_case() -> None:
    page = (ROOT / "docs" / "reference" / "scenarios.md").read_text("utf-8")
    ids = set(re.findall(r"\b[a-z_]+_\d+:[\w=.,:-]*\w", page))
    assert len(ids) >= 5
    for identity in ids:
        assert by_id(identity).case.name == identity
