"""Write docs/reference/command-line.md from the parsers of both programs: `make_command_line_page.py [--check]`."""
# ruff: noqa: SLF001 - argparse lists commands, groups and arguments in private names alone

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from generated_page import write_or_check

import basu.cli
import linden.cli
from basu import plugins

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "command-line.md"
HEAD = """# Command line

Generated from the programs' own parsers by `scripts/make_command_line_page.py`. `PROGRAM COMMAND --help` prints the
same. [Runs and options](../how-to/runs.md) explains the options of `basu run` in context.
"""


def page() -> str:
    """Return the whole page."""
    return "\n".join([HEAD, *(section(parser) for parser in all_parsers())])


def all_parsers() -> Iterator[argparse.ArgumentParser]:
    """Yield the parser of each program and each command, a program's own first."""
    yield from with_commands(basu.cli.parser([]), {*basu.cli.COMMANDS, *plugins.offered(plugins.COMMANDS)})
    yield from with_commands(linden.cli.parser(), ())


def with_commands(program: argparse.ArgumentParser, late: object) -> Iterator[argparse.ArgumentParser]:
    """Yield a parser and its commands' parsers; ``late`` names commands whose options exist once they are typed."""
    yield program
    for name, command in commands_of(program).items():
        if name in (late or ()):
            yield from with_commands(commands_of(basu.cli.parser([name]))[name], ())
        else:
            yield from with_commands(command, ())


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the commands of a parser by name, in their order."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return dict(action.choices)
    return {}


def section(parser: argparse.ArgumentParser) -> str:
    """Return a heading, the description, and a table of the arguments of each group."""
    level = "#" * (1 + len(parser.prog.split()[:2]))
    lines = [f"{level} `{parser.prog}`", ""]
    if parser.description:
        lines += [sentence(parser.description), ""]
    for group in parser._action_groups:
        rows = [row(action) for action in group._group_actions if not isinstance(action, argparse._HelpAction)]
        rows = [line for line in rows if line]
        if rows:
            title = (group.title or "").replace("positional arguments", "arguments")
            lines += [f"| {title} | meaning | default |", "|---|---|---|", *rows, ""]
    if parser.epilog:
        lines += [sentence(parser.epilog), ""]
    return "\n".join(lines)


def row(action: argparse.Action) -> str:
    """Return the row of one argument; commands are one row each."""
    if isinstance(action, argparse._SubParsersAction):
        return "\n".join(f"| `{choice.dest}` | {cell(choice.help)} | |" for choice in action._choices_actions)
    if action.help == argparse.SUPPRESS:
        return ""
    names = ", ".join(f"`{flag}{value_of(action)}`" for flag in action.option_strings)
    meaning, default = cell((action.help or "").replace("%(default)s", str(action.default))), ""
    found = re.search(r" ?\(default: (.*)\)$", meaning)
    if found:
        meaning, default = meaning[: found.start()], found[1]
    return f"| {names or f'`{value_of(action).strip() or action.dest}`'} | {meaning} | {default} |"


def value_of(action: argparse.Action) -> str:
    """Return the placeholder of an argument's value, with a space before it; empty for a flag."""
    if action.nargs == 0:
        return ""
    if isinstance(action.metavar, str):
        return f" {action.metavar.replace('|', '/')}"
    if action.choices is not None:
        return " " + "/".join(str(choice) for choice in action.choices)
    return f" {action.dest if not action.option_strings else action.dest.upper()}"


def cell(text: str | None) -> str:
    """Return a help text as the cell of a table."""
    return sentence((text or "").replace("%%", "%")).replace("|", "/")


def sentence(text: str) -> str:
    """Return a text on one line, with Markdown's backticks for those of reStructuredText."""
    return " ".join(text.split()).replace("``", "`").replace("<", "&lt;")


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: page()}))
