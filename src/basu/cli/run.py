"""``basu run`` and ``basu experiment``: drive an agent along a route and score the drive."""

from __future__ import annotations

import argparse
import signal
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from basu.errors import Terminated
from basu.metrics.scoring import Scoring, read_scoring_file
from basu.options.run import RunOptions
from basu.outcome import EXIT_CODES
from basu.settings.command_line import add_options, typed
from basu.settings.option import Layer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

    from basu.settings.document import Config
    from basu.settings.option import Settings

SIMULATOR = ("host", "port", "timeout_s")  # the options that say where to drive


def add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu run``."""
    run.description, run.epilog = run_agent.__doc__, EXIT_CODES
    add_config(run)
    add_options(run, RunOptions)
    add_scoring(run)
    run.set_defaults(command=run_agent)


def add_experiment(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu experiment``."""
    command.description = drive_thesis.__doc__
    command.add_argument("name", choices=["thesis"], help="section 5.5: four agents on the short route")
    add_options(command, RunOptions, only=(*SIMULATOR, "seed", "output"))
    command.set_defaults(command=drive_thesis)


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
    group = next(group for group in command._action_groups if group.title == "scoring")  # noqa: SLF001
    group.add_argument(
        "--scoring",
        type=Path,
        metavar="FILE",
        help="a JSON file with what differs from the thesis's scoring; the options above go before it",
    )


def scoring_of(arguments: argparse.Namespace, below: Layer) -> Scoring:
    """The scoring of ``below``, of the file that the command line names and of its options, the later before.

    Raises:
        UserError: an option that does not exist, or a value that it cannot have.
    """
    from basu.settings.resolve import resolve  # noqa: PLC0415 - pydantic, which `--help` does not need

    file = [] if arguments.scoring is None else [read_scoring_file(arguments.scoring)]
    return resolve(Scoring, [below, *file, Layer(typed(Scoring, arguments), typed=True)])


def options_of(arguments: argparse.Namespace, below: Layer | None = None) -> RunOptions:
    """The options of a command line, with those of ``below`` where it says nothing.

    Raises:
        UserError: an option that does not exist, or a value that it cannot have.
    """
    from basu.settings.resolve import resolve  # noqa: PLC0415 - pydantic, which `--help` does not need

    layers = [] if below is None else [below]
    return resolve(RunOptions, [*layers, Layer(typed(RunOptions, arguments), typed=True)])


def config_of(arguments: argparse.Namespace, kind: str, model: type[Settings]) -> Config:
    """The document that ``--config`` names, or an empty one; says why the run may differ from the one that left it.

    Raises:
        UserError: it is none.
    """
    from basu.settings.document import Config, read_config  # noqa: PLC0415 - brings in the client's version

    if arguments.config is None:
        return Config(Layer({}), Layer({}), ())
    config = read_config(arguments.config, kind, model)
    for difference in config.warnings:
        print(f"basu: warning: {difference}; the run may differ from that of {arguments.config}", file=sys.stderr)
    return config


def run_agent(arguments: argparse.Namespace) -> int:
    """Drive an agent along its route, faster than real time, and write a scored run folder."""
    config = config_of(arguments, "run", RunOptions)
    options = options_of(arguments, config.options)
    if options.viewer:
        from basu.output.viewer.stream import require  # noqa: PLC0415 - the viewer, which needs an extra

        require()
    if options.ros2:
        from basu.ros.dds_types import require as require_dds  # noqa: PLC0415 - an extra

        require_dds()
    if options.rosbag is not None or options.ros2 or options.ros1:
        from basu.ros.bag_file import require as require_rosbags  # noqa: PLC0415 - an extra

        require_rosbags()
    if options.ros1:
        from basu.ros.ros1 import require as require_roscore  # noqa: PLC0415 - rosbags, an extra

        require_roscore()
    scoring = scoring_of(arguments, config.scoring)
    from basu.metrics.registry import user_metrics  # noqa: PLC0415 - numpy, likewise

    user_metrics(options.metric_files)  # a file that holds no metric is refused before the drive
    from basu.simulator import started_early  # noqa: PLC0415 - the client, which `--help` does not need

    with terminated_as_interrupted(), started_early(options):
        from basu.running.runner import run  # noqa: PLC0415 - the plots, imported while the server starts

        return run(options, scoring)


def drive_thesis(arguments: argparse.Namespace) -> int:
    """Drive basic, behavioral, forward and human as section 5.5 of the thesis did, and print both tables."""
    options = options_of(arguments)
    from basu.running.thesis_experiment import thesis  # noqa: PLC0415 - as above

    return thesis(options)


@contextmanager
def terminated_as_interrupted() -> Iterator[None]:
    """Within, SIGTERM ends a run as Ctrl-C does: what was measured is written."""
    before = signal.signal(signal.SIGTERM, _terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _terminated(_number: int, _frame: FrameType | None) -> NoReturn:
    raise Terminated
