"""``basu campaign``: drives thousands of jobs from one file, shows how far they are, and reports on them."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.run import terminated_as_interrupted
from basu.errors import UserError


def add_campaign(campaign: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu campaign``."""
    actions = campaign.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_run(actions.add_parser("run", help="drive a campaign, or go on with it", description=run_command.__doc__))
    for name, command, text in (
        ("status", status_command, "show how far a campaign has come"),
        ("report", report_command, "write campaign.html: what may be concluded from the drives so far"),
    ):
        one = actions.add_parser(name, help=text, description=command.__doc__)
        one.add_argument("folder", metavar="DIR", help="of a campaign, such as campaigns/NAME or s3://BUCKET/NAME")
        one.set_defaults(command=command)


def _add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu campaign run``."""
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
    run.set_defaults(command=run_command)


def run_command(arguments: argparse.Namespace) -> int:
    """Drive every job of a campaign's file, and write a table with a row for each drive."""
    for name in ("workers", "drives"):
        value = getattr(arguments, name)
        if value is not None and value < 1:
            raise UserError(f"--{name} is {value}; it must be at least 1")
    from basu.campaigns.command import RunSettings, describe, run_campaign  # noqa: PLC0415 - brings in the client

    if arguments.dry_run:
        print(describe(arguments.file))
        return 0
    from basu.campaigns.storage import is_address  # noqa: PLC0415 - likewise

    is_remote = is_address(arguments.output)
    settings = RunSettings(
        file=arguments.file,
        output=arguments.work if is_remote else Path(arguments.output),
        store=arguments.output if is_remote else None,
        resume=arguments.resume,
        workers=arguments.workers,
        drives=arguments.drives,
        ray=arguments.ray,
    )
    with terminated_as_interrupted():
        return run_campaign(settings)


def status_command(arguments: argparse.Namespace) -> int:
    """Show how far a campaign has come: drives, success of each agent, the time left."""
    from basu.campaigns.status import status  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.campaigns.storage import local_copy  # noqa: PLC0415 - likewise

    with local_copy(arguments.folder) as (folder, _):
        print(status(folder))
    return 0


def report_command(arguments: argparse.Namespace) -> int:
    """Write campaign.html into the folder of a campaign."""
    from basu.campaigns.report import write_campaign_report  # noqa: PLC0415 - the plots, likewise
    from basu.campaigns.storage import local_copy, written_page  # noqa: PLC0415 - likewise

    with local_copy(arguments.folder) as (folder, store):
        print(f"report  {written_page(store, write_campaign_report(folder))}")
    return 0
