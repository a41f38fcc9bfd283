"""The section of a campaign's report on its searches and estimates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.report.templates import render
from basu_search.boundary_map import boundary_map
from basu_search.findings import boundary_in, rare_in, searches_in

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa
    from markupsafe import Markup


def search_section(folder: Path, table: pa.Table, confidence: float) -> Markup:
    """Return the section: boundaries of failure and rates of rare failures."""
    found = searches_in(folder, table)
    boundaries = [boundary_in(drives) for drives in found if drives.about["kind"] == "search"]
    return render(
        "templates/campaign_search.j2",
        boundaries=[
            {
                "title": each.drives.title,
                "sentences": each.sentences,
                "picture": boundary_map(each),
                "reach": each.reach,
            }
            for each in boundaries
        ],
        estimates=[rare_in(drives, confidence) for drives in found if drives.about["kind"] == "estimate"],
        confidence=confidence,
    )
