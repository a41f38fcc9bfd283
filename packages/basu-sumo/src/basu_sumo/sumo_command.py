"""``basu sumo``: SUMO's traffic beside any client of a running simulator."""

from __future__ import annotations

import argparse
from dataclasses import replace

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.options.sumo import SUMO_OFF
from basu_sumo.cosimulation import cosimulate


def run(arguments: argparse.Namespace) -> int:
    """Show SUMO's traffic in a running simulator, in step with any program that ticks there; Ctrl+C ends it."""
    if not arguments.step > 0.0:
        raise UserError(f"--step is {arguments.step:g}; give a time above 0 s, such as 0.05")
    if arguments.limit is not None and not arguments.limit > 0.0:
        raise UserError(f"--for is {arguments.limit:g}; give a time above 0 s")
    if arguments.what == SUMO_OFF:
        raise UserError("there is nothing to show with none; name random, demand or a FILE.sumocfg")
    options = replace(options_of(RunOptions, arguments), sumo=arguments.what)
    options.check()
    with terminated_as_interrupted():
        print(
            cosimulate(options, step_s=arguments.step, makes_ticks=arguments.tick, limit_s=arguments.limit), flush=True
        )
    return 0
