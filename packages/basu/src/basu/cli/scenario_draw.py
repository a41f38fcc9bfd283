"""``basu scenario draw``: the behaviour tree of a case."""

from __future__ import annotations

import argparse

from basu.cli.typed_options import options_of
from basu.files import write_bytes
from basu.running.scenario_runs.options import ScenarioOptions
from basu.running.scenario_runs.placed_cases import drawn
from basu.settings.option import Layer


def run(arguments: argparse.Namespace) -> int:
    """Draw the behaviour tree of a case as it stands before a run, with its criteria."""
    options = options_of(ScenarioOptions, arguments, Layer({"what": [arguments.case]}))
    text = drawn(options, arguments.form)
    if arguments.output is None:
        print(text)
    else:
        write_bytes(arguments.output, f"{text}\n".encode())
    return 0
