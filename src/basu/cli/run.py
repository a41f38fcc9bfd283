"""``basu run``: drives an agent along its route and scores the drive."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from basu.cli.driving import (
    add_agent_process,
    add_simulator,
    agent_process_of,
    check_positive,
    terminated_as_interrupted,
)
from basu.cli.hud import add_hud, hud_options
from basu.cli.scoring import add_scoring, adjusted
from basu.errors import UserError
from basu.metrics.score import Scoring
from basu.options import RunOptions, Traffic
from basu.outcome import EXIT_CODES
from basu.output.viewer.stream import require

LATER = {
    "sumo": "SUMO co-simulation follows with the TrafficManager",
}


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``run``."""
    run = commands.add_parser(
        "run", help="drive a route and score the drive", description=run_agent.__doc__, epilog=EXIT_CODES
    )
    run.add_argument(
        "agent", nargs="?", metavar="AGENT", help="a name (`basu list`), FILE.py, or FILE.py:Class (default: basic)"
    )
    run.add_argument("--agent", dest="agent_option", metavar="AGENT", help="the same, in ScenarioRunner's way")
    run.add_argument(
        "--agent-config", metavar="FILE", help="handed to the setup of an agent of the leaderboard or ScenarioRunner"
    )
    add_simulator(run, "start one, end it afterwards")
    _add_routes(run)
    run.add_argument("--weather", metavar="NAME", help="a preset of CARLA's (default: the route file's or the agent's)")
    run.add_argument("--vehicle", metavar="BLUEPRINT", help="to drive (default: the agent's)")
    _add_traffic(run)
    run.add_argument("--record", action="store_true", help="have the simulator write CARLA's log, recording.log")
    run.add_argument(
        "--viewer",
        action="store_true",
        help="stream the run to Rerun's viewer, and keep it as run.rrd beside the result",
    )
    _add_folders(run)
    run.add_argument(
        "--step-limit",
        type=float,
        default=10.0,
        metavar="S",
        help="wall time for one step of the agent (default: %(default)s)",
    )
    add_agent_process(run)
    run.add_argument("--debug", action="store_true", help="show the traceback of an agent that fails")
    for name, why in LATER.items():
        run.add_argument(f"--{name}", action="store_true", help=f"not in this version: {why}")
    add_hud(run)
    add_scoring(run)
    run.set_defaults(command=run_agent)


def _add_routes(run: argparse.ArgumentParser) -> None:
    """Which routes, how often."""
    run.add_argument("--routes", metavar="FILE", help="route XML (default: as the agent's config says)")
    which = run.add_mutually_exclusive_group()
    which.add_argument("--route-id", metavar="ID", help="only this route of the file (default: all)")
    which.add_argument("--routes-subset", metavar="LIST", help="only these routes of the file, such as 0-3,7")
    run.add_argument(
        "--no-scenarios", action="store_true", help="leave away the scenarios that the route file has on the way"
    )
    run.add_argument(
        "--scenarios",
        action="append",
        default=[],
        type=Path,
        metavar="FILE.py",
        help="classes for the scenarios of the route file; may be given several times",
    )
    run.add_argument("--repetitions", type=int, default=1, metavar="N", help="(default: %(default)s)")
    run.add_argument(
        "--seed",
        type=int,
        default=0,
        help="of all that is random; each further repetition has the next (default: %(default)s)",
    )


def _add_folders(run: argparse.ArgumentParser) -> None:
    """Where everything is left."""
    run.add_argument(
        "--output", type=Path, default=Path("runs"), metavar="DIR", help="for run folders (default: %(default)s)"
    )
    run.add_argument(
        "--series", metavar="NAME", help="keep all runs in a folder of this name, with their totals in series.json"
    )
    run.add_argument("--resume", action="store_true", help="go on with a --series that was broken off")


def _add_traffic(run: argparse.ArgumentParser) -> None:
    """Others on the road."""
    vehicles = run.add_mutually_exclusive_group()
    vehicles.add_argument(
        "--vehicles", type=int, default=0, metavar="N", help="others on the road, led by the Traffic Manager"
    )
    vehicles.add_argument(
        "--traffic-density", type=float, metavar="N", help="vehicles on a km of driving lane within 300 m of the route"
    )
    run.add_argument("--walkers", type=int, default=0, metavar="N", help="walkers on the pavements near the route")


def _traffic(arguments: argparse.Namespace) -> Traffic:
    """The traffic that was asked for.

    Raises:
        UserError: a number below zero.
    """
    for option in ("vehicles", "walkers", "traffic_density"):
        number = getattr(arguments, option)
        if number is not None and not 0 <= number < math.inf:
            raise UserError(f"--{option.replace('_', '-')} is {number}; it must be 0 or more")
    return Traffic(arguments.vehicles, arguments.walkers, arguments.traffic_density)


def _options(arguments: argparse.Namespace) -> RunOptions:
    """What was asked for.

    Raises:
        UserError: it makes no sense.
    """
    if arguments.agent is not None and arguments.agent_option is not None:
        raise UserError(f"two agents are named, {arguments.agent} and {arguments.agent_option}; name one")
    if arguments.repetitions < 1:
        raise UserError(f"--repetitions is {arguments.repetitions}; it must be at least 1")
    if arguments.resume and arguments.series is None:
        raise UserError("--resume goes on with a series; name it with --series, as when it was begun")
    check_positive(arguments, "timeout", "step_limit")
    in_process, agent_memory_gb = agent_process_of(arguments)
    return RunOptions(
        agent=arguments.agent or arguments.agent_option or "basic",
        agent_config=arguments.agent_config,
        host=arguments.host,
        port=arguments.port,
        timeout_s=arguments.timeout,
        routes=arguments.routes,
        route_id=arguments.route_id,
        routes_subset=arguments.routes_subset,
        repetitions=arguments.repetitions,
        seed=arguments.seed,
        weather=arguments.weather,
        vehicle=arguments.vehicle,
        traffic=_traffic(arguments),
        with_scenarios=not arguments.no_scenarios,
        scenario_files=tuple(arguments.scenarios),
        record=arguments.record,
        viewer=arguments.viewer,
        output=arguments.output,
        series=arguments.series,
        resume=arguments.resume,
        step_limit_s=arguments.step_limit,
        in_process=in_process,
        agent_memory_gb=agent_memory_gb,
        debug=arguments.debug,
        **hud_options(arguments)._asdict(),
    )


def run_agent(arguments: argparse.Namespace) -> int:
    """Drive an agent along its route, faster than real time, and leave a scored run folder."""
    for name, why in LATER.items():
        if getattr(arguments, name):
            raise UserError(f"--{name} is not there yet: {why}; run without it")
    options = _options(arguments)
    if options.viewer:
        require()
    scoring = adjusted(Scoring(), arguments)
    from basu.running.runner import run  # noqa: PLC0415 - brings in the client and the plots, which `--help` does not need

    with terminated_as_interrupted():
        return run(options, scoring)
