"""Claims about docs/how-to/python-api.md: every block of it runs, one after the other, as a reader would type them."""

import re
from pathlib import Path

import pytest

import basu

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "python-api.md"


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.usefixtures("one_server")
def test_every_block_of_the_page_runs(
    tmp_path: Path, route_file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The short route is a shorter one here: a file in the folder goes before the one that comes with BASU.

    Cases have one worker: ``test_api.py`` plays some with several.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "routes").mkdir()
    route_file.rename(tmp_path / "routes" / "linden_short.xml")
    text = PAGE.read_text(encoding="utf-8")
    assert ", workers=2)" in text
    blocks = re.findall(r"```python\n(.*?)```", text.replace("workers=2", "workers=1"), re.DOTALL)
    assert len(blocks) >= 6
    try:
        for block in blocks:
            exec(compile(block, str(PAGE), "exec"), {"__name__": "page"})
    finally:
        basu.close_simulator()
    status, score, *_ = capsys.readouterr().out.split()
    assert status == "Completed"
    assert 0.9 <= float(score) <= 1.0
    assert (tmp_path / "speeds.png").exists()
