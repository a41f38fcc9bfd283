"""Claims about the example notebook: it runs from top to bottom, and is kept with its pictures."""

import sys
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOK = ROOT / "examples" / "first_drive.ipynb"


def kinds(book: nbformat.NotebookNode) -> list[list[str]]:
    """For each code cell, what its outputs are: mime types, streams."""
    return [
        [kind for output in cell.outputs for kind in sorted(output.get("data", {output.get("name", ""): ""}))]
        for cell in book.cells
        if cell.cell_type == "code"
    ]


def test_it_is_kept_with_its_outputs_and_pictures() -> None:
    found = [kind for cell in kinds(nbformat.read(NOTEBOOK, as_version=4)) for kind in cell]
    assert found.count("image/png") >= 2
    assert found.count("image/svg+xml") >= 1
    assert found.count("text/html") >= 2
    assert "traceback" not in NOTEBOOK.read_text(encoding="utf-8").lower()


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_it_runs_and_shows_what_it_is_kept_with(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "scripts")
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "src"))
    from run_notebook import executed  # noqa: PLC0415 - lies among the scripts

    assert kinds(executed(NOTEBOOK)) == kinds(nbformat.read(NOTEBOOK, as_version=4))
    sys.modules.pop("run_notebook")
