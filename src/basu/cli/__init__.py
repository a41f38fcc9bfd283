"""The command ``basu``: one module a command, each with ``add(commands)``."""

from __future__ import annotations

import argparse
import os
import sys
import traceback
from typing import TYPE_CHECKING

import basu
from basu.cli import compare, experiment, list_, metrics, replay, report, run, scenario, score
from basu.errors import AgentError, SimulatorError, UserError
from basu.outcome import EXIT_CODES, Fault
from basu.utils import client_threads

if TYPE_CHECKING:
    from collections.abc import Sequence

COMMANDS = (run, scenario, score, report, compare, experiment, metrics, replay, list_)

UNREAD = 141  # 128 + SIGPIPE, as shells have it


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; what a person can mend is one sentence and an exit code."""
    try:
        code = _run(parser().parse_args(argv))
        sys.stdout.flush()
    except BrokenPipeError:  # who reads our output has seen enough, such as `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = UNREAD
    if client_threads.is_held():
        client_threads.leave(code)
    return code


def _run(arguments: argparse.Namespace) -> int:
    """The command's exit code, whatever becomes of it."""
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
    except BrokenPipeError:
        raise  # nobody reads what we say
    except Exception:  # noqa: BLE001 - a bug of ours: told in full, with an exit status that is nobody else's
        traceback.print_exc()
        return Fault.BENCHMARK.value
    return code


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    whole = argparse.ArgumentParser(prog="basu", description=basu.__doc__, epilog=EXIT_CODES)
    whole.add_argument("--version", action="version", version=f"basu {basu.__version__}")
    commands = whole.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add(commands)
    return whole


def _say(sentence: object, fault: Fault) -> int:
    print(f"basu: {sentence}", file=sys.stderr)
    return fault.value
