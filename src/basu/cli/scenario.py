"""``basu scenario``: lists, plays and draws traffic scenarios."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from basu.cli.run import add_config, config_of, terminated_as_interrupted
from basu.errors import UserError
from basu.files import write_bytes
from basu.outcome import EXIT_CODES
from basu.settings.command_line import add_options, typed
from basu.settings.option import Layer

FORMS = ("text", "ascii", "svg", "dot", "json")  # of a drawn tree

if TYPE_CHECKING:
    from basu.running.scenario_runs.options import ScenarioOptions


def add_scenario(scenario: argparse.ArgumentParser) -> None:
    """Add the commands of ``basu scenario``."""
    actions = scenario.add_subparsers(title="commands", required=True, metavar="COMMAND")
    listing = actions.add_parser(
        "list", help="show scenarios, parameters and cases", description=list_scenarios.__doc__
    )
    add_list_options(listing)
    listing.set_defaults(command=list_scenarios)
    _add_run(actions.add_parser("run", help="play cases with agents"))
    _add_draw(actions.add_parser("draw", help="show a behaviour tree"))
    report = actions.add_parser("report", help="make the report of a run again", description=report_command.__doc__)
    report.add_argument("folder", type=Path, metavar="FOLDER", help="of a run, such as scenario-runs/latest")
    report.add_argument("--junit", type=Path, metavar="FILE", help="write the JUnit XML there as well")
    report.set_defaults(command=report_command)


def add_list_options(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario list``."""
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
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - numpy, not for other commands

    run.description, run.epilog = run_command.__doc__, EXIT_CODES
    add_config(run)
    add_options(run, ScenarioOptions)
    run.set_defaults(command=run_command)


def _add_draw(draw: argparse.ArgumentParser) -> None:
    """Add the arguments of ``basu scenario draw``."""
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - numpy, not for other commands

    draw.description = draw_command.__doc__
    draw.add_argument("case", metavar="WHAT", help="a case's id, or a scenario: its first case")
    add_options(draw, ScenarioOptions, only=("files", "host", "port", "timeout_s"))
    draw.add_argument("--form", choices=FORMS, default="text", help="(default: %(default)s)")
    draw.add_argument("--output", type=Path, metavar="FILE", help="write it there (default: show it)")
    draw.set_defaults(command=draw_command)


def _options(arguments: argparse.Namespace, below: Layer) -> ScenarioOptions:
    """The options of a command line, with those of ``below`` where it says nothing.

    Raises:
        UserError: an option that does not exist, or a value that it cannot have.
    """
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - numpy, not for other commands
    from basu.settings.resolve import resolve  # noqa: PLC0415 - pydantic, which `--help` does not need

    return resolve(ScenarioOptions, [below, Layer(typed(ScenarioOptions, arguments), typed=True)])


def list_scenarios(arguments: argparse.Namespace) -> int:
    """Show scenarios by group, with their parameters and cases."""
    from basu.scenarios.cases import files_among, open_library  # noqa: PLC0415 - every scenario, not for `--help`
    from basu.scenarios.listing import as_json, as_text, listed  # noqa: PLC0415 - likewise

    words: list[str] = arguments.what
    where = [_condition(text) for text in arguments.where]
    found = listed(open_library([*arguments.scenarios, *files_among(words)]), words, where)
    full = bool(words or where)
    print(json.dumps(as_json(found), indent=2) if arguments.json else "\n".join(as_text(found, full=full)))
    return 0


def _condition(text: str) -> tuple[str, str]:
    """A field and its value.

    Raises:
        UserError: it is no FIELD=VALUE.
    """
    field, sign, value = text.partition("=")
    if not (field and sign and value):
        raise UserError(f"--where {text}: it must be FIELD=VALUE, such as --where lighting=dark")
    return field, value


def run_command(arguments: argparse.Namespace) -> int:
    """Play cases with agents: a verdict, a picture and a folder for each, and the matrix of all."""
    from basu.running.scenario_runs.options import ScenarioOptions  # noqa: PLC0415 - numpy, not for other commands

    config = config_of(arguments, "scenario run", ScenarioOptions)
    options = _options(arguments, config.options)
    from basu.running.scenario_runs.command import run_scenarios  # noqa: PLC0415 - brings in the client and the plots

    with terminated_as_interrupted():
        return run_scenarios(options)


def draw_command(arguments: argparse.Namespace) -> int:
    """Draw the behaviour tree of a case as it stands before a run, with its criteria."""
    options = _options(arguments, Layer({"what": [arguments.case]}))
    from basu.running.scenario_runs.one_case import drawn  # noqa: PLC0415 - brings in the client

    text = drawn(options, arguments.form)
    if arguments.output is None:
        print(text)
    else:
        write_bytes(arguments.output, f"{text}\n".encode())
    return 0


def report_command(arguments: argparse.Namespace) -> int:
    """Make table, JUnit XML, page and maps of a run again, from what lies in its folder."""
    from basu.output.report.scenarios.matrix_documents import read_matrix  # noqa: PLC0415 - brings in what draws
    from basu.running.scenario_runs.command import report_again  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder.resolve()
    report_again(folder, read_matrix(folder), arguments.junit)
    return 0
