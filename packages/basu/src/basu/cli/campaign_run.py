"""``basu campaign run``: checks the numbers on the command line, and drives the campaign of a file."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import describe, run_campaign
from basu.campaigns.storage import is_address
from basu.cli.termination import terminated_as_interrupted
from basu.errors import UserError


def run(arguments: argparse.Namespace) -> int:
    """Drive every job of a campaign's file, and write a table with a row for each drive."""
    for name in ("workers", "drives"):
        value = getattr(arguments, name)
        if value is not None and value < 1:
            raise UserError(f"--{name} is {value}; it must be at least 1")
    if arguments.dry_run:
        print(describe(arguments.file))
        return 0
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
