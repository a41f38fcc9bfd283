"""Command-line forms of option values: `Form` and its subclasses convert text to JSON values and back to arguments."""

from __future__ import annotations

import dataclasses
import enum
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeAlias, get_args, get_origin

from typing_extensions import override

from basu.errors import UserError
from basu.settings.option import Field, Settings, alternatives, fields_of, to_json

Value: TypeAlias = Any  # of any option: its type is that of the field


@dataclasses.dataclass(frozen=True, slots=True)
class Form:
    """A value that is one text."""

    field: Field

    def arguments(self) -> dict[str, Any]:
        """What argparse needs to know beside help and metavar."""
        bare = self.field.option.bare
        return {} if bare is None else {"nargs": "?", "const": bare}

    def read(self, given: Value) -> Value:
        """What was typed, as JSON has it; text that is no number stays text, for the check of types."""
        return _scalar(given, self.field.type)

    def words(self, value: Value, default: Value) -> list[str]:
        """The words that set ``value``, none where it is the default."""
        if value == default or value is None:
            return []
        text = self.text(value)
        if self.field.option.positional and not text.startswith("-"):
            return [text]
        return option_words(self.field.flag, text)

    def text(self, value: Value) -> str:
        """A value as it is typed."""
        return scalar_text(value)


class Switch(Form):
    """A flag without a value."""

    @override
    def arguments(self) -> dict[str, Any]:
        return {"action": "store_const", "const": not self.field.option.inverted}

    @override
    def read(self, given: Value) -> Value:
        return given

    @override
    def words(self, value: Value, default: Value) -> list[str]:
        return [] if value == default else [self.field.flag]


class Repeated(Form):
    """A list; the flag is given once for each entry."""

    @override
    def arguments(self) -> dict[str, Any]:
        return {"nargs": "*"} if self.field.option.positional else {"action": "append"}

    @override
    def read(self, given: Value) -> Value:
        entry = get_args(self.field.type)[0]
        return [_scalar(text, entry) for text in given]

    @override
    def words(self, value: Value, default: Value) -> list[str]:
        if value == default:
            return []
        texts = [scalar_text(each) for each in value]
        if self.field.option.positional:
            return texts
        return [word for text in texts for word in option_words(self.field.flag, text)]

    @override
    def text(self, value: Value) -> str:
        return " ".join(scalar_text(each) for each in value)


class Commas(Form):
    """A list in one text: ``a,b``."""

    @override
    def read(self, given: Value) -> Value:
        return [text for text in given.split(",") if text]

    @override
    def text(self, value: Value) -> str:
        return ",".join(scalar_text(each) for each in value)


class Pairs(Form):
    """Pairs of a name and a text: ``NAME=VALUE``, the flag once for each."""

    @override
    def arguments(self) -> dict[str, Any]:
        return {"action": "append"}

    @override
    def read(self, given: Value) -> Value:
        found = []
        for text in given:
            name, sign, value = text.partition("=")
            if not (name and sign and value):
                raise UserError(f"{self.field.flag} {text}: it must be NAME=VALUE, such as {self.field.flag} speed=1.5")
            found.append([name, value])
        return found

    @override
    def words(self, value: Value, default: Value) -> list[str]:
        pairs = [] if value == default else value
        return [word for name, text in pairs for word in option_words(self.field.flag, f"{name}={text}")]


class Named(Form):
    """Numbers by name: ``NAME=NUMBER``, the flag once for each that changes."""

    @override
    def arguments(self) -> dict[str, Any]:
        return {"action": "append"}

    @override
    def read(self, given: Value) -> Value:
        found: dict[str, float] = {}
        names = list(to_json(self.field.default))
        for text in given:
            name, _, number = text.partition("=")
            try:
                found[name] = float(number)
            except ValueError:
                shape = self.field.option.metavar or "NAME=NUMBER"
                raise UserError(
                    f"{self.field.flag} {text}: write {shape}, the name one of {', '.join(names)}"
                ) from None
        return found

    @override
    def words(self, value: Value, default: Value) -> list[str]:
        usual, given = to_json(default), to_json(value)
        changed = [f"{name}={scalar_text(number)}" for name, number in given.items() if number != usual.get(name)]
        return [word for text in changed for word in option_words(self.field.flag, text)]

    @override
    def text(self, value: Value) -> str:
        return ", ".join(f"{name}={scalar_text(number)}" for name, number in to_json(value).items())


STYLES: dict[str, type[Form]] = {"commas": Commas, "pairs": Pairs}


def form_of(field: Field) -> Form:
    """How the values of an option are written."""
    kind = field.type
    if field.option.style is not None:
        return STYLES[field.option.style](field)
    if kind is bool:
        return Switch(field)
    if get_origin(kind) is tuple:
        return Repeated(field)
    if get_origin(kind) is Mapping or dataclasses.is_dataclass(kind):
        return Named(field)
    return Form(field)


def words_of(settings: Settings, but: Iterable[str] = ()) -> list[str]:
    """The words of a command line that make ``settings``, without the fields in ``but``; defaults are not said."""
    positional: list[str] = []
    flags: list[str] = []
    in_files: dict[str, Value] = {}
    unsaid = set(but)
    for field in fields_of(type(settings)):
        value = getattr(settings, field.name)
        if field.option.in_files and value != field.default:
            in_files[field.name] = to_json(value)
        elif field.name not in unsaid:
            default = None if field.option.positional else field.default
            (positional if field.option.positional else flags).extend(form_of(field).words(value, default))
    return [*positional, *flags, *([settings.FILE_FLAG, json.dumps(in_files)] if in_files else [])]


def option_words(flag: str, text: str) -> list[str]:
    """An option with its value; argparse takes a value that begins with a dash only behind an equals sign."""
    return [f"{flag}={text}"] if text.startswith("-") else [flag, text]


def scalar_text(value: Value) -> str:
    """A value as text that is read back as the same value."""
    if isinstance(value, enum.Enum):
        return str(value.value)
    return repr(value) if isinstance(value, float) else str(value)


def _scalar(text: str, kind: Value) -> Value:
    """A text as a number, where the type has one and the text is one."""
    kinds = alternatives(kind)
    if str in kinds or Path in kinds:
        return text
    for number in (int, float):
        if number in kinds:
            try:
                return number(text)
            except ValueError:
                continue
    return text
