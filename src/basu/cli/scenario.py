"""``basu scenario``: lists, plays and draws traffic scenarios."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from basu.cli.driving import (
    add_agent_process,
    add_simulator,
    agent_process_of,
    check_positive,
    terminated_as_interrupted,
)
from basu.cli.scenario_list import add_list_options, list_scenarios
from basu.errors import UserError
from basu.outcome import EXIT_CODES
from basu.utils.atomic import write_bytes

FORMS = ("text", "ascii", "svg", "dot", "json")  # of a drawn tree

if TYPE_CHECKING:
    from basu.running.scenario_runs.options import ScenarioOptions
    from basu.scenarios.sampling import Design


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``scenario``."""
    scenario = commands.add_parser("scenario", help="list, play and draw traffic scenarios")
    actions = scenario.add_subparsers(title="commands", required=True, metavar="COMMAND")
    listing = actions.add_parser(
        "list", help="show scenarios, parameters and cases", description=list_scenarios.__doc__
    )
    add_list_options(listing)
    listing.set_defaults(command=list_scenarios)
    _add_run(actions)
    _add_draw(actions)
    report = actions.add_parser("report", help="make the report of a run again", description=report_command.__doc__)
    report.add_argument("folder", type=Path, metavar="FOLDER", help="of a run, such as scenario-runs/latest")
    report.add_argument("--junit", type=Path, metavar="FILE", help="write the JUnit XML there as well")
    report.set_defaults(command=report_command)


def _add_run(actions: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """``basu scenario run``."""
    run = actions.add_parser("run", help="play cases with agents", description=run_command.__doc__, epilog=EXIT_CODES)
    run.add_argument(
        "what", nargs="+", metavar="WHAT", help="all, a group, a scenario, a case's id, or a FILE.xml with cases"
    )
    run.add_argument(
        "--agent",
        dest="agents",
        action="append",
        metavar="AGENT",
        help="a name (`basu list`), FILE.py, or FILE.py:Class; may be given several times (default: basic)",
    )
    add_files(run)
    design = run.add_mutually_exclusive_group()
    design.add_argument("--sweep", type=int, metavar="N", help="play N samples of each case (Latin hypercube)")
    design.add_argument("--grid", type=int, metavar="K", help="play each case with K values of every number")
    run.add_argument("--vary", metavar="NAME[,NAME]", help="the parameters to sample (default: all)")
    run.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="give a parameter a value")
    run.add_argument(
        "--seed", type=int, default=0, help="of the samples; without --sweep, of chance in the drives (default: 0)"
    )
    run.add_argument("--vehicle", metavar="BLUEPRINT", help="to drive (default: as the case says)")
    add_simulator(run, "start our own")
    run.add_argument("--workers", type=int, metavar="N", help="simulators beside each other (default: one a processor)")
    run.add_argument("--step-limit", type=float, default=10.0, metavar="S", help="wall time for one step of the agent")
    add_agent_process(run)
    run.add_argument("--output", type=Path, default=Path("scenario-runs"), metavar="DIR", help="(default: %(default)s)")
    run.add_argument("--junit", type=Path, metavar="FILE", help="write the JUnit XML there as well")
    run.add_argument("--debug", action="store_true", help="show the traceback of an agent that fails")
    run.set_defaults(command=run_command)


def _add_draw(actions: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """``basu scenario draw``."""
    draw = actions.add_parser("draw", help="show a behaviour tree", description=draw_command.__doc__)
    draw.add_argument("what", metavar="WHAT", help="a case's id, or a scenario: its first case")
    add_files(draw)
    draw.add_argument("--form", choices=FORMS, default="text", help="(default: %(default)s)")
    draw.add_argument("--output", type=Path, metavar="FILE", help="write it there (default: show it)")
    add_simulator(draw, "start our own")
    draw.set_defaults(command=draw_command)


def add_files(parser: argparse.ArgumentParser) -> None:
    """Scenarios of one's own."""
    parser.add_argument(
        "--scenarios",
        action="append",
        default=[],
        type=Path,
        metavar="FILE",
        help="classes (FILE.py) or cases (FILE.xml) of your own; each brings the other of its name",
    )


def _options(arguments: argparse.Namespace) -> ScenarioOptions:
    """What was asked for.

    Raises:
        UserError: it makes no sense.
    """
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - brings in the client
    from basu.scenarios.sampling import Grid, Sweep  # noqa: PLC0415 - likewise

    check_positive(arguments, "timeout", "step_limit")
    in_process, agent_memory_gb = agent_process_of(arguments)
    workers = arguments.workers if arguments.workers is not None else len(os.sched_getaffinity(0))
    if workers < 1:
        raise UserError(f"--workers is {workers}; it must be at least 1")
    design: Design | None = None if arguments.sweep is None else Sweep(arguments.sweep, arguments.seed)
    if arguments.grid is not None:
        design = Grid(arguments.grid)
    return ScenarioOptions(
        what=tuple(arguments.what),
        files=tuple(arguments.scenarios),
        agents=tuple(arguments.agents or ["basic"]),
        design=design,
        vary=tuple(name for name in (arguments.vary or "").split(",") if name),
        fixed=tuple(_fixed(text) for text in arguments.set),
        host=arguments.host,
        port=arguments.port,
        timeout_s=arguments.timeout,
        vehicle=arguments.vehicle,
        seed=0 if isinstance(design, Sweep) else arguments.seed,  # of chance in the drives, which an id does not hold
        workers=workers,
        step_limit_s=arguments.step_limit,
        in_process=in_process,
        agent_memory_gb=agent_memory_gb,
        output=arguments.output,
        junit=arguments.junit,
        debug=arguments.debug,
    )


def _fixed(text: str) -> tuple[str, str]:
    """NAME=VALUE."""
    name, sign, value = text.partition("=")
    if not (name and sign and value):
        raise UserError(f"--set {text}: it must be NAME=VALUE, such as --set speed=1.5")
    return name, value


def run_command(arguments: argparse.Namespace) -> int:
    """Play cases with agents: a verdict, a picture and a folder for each, and the matrix of all."""
    options = _options(arguments)
    from basu.running.scenario_runs.command import run_scenarios  # noqa: PLC0415 - brings in the client and the plots

    with terminated_as_interrupted():
        return run_scenarios(options)


def draw_command(arguments: argparse.Namespace) -> int:
    """Draw the behaviour tree of a case as it stands before a run, with its criteria."""
    check_positive(arguments, "timeout")
    from basu.running.scenario_runs.draw import drawn  # noqa: PLC0415 - brings in the client
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - likewise

    text = drawn(
        ScenarioOptions(
            what=(arguments.what,),
            files=tuple(arguments.scenarios),
            host=arguments.host,
            port=arguments.port,
            timeout_s=arguments.timeout,
        ),
        arguments.form,
    )
    if arguments.output is None:
        print(text)
    else:
        write_bytes(arguments.output, f"{text}\n".encode())
    return 0


def report_command(arguments: argparse.Namespace) -> int:
    """Make table, JUnit XML, page and maps of a run again, from what lies in its folder."""
    from basu.output.report.scenarios.page.records import read_matrix  # noqa: PLC0415 - brings in what draws
    from basu.running.scenario_runs.leave import leave  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder.resolve()
    leave(folder, read_matrix(folder), arguments.junit)
    return 0
