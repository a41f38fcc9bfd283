"""Arguments of ``basu metrics`` and ``basu replay``: question a recording, or play it again."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.driving import SIMULATOR
from basu.cli.later import later
from basu.options.run import RunOptions
from basu.plugins import Command
from basu.settings.command_line import Parser, add_options

_PAGE = (
    "`basu watch RUN` shows a run in a page of the browser; "
    "a recorder file plays on `linden serve --window`, with --host"
)


def add_metrics(metrics: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu metrics``."""
    metrics.description = "Run a metric on a recording alone, without a simulator."
    metrics.add_argument(
        "recording", type=Path, metavar="RUN", help="a run's folder (of --record), or a recorder file of CARLA's (.log)"
    )
    metrics.add_argument(
        "--metric",
        required=True,
        metavar="FILE.py",
        help="a class that is a BasicMetric, as for ScenarioRunner; FILE.py:Class where the file has several",
    )
    metrics.add_argument(
        "--map", type=Path, metavar="FILE.xodr", help="the map the recording lies in (default: the run's)"
    )
    metrics.add_argument(
        "--criteria", type=Path, metavar="FILE.json", help="handed to the metric (default: the run's infractions)"
    )
    metrics.add_argument(
        "--plot", type=Path, metavar="FILE.png", help="keep what the metric draws with matplotlib (further: FILE-2.png)"
    )
    metrics.add_argument("--debug", action="store_true", help="show the traceback of a metric that fails")
    metrics.set_defaults(command=later("basu_carla_log.metrics_command:run"))


def add_replay(replay: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu replay``."""
    replay.description = (
        "Play a run's recorder file again on a simulator, where any client can watch it. `basu watch RUN` needs none."
    )
    if isinstance(replay, Parser):
        replay.gone |= dict.fromkeys(("--viewer", "--save", "--map"), _PAGE)
    replay.add_argument(
        "recording", type=Path, metavar="RUN", help="a run's folder, or a recorder file of CARLA's (.log)"
    )
    add_options(replay, RunOptions, only=SIMULATOR)
    replay.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="times real time, 0 for unbraked (default: %(default)s)"
    )
    replay.set_defaults(command=later("basu_carla_log.replay_command:run"))


METRICS = Command("run a metric of your own on a recording", add_metrics)
REPLAY = Command("play a run again", add_replay)
