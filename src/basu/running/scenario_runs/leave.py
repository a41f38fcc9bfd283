"""What a run of scenarios leaves beside its cases: the matrix for people, for build servers and for a browser."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from basu.output.report.folder import plain
from basu.output.report.scenarios.console import matrix_text
from basu.output.report.scenarios.junit import junit_xml
from basu.output.report.scenarios.page.matrix_page import PAGE_FILE, write_matrix_page
from basu.output.report.scenarios.sweep.study import studies
from basu.output.report.scenarios.sweep.success_map import sweep_map
from basu.utils.atomic import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

TEXT_FILE, JUNIT_FILE = "matrix.txt", "junit.xml"


def leave(folder: Path, matrix: dict[str, Any], junit: Path | None) -> None:
    """Write all of it into ``folder``, the JUnit XML to ``junit`` as well, and show the matrix.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_bytes(folder / TEXT_FILE, f"{matrix_text(matrix)}\n".encode())
    for file in (folder / JUNIT_FILE, junit):
        if file is not None:
            write_bytes(file, junit_xml(matrix))
    for study in studies(matrix):
        name = f"success-{plain(study.scenario)}-{plain(study.agent)}.svg"
        write_bytes(folder / name, sweep_map(matrix, study.agent, study.scenario).encode())
    write_matrix_page(folder, matrix)
    print(matrix_text(matrix, colour=sys.stdout.isatty()))
    print(f"\nreport  {folder / PAGE_FILE}")
