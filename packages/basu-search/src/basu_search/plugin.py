"""The plugin: what a campaign of ``basu`` calls for its searches and estimates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_search.report_section import search_section
from basu_search.search_states import SearchFiles, proposer_of

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa
    from markupsafe import Markup

    from basu.campaigns.plan import CampaignPlan
    from basu.campaigns.search_part import SearchPart


def sizes(part: SearchPart) -> tuple[int, ...]:
    """Return the number of drives in each round of a part's searches."""
    return tuple(proposer_of(part, 0).sizes)


def states(plan: CampaignPlan, folder: Path) -> SearchFiles:
    """Return the states of all searches of a campaign, which lie in its folder."""
    return SearchFiles(plan, folder)


def section(folder: Path, table: pa.Table, confidence: float) -> Markup:
    """Return the section of a campaign's report: boundaries of failure and rates of rare failures."""
    return search_section(folder, table, confidence)
