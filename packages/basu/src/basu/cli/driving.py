"""Arguments of ``basu run``, ``experiment`` and ``score``: the options of a drive and of its scoring."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.later import later
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import EXIT_CODES
from basu.settings.command_line import add_options

SIMULATOR = ("host", "port", "timeout_s")  # the options that say where to drive


def add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu run``."""
    run.description = "Drive an agent along its route, faster than real time, and write a scored run folder."
    run.epilog = EXIT_CODES
    add_config(run)
    add_options(run, RunOptions)
    add_scoring(run)
    run.set_defaults(command=later("basu.cli.run:run"))


def add_experiment(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu experiment``."""
    command.description = (
        "Drive basic, behavioral, forward and human as section 5.5 of the thesis did, and print both tables."
    )
    command.add_argument("name", choices=["thesis"], help="section 5.5: four agents on the short route")
    command.add_argument(
        "--resume", type=Path, dest="folder", metavar="FOLDER", help="continue an experiment that was broken off"
    )
    add_options(command, RunOptions, only=(*SIMULATOR, "seed", "output"))
    command.set_defaults(command=later("basu.cli.experiment:run"))


def add_score(score: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu score``."""
    score.description = (
        "Compute scores and infractions of a run again, from its history and facts, without a simulator."
    )
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--write", action="store_true", help="replace result.json, also one of an earlier version")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    score.add_argument(
        "--metrics",
        type=Path,
        action="append",
        default=[],
        metavar="FILE.py",
        help="metrics of your own; may be given several times",
    )
    add_scoring(score)
    score.set_defaults(command=later("basu.cli.score:run"))


def add_config(command: argparse.ArgumentParser) -> None:
    """Add ``--config``."""
    command.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="config.json of a run's folder: repeat that run; options given beside it go before it",
    )


def add_scoring(command: argparse.ArgumentParser) -> None:
    """Add the options of the scoring and the file that may hold them."""
    add_options(command, Scoring)
    group = next(group for group in command._action_groups if group.title == Scoring.GROUP)  # noqa: SLF001
    same = "what differs from the thesis's scoring, as a JSON file or text; the options above override it"
    group.add_argument(Scoring.FILE_FLAG, metavar="FILE|JSON", help=same)
