"""Arguments of ``basu service``: drive a service, compare agents in services, and falls of a recorded drive."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.driving import SIMULATOR
from basu.cli.later import later
from basu.options.run import RunOptions
from basu.plugins import Command
from basu.settings.command_line import add_options

OF_AGENTS = ("step_limit_s", "agent_memory_gb", "agent_writes", "track", "open", "debug")
OF_RUNS = ("routes", "route_id", "vehicles", "walkers", "weather", "output", "record")
OF_SUMO = ("sumo", "sumo_hour", "sumo_scale", "sumo_radius_m", "sumo_output")
USUAL_SEEDS = 5


def add_service(service: argparse.ArgumentParser) -> None:
    """Add the commands below ``basu service``."""
    service.description = "A shuttle service with passengers: vehicles under test on one route, and the persons on it."
    commands = service.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_run(commands.add_parser("run", help="drive a service and write its figures"))
    _add_compare(commands.add_parser("compare", help="drive the same services with two agents, and compare in pairs"))
    _add_falls(commands.add_parser("falls", help="how many standing passengers lose balance in a recorded drive"))


def _add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu service run``."""
    run.description = (
        "Drive two or more shuttles round after round, with persons that come, wait, board, ride and alight. "
        "The result is service.json and service.html in the run's folder."
    )
    add_options(run, RunOptions, only=("agent", "beside", "seed", *OF_AGENTS, *OF_RUNS, *OF_SUMO, *SIMULATOR))
    _add_conditions(run)
    run.set_defaults(command=later("basu_service.run_command:run"))


def _add_compare(compare: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu service compare``."""
    compare.description = (
        "Drive services with equal persons and seeds with two agents, and print means, differences with intervals and "
        "sign tests over the seeds."
    )
    compare.add_argument(
        "compared", nargs="+", metavar="AGENT|DIR", help="an agent to drive, or a folder of services that were driven"
    )
    compare.add_argument(
        "--seeds", type=int, default=USUAL_SEEDS, metavar="N", help="services with each agent (default: %(default)s)"
    )
    compare.add_argument(
        "--without",
        action="store_true",
        help="compare one agent's services with the same hours without the shuttle, both played by SUMO",
    )
    compare.add_argument(
        "--assume", metavar="FILE.json", help="assumptions of --without (default: those packaged for Linden)"
    )
    compare.add_argument("--json", type=Path, metavar="FILE.json", help="write each service's figures to a file")
    add_options(compare, RunOptions, only=("seed", *OF_AGENTS, *OF_RUNS, *OF_SUMO, *SIMULATOR, "workers", "resume"))
    _add_conditions(compare)
    compare.set_defaults(command=later("basu_service.compare_command:run"))


def _add_falls(falls: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu service falls``."""
    falls.description = (
        "Say how many of 100 standing passengers lose their balance at the strongest push of a recorded drive, "
        "with the interval of the model."
    )
    falls.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    falls.set_defaults(command=later("basu_service.falls_command:run"))


def _add_conditions(command: argparse.ArgumentParser) -> None:
    """Add what says how a service is operated."""
    group = command.add_argument_group("service")
    group.add_argument(
        "--shuttles", type=int, default=2, metavar="N", help="vehicles, equal times apart (default: %(default)s)"
    )
    group.add_argument(
        "--apart",
        type=float,
        metavar="MIN",
        help="between two vehicles at the start, by the timetable (default: equal times)",
    )
    group.add_argument(
        "--minutes", type=float, default=30.0, metavar="M", help="how long the service lasts (default: %(default)g)"
    )
    group.add_argument(
        "--demand", metavar="FILE.json", help="persons per stop and hour (default: an assumption for the LEAP)"
    )
    group.add_argument("--timetable", metavar="FILE.json", help="when vehicles are due (default: that of the route)")
    group.add_argument(
        "--no-holding", action="store_true", help="let vehicles leave a stop before their time in the timetable"
    )
    group.add_argument("--bodies", action="store_true", help="show persons that wait as walkers beside their stops")


SERVICE = Command("drive a shuttle service with passengers, and compare services", add_service)
