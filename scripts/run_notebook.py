"""Runs a notebook and writes it back with its outputs, or elsewhere: ``python scripts/run_notebook.py NOTEBOOK [TO]``.

The notebook runs in a folder of its own, so that the runs it makes are thrown away.
"""

import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient

CELL_LIMIT_S = 240


def executed(path: Path) -> nbformat.NotebookNode:
    """The notebook with fresh outputs; raises CellExecutionError where a cell raises."""
    book = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        execute(book, Path(folder))
    return book


def execute(book: nbformat.NotebookNode, folder: Path) -> None:
    """Run a notebook in a folder, and give it its outputs; raises CellExecutionError where a cell raises."""
    NotebookClient(book, timeout=CELL_LIMIT_S, resources={"metadata": {"path": str(folder)}}).execute()
    for cell in book.cells:
        cell.metadata.pop("execution", None)  # wall clock times, which differ each time


def main() -> None:
    """Run it."""
    path = Path(sys.argv[1])
    nbformat.write(executed(path), Path(sys.argv[2]) if len(sys.argv) > 2 else path)


if __name__ == "__main__":
    main()
