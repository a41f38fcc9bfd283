"""The command ``linden``: ``serve`` a server, ``gate`` a gate before one, ``compile`` all kernels; plugins add more."""

import argparse
import os
import select
import sys
from collections.abc import Callable, Sequence

from linden import CARLA_VERSION, __version__
from linden.cli import compiling, gate, serve
from linden.errors import UserError

NOBODY_READS = 141
"""Exit code of a program after its output was closed, as the shell counts it: 128 and the number of SIGPIPE."""


PLUGINS = "linden.commands"
"""The group of entry points that bring commands; each names a function that adds its parser."""
DISTRIBUTIONS = {"map": "linden-maps"}
"""The distribution of this project that brings a command."""


def parser(typed: str | None = None) -> argparse.ArgumentParser:
    """Return the command line; each command says under ``command`` what carries it out.

    Plugins bring further commands. They are looked for where ``typed`` is none of our own.

    Raises:
        UserError: the plugin that has the command ``typed`` is not installed.
    """
    whole = argparse.ArgumentParser(prog="linden", description=f"A CARLA {CARLA_VERSION} server without Unreal or GPU.")
    whole.add_argument("--version", action="version", version=f"linden {__version__}, speaking CARLA {CARLA_VERSION}")
    commands = whole.add_subparsers(title="commands", required=True, metavar="COMMAND")
    serve.add_parser(commands)
    gate.add_parser(commands)
    compiling.add_parser(commands)
    if typed not in commands.choices:
        _add_plugins(commands, typed)
    return whole


def _add_plugins(commands: "argparse._SubParsersAction[argparse.ArgumentParser]", typed: str | None) -> None:
    """Add the commands of all installed plugins.

    Raises:
        UserError: the plugin that has the command ``typed`` is not installed, or cannot be loaded.
    """
    from importlib.metadata import entry_points  # noqa: PLC0415 - 20 ms that a server starts without

    found = {each.name: each for each in entry_points(group=PLUGINS)}
    if typed in DISTRIBUTIONS and typed not in found:
        missing = DISTRIBUTIONS[typed]
        raise UserError(
            f"`linden {typed}` needs {missing}, which is not installed; install it with: pip install {missing}"
        )
    for name, plugin in sorted(found.items()):
        try:
            add = plugin.load()
        except ImportError as error:
            why = f"the plugin that brings `linden {name}` cannot be loaded ({error}); install it again"
            if name == typed:
                raise UserError(why) from error
            print(f"linden: warning: {why}", file=sys.stderr)  # noqa: T201 - what a command says to its user
            continue
        add(commands)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command; a mistake of the user's is one sentence and exit code 2."""
    words = sys.argv[1:] if argv is None else argv
    if not words:
        parser().print_help()
        return 2
    try:
        arguments = parser(words[0]).parse_args(words)
        command: Callable[[argparse.Namespace], int] = arguments.command
        code = command(arguments)
        print(end="", flush=True)  # noqa: T201 - what waits to be printed; it need not have an end where stdout is closed
    except UserError as error:
        print(f"linden: {error}", file=sys.stderr)  # noqa: T201 - what a command says to its user
        return 2
    except BrokenPipeError:
        if _output_is_read():
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what is left to be written at the exit
        return NOBODY_READS
    return code


def _output_is_read() -> bool:
    """Return whether the output is still open: ``linden map check FILE | head`` stops reading early."""
    ends = select.poll()
    ends.register(sys.stdout.fileno(), 0)  # a closed end is reported without a request
    return not ends.poll(0)
