"""``basu run``: checks the options of a drive, and drives an agent along its route."""

from __future__ import annotations

import argparse

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import config_of, options_of, scoring_of
from basu.metrics.registry import user_metrics
from basu.options.run import RunOptions
from basu.running.outputs import check_outputs
from basu.simulator import started_early


def run(arguments: argparse.Namespace) -> int:
    """Drive an agent along its route, faster than real time, and write a scored run folder."""
    config = config_of(arguments, "run", RunOptions)
    options = options_of(RunOptions, arguments, config.options)
    check_outputs(options)
    scoring = scoring_of(arguments, config.scoring)
    user_metrics(options.metric_files)  # a file that holds no metric is refused before the drive
    with terminated_as_interrupted(), started_early(options.simulator, options.workers):
        from basu.running.runner import run as drive  # noqa: PLC0415 - half a second, in which the server starts

        return drive(options, scoring)
