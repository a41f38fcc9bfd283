"""``basu scenario export``: cases as OpenSCENARIO files for other programs."""

from __future__ import annotations

import argparse
import sys

from basu.cli.typed_options import options_of
from basu.outcome import Fault
from basu.running.scenario_runs.options import ScenarioOptions
from basu.running.scenario_runs.placed_cases import export_cases


def run(arguments: argparse.Namespace) -> int:
    """Write cases as OpenSCENARIO files with their roads beside them; a case that cannot be written is named."""
    written = refused = 0
    for one in export_cases(options_of(ScenarioOptions, arguments), arguments.output, arguments.player):
        if one.refusal:
            refused += 1
            print(f"basu: {one.refusal}", file=sys.stderr)
        else:
            written += 1
            print(one.path)
    if refused and written:
        print(f"basu: {written} of {written + refused} cases are written", file=sys.stderr)
    return 0 if written else Fault.SETUP.value
