"""The command ``basu``. A command's module is imported when the command is typed."""

from __future__ import annotations

import importlib
import os
import signal
import sys
import threading
import traceback
from typing import TYPE_CHECKING, NamedTuple, NoReturn

import basu
from basu import client_threads, plugins
from basu.errors import AgentError, SimulatorError, UserError
from basu.home import replaced_home
from basu.outcome import EXIT_CODES, Fault
from basu.settings.command_line import Parser
from basu.settings.option import suggestion

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence


class OwnCommand(NamedTuple):
    """A command, and the module of this package that has it: ``add_NAME(parser)`` there adds its arguments."""

    module: str
    help: str


COMMANDS = {
    "run": OwnCommand("driving", "drive a route and score the drive"),
    "scenario": OwnCommand("scenario", "list, play and draw traffic scenarios"),
    "campaign": OwnCommand("campaign", "drive thousands of jobs from one file, and report on them"),
    "score": OwnCommand("driving", "score a run again, from its folder alone"),
    "report": OwnCommand("results", "write report.html of a run again, from its folder alone"),
    "compare": OwnCommand("results", "put runs side by side"),
    "index": OwnCommand("results", "put all results of a folder on one page"),
    "experiment": OwnCommand("driving", "drive the thesis's test runs again"),
    "list": OwnCommand("results", "show the agents and routes that come with BASU"),
}

UNREAD = 141  # 128 + SIGPIPE, as shells have it


def entry_point() -> NoReturn:
    """Run the command of this process and end the process, even if a thread of the official client never ends."""
    code = main()
    if client_threads.is_held():
        client_threads.leave(code)
    sys.exit(code)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code; what a person can mend is one sentence."""
    words = sys.argv[1:] if argv is None else list(argv)
    replaced_home()  # before the official client is imported
    try:
        code = _run(words)
        sys.stdout.flush()
    except KeyboardInterrupt:  # a second one, while the first ended the command
        code = Fault.USER.value
    except BrokenPipeError:  # the reader of our output has seen enough, such as `head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = UNREAD
    if (agents := sys.modules.get("basu.agents.process.agent_process")) is not None:
        agents.end_unused()
    return code


def _run(words: Sequence[str]) -> int:
    """The command's exit code, whatever becomes of it."""
    try:
        arguments = parser(words).parse_args(words)
        code: int = arguments.command(arguments)
    except UserError as error:
        return _say(error, Fault.SETUP)
    except AgentError as error:
        return _say(error, Fault.AGENT)
    except SimulatorError as error:
        return _say(error, Fault.SIMULATOR)
    except KeyboardInterrupt as interruption:
        _ignore_further_interruptions()
        return _say(str(interruption) or "interrupted", Fault.USER)
    except BrokenPipeError:
        raise  # nothing reads our output
    except Exception:  # noqa: BLE001 - a bug of ours: shown in full, with an exit status of its own
        traceback.print_exc()
        return Fault.BENCHMARK.value
    return code


def parser(words: Sequence[str]) -> argparse.ArgumentParser:
    """The command line, with the arguments of the command that ``words`` begin with.

    Plugins bring further commands. They are looked for where the command is none of our own.

    Raises:
        UserError: there is no such command, or the plugin that has it is not installed.
    """
    whole = Parser(prog="basu", description=basu.__doc__, epilog=EXIT_CODES)
    whole.add_argument("--version", action="version", version=f"basu {basu.__version__}")
    commands = whole.add_subparsers(title="commands", required=bool(words), metavar="COMMAND")

    def show_help(_: argparse.Namespace) -> int:
        whole.print_help()
        return Fault.SETUP.value

    whole.set_defaults(command=show_help)  # without a command
    typed = next((word for word in words if not word.startswith("-")), None)
    for name, command in COMMANDS.items():
        one = commands.add_parser(name, help=command.help)
        if name == typed:
            getattr(importlib.import_module(f"basu.cli.{command.module}"), f"add_{name}")(one)
    if typed not in COMMANDS:
        _add_plugins(commands, typed)
    return whole


def _add_plugins(commands: argparse._SubParsersAction[Parser], typed: str | None) -> None:
    """Add the commands of the installed plugins, and the arguments of the one that is typed.

    Raises:
        UserError: no command has this name, or the plugin that has it is not installed.
    """
    offered = plugins.offered(plugins.COMMANDS)
    if typed is not None and typed not in offered:
        if typed in plugins.DISTRIBUTIONS[plugins.COMMANDS]:
            raise UserError(plugins.missing(plugins.COMMANDS, typed, f"`basu {typed}`"))
        raise UserError(f"there is no command '{typed}'; {suggestion(typed, [*COMMANDS, *offered])}")
    for name in offered:
        command: plugins.Command = plugins.load(plugins.COMMANDS, name, f"`basu {name}`")
        one = commands.add_parser(name, help=command.help)
        if name == typed:
            command.add(one)


def _ignore_further_interruptions() -> None:
    """Ignore Ctrl-C from now on: the command has ended, and a traceback of the way out helps no user."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _say(sentence: object, fault: Fault) -> int:
    print(f"basu: {sentence}", file=sys.stderr)
    return fault.value
