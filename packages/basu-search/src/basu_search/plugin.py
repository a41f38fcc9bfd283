"""The plugin: what a campaign of ``basu`` calls for its searches and estimates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.campaigns.search_part import DriveWeight
from basu_search.findings import searches_in
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


def weights(folder: Path, table: pa.Table) -> dict[int, DriveWeight | None]:
    """Return the weight of each drive of searches and estimates, by its number; None if it is no sample of its case."""
    found: dict[int, DriveWeight | None] = {}
    for drives in searches_in(folder, table):
        plain = drives.about["settings"].get("plain")
        for number, weight, learns in zip(drives.numbers, drives.weights.tolist(), drives.learns.tolist(), strict=True):
            found[number] = None if plain is None or learns else DriveWeight(weight, plain)
    return found


def section(folder: Path, table: pa.Table, confidence: float) -> Markup:
    """Return the section of a campaign's report: boundaries of failure and rates of rare failures."""
    return search_section(folder, table, confidence)
