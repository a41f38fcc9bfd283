"""Arguments of ``basu campaign run``, ``status`` and ``report``."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.later import later


def add_campaign(campaign: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu campaign``."""
    actions = campaign.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_run(actions.add_parser("run", help="drive a campaign, or go on with it"))
    status = actions.add_parser("status", help="show how far a campaign has come")
    status.description = "Show how far a campaign has come: drives, success of each agent, the time left."
    _add_folder(status)
    status.set_defaults(command=later("basu.cli.campaign_status:run"))
    report = actions.add_parser("report", help="write campaign.html: what may be concluded from the drives so far")
    report.description = "Write campaign.html into the folder of a campaign."
    _add_folder(report)
    report.set_defaults(command=later("basu.cli.campaign_report:run"))


def _add_folder(command: argparse.ArgumentParser) -> None:
    """Add the folder of a campaign."""
    command.add_argument("folder", metavar="DIR", help="of a campaign, such as campaigns/NAME or s3://BUCKET/NAME")


def _add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu campaign run``."""
    run.description = "Drive every job of a campaign's file, and write a table with a row for each drive."
    run.add_argument("file", type=Path, metavar="FILE", help="campaign.toml; docs/how-to/campaigns.md has every key")
    run.add_argument(
        "--output",
        default="campaigns",
        metavar="DIR",
        help="parent of the folder, also an address such as s3://BUCKET (default: %(default)s)",
    )
    run.add_argument(
        "--work",
        type=Path,
        default=Path("campaigns"),
        metavar="DIR",
        help="parent of the folder on this machine where --output is an address (default: %(default)s)",
    )
    run.add_argument("--resume", action="store_true", help="go on with a campaign that was interrupted or killed")
    run.add_argument("--workers", type=int, metavar="N", help="drives at the same time (default: one a processor)")
    run.add_argument("--drives", type=int, metavar="N", help="only the first N drives; --resume goes on (default: all)")
    run.add_argument(
        "--ray", metavar="ADDRESS", help="drive on a running Ray cluster: auto, or HOST:PORT (default: this machine)"
    )
    run.add_argument("--dry-run", action="store_true", help="check the file, show what would be driven, and end")
    run.set_defaults(command=later("basu.cli.campaign_run:run"))
