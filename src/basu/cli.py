"""The command ``basu``: ``run`` drives and scores, ``score`` scores a record again, ``list`` shows what there is."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import basu
from basu.errors import AgentError, SimulatorError, UserError
from basu.metrics.infraction import Infraction
from basu.metrics.score import Scoring
from basu.options import RunOptions
from basu.outcome import Fault

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import FrameType

EXIT_CODES = (
    "exit status: 0 completed, 1 the agent failed, 2 something given was wrong, 3 the simulator failed, 130 interrupted"
)
LATER = {
    "record": "recording follows with the RecordingManager",
    "resume": "resuming an interrupted campaign follows with campaigns",
    "hud": "the head-up display follows",
    "sumo": "SUMO co-simulation follows with the TrafficManager",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; what a person can mend is one sentence and an exit code."""
    arguments = parser().parse_args(argv)
    try:
        code: int = arguments.command(arguments)
    except UserError as error:
        return _say(error, Fault.SETUP)
    except AgentError as error:
        return _say(error, Fault.AGENT)
    except SimulatorError as error:
        return _say(error, Fault.SIMULATOR)
    except KeyboardInterrupt:
        return _say("interrupted", Fault.USER)
    except Exception:  # noqa: BLE001 - a bug of ours: told in full, with an exit status that is nobody else's
        traceback.print_exc()
        return Fault.BENCHMARK.value
    return code


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    whole = argparse.ArgumentParser(prog="basu", description=basu.__doc__, epilog=EXIT_CODES)
    whole.add_argument("--version", action="version", version=f"basu {basu.__version__}")
    commands = whole.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_run(commands)
    score = commands.add_parser("score", help="score a run again, from its folder alone", description=score_run.__doc__)
    score.add_argument("folder", type=Path, metavar="RUN", help="a run's folder, such as runs/latest")
    score.add_argument("--json", action="store_true", help="print the judgement as JSON")
    _add_scoring(score)
    score.set_defaults(command=score_run)
    listing = commands.add_parser("list", help="show the agents and routes that come with BASU")
    listing.set_defaults(command=list_all)
    return whole


def _add_run(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``run``."""
    run = commands.add_parser(
        "run", help="drive a route and score the drive", description=run_agent.__doc__, epilog=EXIT_CODES
    )
    run.add_argument(
        "agent", nargs="?", metavar="AGENT", help="a name (`basu list`), FILE.py, or FILE.py:Class (default: basic)"
    )
    run.add_argument("--agent", dest="agent_option", metavar="AGENT", help="the same, in ScenarioRunner's way")
    run.add_argument("--host", help="a simulator that runs already (default: start one, end it afterwards)")
    run.add_argument("--port", type=int, default=2000, help="of --host (default: %(default)s)")
    run.add_argument(
        "--timeout", type=float, default=20.0, metavar="S", help="to wait for the simulator (default: %(default)s)"
    )
    run.add_argument("--routes", metavar="FILE", help="route XML (default: as the agent's config says)")
    run.add_argument("--route-id", metavar="ID", help="only this route of the file (default: all)")
    run.add_argument("--repetitions", type=int, default=1, metavar="N", help="(default: %(default)s)")
    run.add_argument("--seed", type=int, default=0, help="of all that is random (default: %(default)s)")
    run.add_argument(
        "--output", type=Path, default=Path("runs"), metavar="DIR", help="for run folders (default: %(default)s)"
    )
    run.add_argument(
        "--step-limit",
        type=float,
        default=10.0,
        metavar="S",
        help="wall time for one step of the agent (default: %(default)s)",
    )
    run.add_argument("--debug", action="store_true", help="show the traceback of an agent that fails")
    for name, why in LATER.items():
        run.add_argument(f"--{name}", action="store_true", help=f"not in this version: {why}")
    _add_scoring(run)
    run.set_defaults(command=run_agent)


def _add_scoring(command: argparse.ArgumentParser) -> None:
    """What is adjustable in the score."""
    kinds = ", ".join(kind.value for kind in Infraction)
    command.add_argument(
        "--penalty",
        action="append",
        default=[],
        metavar="KIND=FACTOR",
        help=f"what an infraction costs, 0..1; may be given several times; kinds: {kinds}",
    )
    command.add_argument(
        "--infraction-weight", type=float, metavar="W", help="path following weighs 1 - W (default: 0.8)"
    )


def run_agent(arguments: argparse.Namespace) -> int:
    """Drive an agent along its route, faster than real time, and leave a scored run folder."""
    for name, why in LATER.items():
        if getattr(arguments, name):
            raise UserError(f"--{name} is not there yet: {why}; run without it")
    if arguments.agent is not None and arguments.agent_option is not None:
        raise UserError(f"two agents are named, {arguments.agent} and {arguments.agent_option}; name one")
    if arguments.repetitions < 1:
        raise UserError(f"--repetitions is {arguments.repetitions}; it must be at least 1")
    for option in ("timeout", "step_limit"):
        if not getattr(arguments, option) > 0.0:
            raise UserError(f"--{option.replace('_', '-')} is {getattr(arguments, option)} s; it must be positive")
    options = RunOptions(
        agent=arguments.agent or arguments.agent_option or "basic",
        host=arguments.host,
        port=arguments.port,
        timeout_s=arguments.timeout,
        routes=arguments.routes,
        route_id=arguments.route_id,
        repetitions=arguments.repetitions,
        seed=arguments.seed,
        output=arguments.output,
        step_limit_s=arguments.step_limit,
        debug=arguments.debug,
    )
    scoring = adjusted(Scoring(), arguments)
    from basu.runner import run  # noqa: PLC0415 - brings in the client and the plots, which `--help` does not need

    before = signal.signal(signal.SIGTERM, _terminated)  # ends a run as Ctrl-C does: what was measured is written
    try:
        return run(options, scoring)
    finally:
        signal.signal(signal.SIGTERM, before)


def score_run(arguments: argparse.Namespace) -> int:
    """Compute scores and infractions of a run again, from its history and facts; no simulator is asked."""
    from basu.history.files import read_history  # noqa: PLC0415 - pyarrow, which `--help` does not need
    from basu.report.folder import CONFIG_FILE  # noqa: PLC0415 - likewise
    from basu.report.result import judgement  # noqa: PLC0415 - likewise

    folder: Path = arguments.folder
    if not folder.is_dir():
        raise UserError(f"{folder} is no folder; name a run's, such as runs/latest")
    history = read_history(folder)
    scoring = adjusted(read_scoring(folder / CONFIG_FILE), arguments)
    document = judgement(history, scoring)
    if arguments.json:
        print(json.dumps(document, indent=2, ensure_ascii=False))
        return 0
    for name, value in document["scores"].items():
        print(f"{name:<16}{value:8.3f}")
    for row in document["infractions"]:
        print(f"  {row['t_s']:8.1f} s  {row['kind']:<21} {row['detail']}")
    return 0


def list_all(_arguments: argparse.Namespace) -> int:
    """Show the agents and routes that come with BASU."""
    from basu.managers.agent_loader import BUILT_IN  # noqa: PLC0415 - brings in the client
    from basu.routing.route_file import read_routes  # noqa: PLC0415 - likewise
    from basu.utils.packaged import PACKAGE_FOLDER  # noqa: PLC0415 - likewise

    print("agents:")
    for name in BUILT_IN:
        print(f"  {name}")
    print("routes:")
    for path in sorted((PACKAGE_FOLDER / "routes").glob("*.xml")):
        for route in read_routes(path):
            stops = f", {len(route.stops)} service stops" if route.stops else ""
            print(f"  routes/{path.name}: {route.id} in {route.town}, {len(route.points)} points{stops}")
    return 0


def adjusted(scoring: Scoring, arguments: argparse.Namespace) -> Scoring:
    """``scoring`` with what the command line changed.

    Raises:
        UserError: a kind there is not, or a number that is none.
    """
    penalties = dict(scoring.penalties)
    for text in arguments.penalty:
        name, _, number = text.partition("=")
        try:
            penalties[Infraction(name)] = float(number)
        except ValueError:
            kinds = ", ".join(kind.value for kind in Infraction)
            raise UserError(f"--penalty {text}: write KIND=FACTOR, the kind one of {kinds}") from None
    weight = scoring.infraction_weight if arguments.infraction_weight is None else arguments.infraction_weight
    return Scoring(penalties=penalties, infraction_weight=weight, path_following_weight=1.0 - weight)


def read_scoring(path: Path) -> Scoring:
    """The scoring that a run was judged by, from its config; the thesis's where it says nothing.

    Raises:
        UserError: the file is not a run's config.
    """
    if not path.exists():
        return Scoring()
    try:
        given = json.loads(path.read_text(encoding="utf-8"))["scoring"]
        return Scoring(
            penalties={Infraction(kind): float(penalty) for kind, penalty in given["penalties"].items()},
            infraction_weight=given["infraction_weight"],
            path_following_weight=given["path_following_weight"],
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UserError(f"{path} is not the config of a run: {error!r}") from error


def _terminated(_number: int, _frame: FrameType | None) -> NoReturn:
    raise KeyboardInterrupt


def _say(sentence: object, fault: Fault) -> int:
    print(f"basu: {sentence}", file=sys.stderr)
    return fault.value
