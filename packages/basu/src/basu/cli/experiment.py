"""``basu experiment``: the thesis's test runs again."""

from __future__ import annotations

import argparse

from basu.cli.typed_options import options_of
from basu.options.run import RunOptions
from basu.running.thesis_experiment import thesis


def run(arguments: argparse.Namespace) -> int:
    """Drive basic, behavioral, forward and human as section 5.5 of the thesis did, and print both tables."""
    return thesis(options_of(RunOptions, arguments), arguments.folder)
