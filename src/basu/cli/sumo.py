"""``basu sumo``: SUMO's traffic beside any client of a running simulator."""

from __future__ import annotations

import argparse
from dataclasses import replace

from basu.cli.run import SIMULATOR, options_of, terminated_as_interrupted
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.options.sumo import SUMO_DEMAND, SUMO_OFF
from basu.outcome import EXIT_CODES
from basu.settings.command_line import add_options

OPTIONS = ("sumo_radius_m", "sumo_lights", "sumo_port", "sumo_hour", "sumo_scale", "vehicles", "seed")


def add_sumo(sumo: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu sumo``."""
    sumo.description, sumo.epilog = show_traffic.__doc__, EXIT_CODES
    sumo.add_argument(
        "what",
        nargs="?",
        default=SUMO_DEMAND,
        metavar="WHAT",
        help="FILE.sumocfg, random (--vehicles N on random trips) or demand (of the town) (default: %(default)s)",
    )
    add_options(sumo, RunOptions, only=(*SIMULATOR, *OPTIONS))
    sumo.add_argument("--tick", action="store_true", help="make the ticks: no other client does")
    sumo.add_argument(
        "--step", type=float, default=0.05, metavar="S", help="of SUMO, and of the ticks, in s (default: %(default)s)"
    )
    sumo.add_argument("--for", type=float, dest="limit", metavar="S", help="end after this simulated time, in s")
    sumo.set_defaults(command=show_traffic)


def show_traffic(arguments: argparse.Namespace) -> int:
    """Show SUMO's traffic in a running simulator, in step with any program that ticks there; Ctrl+C ends it."""
    if not arguments.step > 0.0:
        raise UserError(f"--step is {arguments.step:g}; give a time above 0 s, such as 0.05")
    if arguments.limit is not None and not arguments.limit > 0.0:
        raise UserError(f"--for is {arguments.limit:g}; give a time above 0 s")
    if arguments.what == SUMO_OFF:
        raise UserError("there is nothing to show with none; name random, demand or a FILE.sumocfg")
    options = replace(options_of(arguments), sumo=arguments.what)
    options.check()
    from basu.running.cosimulation import cosimulate  # noqa: PLC0415 - the client, which `--help` does not need

    with terminated_as_interrupted():
        print(
            cosimulate(options, step_s=arguments.step, makes_ticks=arguments.tick, limit_s=arguments.limit), flush=True
        )
    return 0
