"""Claims about docs/how-to/python-api.md: every block of it runs, one after the other, as a reader would type them."""

import re
from pathlib import Path

import pytest

import basu

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "python-api.md"


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_every_block_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) >= 6
    try:
        for block in blocks:
            exec(compile(block, str(PAGE), "exec"), {"__name__": "page"})
    finally:
        basu.close_simulator()
    assert capsys.readouterr().out.startswith("Completed 0.9")
    assert (tmp_path / "speeds.png").exists()
