"""Claims about the example notebook: it runs from top to bottom, and is kept with its pictures."""

import sys
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[3]
NOTEBOOK = ROOT / "examples" / "first_drive.ipynb"
ROUTE = ROOT / "packages" / "basu" / "src" / "basu" / "routes" / "linden_short.xml"
PIECE = slice(9, 14)  # of its points: past the stop sign that the agent of the notebook ignores


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
def test_it_runs_and_shows_what_it_is_kept_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a piece of its route, which goes before the one that comes with BASU, and with twelve samples of sixteen."""
    monkeypatch.syspath_prepend(ROOT / "scripts")
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "src"))
    from run_notebook import execute  # noqa: PLC0415 - lies among the scripts

    (tmp_path / "routes").mkdir()
    lines = ROUTE.read_text(encoding="utf-8").splitlines()
    points = [line for line in lines if "<position" in line]
    piece = [line for line in lines if line not in points or line in points[PIECE]]
    (tmp_path / "routes" / ROUTE.name).write_text("\n".join(piece), encoding="utf-8")
    book = nbformat.read(NOTEBOOK, as_version=4)
    wanted = kinds(book)
    (sweep,) = (cell for cell in book.cells if "sweep=16" in cell.source and cell.cell_type == "code")
    sweep.source = sweep.source.replace("sweep=16", "sweep=12")
    execute(book, tmp_path)
    assert kinds(book) == wanted
    sys.modules.pop("run_notebook")
