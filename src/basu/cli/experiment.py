"""``basu experiment``: drives again what is written down, and shows both."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.driving import add_simulator, check_positive
from basu.options import RunOptions


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``experiment``."""
    command = commands.add_parser("experiment", help="drive the thesis's test runs again", description=drive.__doc__)
    command.add_argument("name", choices=["thesis"], help="section 5.5: four agents on the short route")
    add_simulator(command, "start one for each run")
    command.add_argument("--seed", type=int, default=0, help="of all that is random (default: %(default)s)")
    command.add_argument(
        "--output", type=Path, default=Path("runs"), metavar="DIR", help="for the folder (default: %(default)s)"
    )
    command.set_defaults(command=drive)


def drive(arguments: argparse.Namespace) -> int:
    """Drive basic, behavioral, forward and human as section 5.5 of the thesis did, and print both tables."""
    check_positive(arguments, "timeout")
    from basu.running.experiment.thesis import thesis  # noqa: PLC0415 - the client and the plots, which `--help` does not need

    options = RunOptions(
        host=arguments.host,
        port=arguments.port,
        timeout_s=arguments.timeout,
        seed=arguments.seed,
        output=arguments.output,
    )
    return thesis(options)
