"""The command line of a settings model: arguments for argparse, what was typed, and the words that say the same."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from typing import Any, NoReturn

from basu.errors import UserError
from basu.settings.forms import form_of
from basu.settings.option import Field, Settings, bounds, fields_of, gone_from, suggestion

TYPED = "typed__"  # begins the names of options in the namespace
UNKNOWN = re.compile(r"unrecognized arguments: (.*)")
CHOICE = re.compile(r"argument (\S+): invalid choice: '(.*)' \(choose from (.*)\)")


class Parser(argparse.ArgumentParser):
    """A parser that knows no abbreviations and suggests an option for one that does not exist."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # noqa: ANN401 - as argparse has them
        """Make the parser; see argparse."""
        super().__init__(*args, **{"allow_abbrev": False, **kwargs})
        self.gone: dict[str, str] = {}  # flags of earlier versions, and what replaces each

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:  # noqa: ANN401 - as argparse has it
        """Parse; an option that does not exist is an error here, where the command's options are known."""
        found, rest = super().parse_known_args(args, namespace)
        unknown = [word for word in rest if word.startswith("-")]
        if unknown:
            name = unknown[0].partition("=")[0]
            if name in self.gone:
                self.error(f"{name} is no option any more: {self.gone[name]}")
            flags = [flag for action in self._actions for flag in action.option_strings if flag.startswith("--")]
            hint = suggestion(name, flags, or_all=False)
            self.error(f"there is no option {name}" + (f"; {hint}" if hint else ""))
        return found, rest

    def error(self, message: str) -> NoReturn:
        """End with a sentence, not with the list of all options.

        Raises:
            SystemExit: with status 2.
        """
        unknown = UNKNOWN.match(message)
        choice = CHOICE.match(message)
        if unknown is not None:
            message = f"'{unknown[1]}' is one word too many"
        elif choice is not None:
            known = [word.strip(" '") for word in choice[3].split(",")]
            message = f"{choice[1]} is '{choice[2]}', which means nothing; {suggestion(choice[2], known)}"
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` lists all options\n")


def add_options(parser: argparse.ArgumentParser, model: type[Settings], only: Iterable[str] | None = None) -> None:
    """Add a model's options to a parser, in their groups; ``only`` names the fields that are wanted."""
    wanted = None if only is None else set(only)
    if isinstance(parser, Parser) and wanted is None:
        parser.gone |= {f"--{name.replace('_', '-')}": sentence for name, sentence in gone_from(model).items()}
        parser.gone |= {field.flag: field.option.in_files for field in fields_of(model) if field.option.in_files}
    groups: dict[str, argparse._ArgumentGroup] = {}
    for field in fields_of(model):
        if (wanted is None or field.name in wanted) and not field.option.in_files:
            if field.group not in groups:
                groups[field.group] = next(
                    (each for each in parser._action_groups if each.title == field.group),  # noqa: SLF001
                    None,
                ) or parser.add_argument_group(field.group)
            _add(groups[field.group], field)


def typed(model: type[Settings], arguments: argparse.Namespace) -> dict[str, Any]:
    """The options of a model that were typed, as JSON values by field name.

    Raises:
        UserError: a text that the option cannot be.
    """
    found: dict[str, Any] = {}
    for field in fields_of(model):
        given = getattr(arguments, TYPED + field.name, None)
        again = getattr(arguments, TYPED + field.name + "_flag", None)
        if given and again:
            raise UserError(f"two values are given for {field.flag}, {given} and {again}; give one")
        value = again if given is None or given == [] else given
        if value is not None and value != []:
            found[field.name] = form_of(field).read(value)
    return found


def described(field: Field) -> str:
    """The help of an option: meaning, bounds, default."""
    option = field.option
    text = ", ".join(note for note in (option.help, field.unit and f"in {field.unit}", bounds(option)) if note)
    usual = default_text(field)
    return f"{text} (default: {usual})" if usual else text


def default_text(field: Field) -> str:
    """An option's default in words; empty where it says nothing."""
    if field.option.default_text is not None:
        return field.option.default_text
    if field.default is None or isinstance(field.default, bool) or field.default == ():
        return ""
    return re.sub(r"(\d)\.0\b", r"\1", form_of(field).text(field.default))


def _add(group: argparse._ArgumentGroup, field: Field) -> None:
    """Add one option to the parser."""
    form, option = form_of(field), field.option
    shown: dict[str, Any] = {"help": described(field).replace("%", "%%"), "default": None}
    if field.metavar is not None:
        shown["metavar"] = field.metavar
    if not option.positional:
        group.add_argument(field.flag, dest=TYPED + field.name, **form.arguments(), **shown)
        if field.type is bool and option.repeats:
            undo = f"undo {field.flag} of a --config"
            const = option.inverted
            group.add_argument(
                _opposite(field.flag), dest=TYPED + field.name, action="store_const", const=const, help=undo
            )
        return
    more = form.arguments() or {"nargs": "?"}
    group.add_argument(TYPED + field.name, **more, **shown)
    if option.flag is not None:
        same = "the same, in ScenarioRunner's way"
        group.add_argument(option.flag, dest=f"{TYPED}{field.name}_flag", metavar=field.metavar, help=same)


def _opposite(flag: str) -> str:
    """The flag that undoes a flag."""
    word = flag.removeprefix("--")
    return f"--with-{word.removeprefix('no-')}" if word.startswith("no-") else f"--no-{word}"
