"""Arguments of ``basu sumo``."""

from __future__ import annotations

import argparse

from basu.cli.driving import SIMULATOR
from basu.cli.later import later
from basu.options.run import RunOptions
from basu.options.sumo import SUMO_DEMAND
from basu.outcome import EXIT_CODES
from basu.plugins import Command
from basu.settings.command_line import add_options

OF_SUMO = ("sumo_radius_m", "sumo_lights", "sumo_port", "sumo_hour", "sumo_scale", "vehicles", "seed")


def add_sumo(sumo: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu sumo``."""
    sumo.description = (
        "Show SUMO's traffic in a running simulator, in step with any program that ticks there; Ctrl+C ends it."
    )
    sumo.epilog = EXIT_CODES
    sumo.add_argument(
        "what",
        nargs="?",
        default=SUMO_DEMAND,
        metavar="WHAT",
        help="FILE.sumocfg, random (--vehicles N on random trips) or demand (of the town) (default: %(default)s)",
    )
    add_options(sumo, RunOptions, only=(*SIMULATOR, *OF_SUMO))
    sumo.add_argument("--tick", action="store_true", help="make the ticks: no other client does")
    sumo.add_argument(
        "--step", type=float, default=0.05, metavar="S", help="of SUMO, and of the ticks, in s (default: %(default)s)"
    )
    sumo.add_argument("--for", type=float, dest="limit", metavar="S", help="end after this simulated time, in s")
    sumo.set_defaults(command=later("basu_sumo.sumo_command:run"))


SUMO = Command("show SUMO's traffic beside any client of a running simulator", add_sumo)
