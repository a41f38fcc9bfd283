"""Each command of ``basu`` and ``linden`` that README and docs show is one that the programs' parsers accept."""

import argparse

import pytest

import basu.cli
import linden.cli
from basu.errors import UserError
from docs.pages import Shown, command_in, commands

ALL = sorted(set(commands()))


def parser_of(words: tuple[str, ...]) -> argparse.ArgumentParser:
    return basu.cli.parser(words[1:]) if words[0] == "basu" else linden.cli.parser()


def named(words: tuple[str, ...]) -> tuple[argparse.ArgumentParser, tuple[str, ...]]:
    """The parser of the command that the words name, and the words behind the command."""
    parser, rest = parser_of(words), words[1:]
    while True:
        subcommands = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
        if not subcommands or not rest or rest[0].startswith("-"):
            return parser, rest
        assert rest[0] in subcommands[0].choices, f"{parser.prog} has no command {rest[0]}"
        parser, rest = subcommands[0].choices[rest[0]], rest[1:]


def ids(shown: Shown) -> str:
    return f"{shown.page}: {' '.join(shown.words)}"


@pytest.mark.parametrize("shown", [shown for shown in ALL if shown.in_block], ids=ids)
def test_each_command_in_a_block_parses(shown: Shown, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        parser_of(shown.words).parse_args(shown.words[1:])
    except SystemExit as end:  # 0 after --help and --version
        if end.code != 0:
            pytest.fail(capsys.readouterr().err)
    except UserError as error:
        pytest.fail(str(error))


@pytest.mark.parametrize("shown", [shown for shown in ALL if not shown.in_block], ids=ids)
def test_each_command_in_a_sentence_exists_and_has_the_options(shown: Shown) -> None:
    parser, rest = named(shown.words)
    known = {flag for action in parser._actions for flag in action.option_strings}
    given = {word.partition("=")[0] for word in rest if word.startswith("-")}
    assert given <= known, f"{parser.prog} has no option {', '.join(sorted(given - known))}"


def test_a_command_or_an_option_that_does_not_exist_is_found() -> None:
    with pytest.raises(UserError):
        named(command_in("    basu drive basic  # no such command"))
    with pytest.raises(AssertionError):
        named(command_in("linden map draw Linden"))
    with pytest.raises(SystemExit):
        parser_of(("linden",)).parse_args(command_in(".venv/bin/linden serve --no-such-option")[1:])


def test_many_commands_are_found() -> None:
    assert len(ALL) > 150
