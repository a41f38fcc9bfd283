"""Arguments of ``basu scenario list``, ``run``, ``draw``, ``export``, ``report`` and ``risk``."""

from __future__ import annotations

import argparse
from pathlib import Path

from basu.cli.driving import add_config, add_scoring
from basu.cli.later import later
from basu.outcome import EXIT_CODES
from basu.running.scenario_runs.options import PLAYERS, ScenarioOptions
from basu.settings.command_line import add_options

FORMS = ("text", "ascii", "svg", "dot", "json")  # of a drawn tree


def add_scenario(scenario: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu scenario``."""
    actions = scenario.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_list(actions.add_parser("list", help="show scenarios, parameters and cases"))
    _add_run(actions.add_parser("run", help="play cases with agents"))
    _add_draw(actions.add_parser("draw", help="show a behaviour tree"))
    _add_export(actions.add_parser("export", help="write cases as OpenSCENARIO files"))
    report = actions.add_parser("report", help="make the report of a run again")
    report.description = "Make table, JUnit XML, page and maps of a run again, from what lies in its folder."
    report.add_argument("folder", type=Path, metavar="FOLDER", help="of a run, such as scenario-runs/latest")
    report.add_argument("--junit", type=Path, metavar="FILE", help="write the JUnit XML there as well")
    report.set_defaults(command=later("basu.cli.scenario_report:run"))
    _add_risk(actions.add_parser("risk", help="expected crashes and injuries for a million miles"))


def _add_risk(risk: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario risk``."""
    risk.description = (
        "Show the crashes, injuries, falls and disengagements that the agents of a run or a campaign are expected to "
        "have in a million miles, with intervals, and write risk.html and risk.json into its folder."
    )
    risk.add_argument(
        "folder", type=Path, metavar="FOLDER", help="of a run or a campaign, such as scenario-runs/latest"
    )
    risk.add_argument(
        "--encounters",
        type=Path,
        metavar="FILE",
        help="a TOML file with counted conflicts: events and miles by group (default: by table 1.1 of the thesis)",
    )
    risk.set_defaults(command=later("basu.cli.scenario_risk:run"))


def _add_list(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario list``."""
    command.description = "Show scenarios by group, with their parameters and cases."
    command.set_defaults(command=later("basu.cli.scenario_list:run"))
    command.add_argument(
        "what", nargs="*", metavar="WHAT", help="only these, in full: a type, a group, a case, FILE.xml (default: all)"
    )
    command.add_argument(
        "--scenarios",
        action="append",
        default=[],
        metavar="FILE",
        help="your own: FILE.py with classes or FILE.xml with cases; each brings the other of the same stem",
    )
    command.add_argument(
        "--where",
        action="append",
        default=[],
        metavar="FIELD=VALUE",
        help="only cases with this characteristic, such as lighting=dark; may be given several times",
    )
    command.add_argument("--json", action="store_true", help="as JSON, in full")


def _add_run(run: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario run``."""
    run.description = "Play cases with agents: a verdict, a picture and a folder for each, and the matrix of all."
    run.epilog = EXIT_CODES
    add_config(run)
    run.add_argument(
        "--resume",
        type=Path,
        metavar="FOLDER",
        help="continue a run that was broken off, such as scenario-runs/latest, with its own options",
    )
    add_options(run, ScenarioOptions)
    add_scoring(run)
    run.set_defaults(command=later("basu.cli.scenario_run:run"))


def _add_draw(draw: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario draw``."""
    draw.description = "Draw the behaviour tree of a case as it stands before a run, with its criteria."
    draw.add_argument("case", metavar="WHAT", help="a case's id, or a scenario: its first case")
    add_options(draw, ScenarioOptions, only=("files", "host", "port", "timeout_s"))
    draw.add_argument("--form", choices=FORMS, default="text", help="(default: %(default)s)")
    draw.add_argument("--output", type=Path, metavar="FILE", help="write it there (default: show it)")
    draw.set_defaults(command=later("basu.cli.scenario_draw:run"))


def _add_export(export: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario export``."""
    export.description = (
        "Write cases as OpenSCENARIO files, with their roads beside them, for esmini and other players."
    )
    export.set_defaults(command=later("basu.cli.scenario_export:run"))
    add_options(export, ScenarioOptions, only=("what", "files", "host", "port", "timeout_s"))
    export.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="PATH",
        help="FILE.xosc for one case, or a folder, which gets a file for each case",
    )
    export.add_argument(
        "--for",
        dest="player",
        choices=PLAYERS,
        default=PLAYERS[0],
        help="the program that plays it: esmini (and others of version 1.2) or ScenarioRunner (default: %(default)s)",
    )
