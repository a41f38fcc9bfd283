"""``basu campaign report``: the page of a campaign, written again."""

from __future__ import annotations

import argparse

from basu.campaigns.report import write_campaign_report
from basu.campaigns.storage import local_copy, written_page


def run(arguments: argparse.Namespace) -> int:
    """Write campaign.html into the folder of a campaign."""
    with local_copy(arguments.folder) as (folder, store):
        print(f"report  {written_page(store, write_campaign_report(folder))}")
    return 0
