"""``basu campaign status``: how far a campaign has come."""

from __future__ import annotations

import argparse

from basu.campaigns.status import status
from basu.campaigns.storage import local_copy


def run(arguments: argparse.Namespace) -> int:
    """Show how far a campaign has come: drives, success of each agent, the time left."""
    with local_copy(arguments.folder) as (folder, _):
        print(status(folder))
    return 0
