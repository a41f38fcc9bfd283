"""Compares runs by their folders: reads them, writes page and picture, returns what a console shows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.output.report.compare import picture
from basu.output.report.compare.page import comparison
from basu.output.report.compare.table import remarks, rows, text
from basu.output.report.reading import read_run
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path
    from xml.etree.ElementTree import Element

    from basu.output.report.reading import RunRecord

PAGE_FILE, PICTURE_FILE = "compare.html", "compare.png"


def compare(folders: Sequence[Path], output: Path, more: Sequence[Element] = ()) -> str:
    """Write both files into ``output``; ``more`` stands below the table of the page.

    Raises:
        UserError: a folder is no run's, or ``output`` cannot be written.
    """
    runs = [read_run(folder) for folder in folders]
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{output} could not be made: {error.strerror}; name another place with --output") from error
    write_bytes(output / PAGE_FILE, comparison(runs, folders, output, more))
    picture.draw(output / PICTURE_FILE, runs)
    return "\n".join([_table(runs), str(output / PAGE_FILE), str(output / PICTURE_FILE)])


def compared(folders: Sequence[Path]) -> str:
    """The table of a comparison with its remarks; nothing is written.

    Raises:
        UserError: a folder is no run's.
    """
    return _table([read_run(folder) for folder in folders])


def _table(runs: Sequence[RunRecord]) -> str:
    return "\n".join([text(rows(runs)), *remarks(runs)])
