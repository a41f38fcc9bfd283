"""The declaration of an option: what one field of a settings model is called, means and may be.

A settings model is a frozen dataclass that inherits from ``Settings``. A field with a default by `option` is an option.
Its type, default and bounds hold for the command line, for JSON and for Python alike. The name of the field gives the
flag and the unit: ``timeout_s`` is ``--timeout S``, in s.
"""

from __future__ import annotations

import copy
import dataclasses
import difflib
import enum
import inspect
import math
import types
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

from basu.errors import UserError
from basu.units import parted

T = TypeVar("T")


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """What an option means. Numbers inside a mapping or a group of numbers have its bounds as well."""

    help: str
    flag: str | None = None  # on the command line; None: from the field's name
    positional: bool = False  # may be given without its flag
    in_files: str = ""  # it has no flag, since few need it: what to write instead of the one of earlier versions
    metavar: str | None = None  # None: from the type and the field's name
    unit: str = ""  # where the field's name does not end with it
    least: float = -math.inf
    most: float = math.inf
    above: float = -math.inf  # as `least`, but not itself allowed
    default_text: str | None = None  # shown instead of the default
    style: str | None = None  # how a value is written as text, where its type does not say it: a key of forms.STYLES
    bare: str | None = None  # the value of a flag that is given without one
    inverted: bool = False  # the flag sets False, as in --no-scenarios
    advice: str = ""  # ends a complaint about a value of the wrong type
    rival: str | None = None  # options of one rivalry exclude each other
    is_file: bool = False  # its texts name files, maybe with ":Class" behind them
    is_rare: bool = False  # it stands in documents where it differs from its default, and else is left out
    repeats: bool = True  # it belongs to what repeats a run; False: where and how long it is run, and what is shown


def option(default: T, help_: str, **more: Any) -> T:  # noqa: ANN401 - the further fields of Option
    """Return the field of an option, for use as the default of a model's field; ``more`` are fields of `Option`."""
    metadata = {Option: Option(help=help_, **more)}
    if isinstance(default, dict):
        return dataclasses.field(default_factory=lambda: copy.copy(default), metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


class Field(NamedTuple):
    """An option of a model with its name, type, default and group of the help page."""

    name: str
    type: Any
    default: Any
    option: Option
    group: str

    @property
    def flag(self) -> str:
        """The option on the command line."""
        return self.option.flag or f"--{parted(self.name)[0].replace('_', '-')}"

    @property
    def unit(self) -> str:
        """The unit of the value; empty where it has none."""
        return self.option.unit or parted(self.name)[1]

    @property
    def metavar(self) -> str | None:
        """What stands for the value on the help page; None for a flag without a value."""
        if self.option.metavar is None and not {int, float}.isdisjoint(alternatives(self.type)):
            return (parted(self.name)[1] or "N").upper().replace("²", "2")
        return self.option.metavar or "|".join(map(str, choices(self.type))) or None

    @property
    def names_files(self) -> bool:
        """Whether the values name files."""
        return self.option.is_file or Path in (*alternatives(self.type), *get_args(self.type))


def alternatives(kind: Any) -> tuple[Any, ...]:  # noqa: ANN401 - a type
    """Return the types of a union; for other types the type itself."""
    return get_args(kind) if get_origin(kind) in {types.UnionType, Union} else (kind,)


def choices(kind: Any) -> tuple[Any, ...]:  # noqa: ANN401 - a type
    """The values of a ``Literal``; none for other types."""
    return next((get_args(each) for each in alternatives(kind) if get_origin(each) is Literal), ())


class OptionError(UserError):
    """A value that an option cannot have. ``name`` is the field's, with ``.key`` for a value inside a mapping."""

    def __init__(self, name: str, value: object, must: str) -> None:
        """Say what the value must be."""
        super().__init__(f"{name} is {value!r}; it must be {must}")
        self.name, self.value, self.must = name, value, must


class Settings:
    """Base of settings models: every instance, however it was made, keeps the bounds of its options."""

    __slots__ = ()
    GROUP: ClassVar[str]  # the group of the model's own options on the help page
    FILE_FLAG: ClassVar[str] = ""  # the option that takes values of the model as JSON, in a file or as a text
    GONE: ClassVar[Mapping[str, str]] = {}  # options of earlier versions by field name, and what replaces each
    __pydantic_config__: ClassVar[Mapping[str, object]] = {"extra": "forbid", "allow_inf_nan": False}

    def __post_init__(self) -> None:
        """Check the bounds, then what the model itself demands."""
        for field in fields_of(type(self)):
            for name, value in _numbers(field.name, getattr(self, field.name)):
                if not _within(value, field.option):
                    raise OptionError(name, value, bounds(field.option))
        self.check()

    def check(self) -> None:
        """Raise UserError where options contradict each other."""

    @classmethod
    def completed(cls, values: Mapping[str, Any], source: str) -> dict[str, Any]:
        """Given values as the fields have them; ``source`` begins a complaint."""
        _ = source
        return dict(values)


class Layer(NamedTuple):
    """Values by field name as JSON has them, and where they were given."""

    values: Mapping[str, Any]
    source: str = ""  # begins a complaint: a file's path; empty for Python
    section: str = ""  # of the file
    typed: bool = False  # on the command line: a complaint names the flag

    def name(self, model: type, path: str) -> str:
        """What this layer calls an option, or a value inside one."""
        field, _, key = path.partition(".")
        if self.typed:
            flag = next((each.flag for each in fields_of(model) if each.name == field), field)
            return f"{flag} {key}".strip()
        key = ".".join(each for each in (self.section, path) if each)
        return f"{self.source}: {key}" if self.source else key


def gone_from(model: type) -> dict[str, str]:
    """Return the options that earlier versions of a model had, with the sentence about what replaces each."""
    return {name: sentence for base in model.__mro__ for name, sentence in vars(base).get("GONE", {}).items()}


def is_told(field: Field, options: Settings) -> bool:
    """Return whether documents have the value of an option."""
    return not field.option.is_rare or getattr(options, field.name) != field.default


_FIELDS: dict[type, tuple[Field, ...]] = {}


def fields_of(model: type) -> tuple[Field, ...]:
    """The options of a settings model, in the order of declaration."""
    if model not in _FIELDS:
        _FIELDS[model] = _read_fields(model)
    return _FIELDS[model]


def _read_fields(model: type) -> tuple[Field, ...]:
    hints = get_type_hints(model)
    bases = [base for base in reversed(model.__mro__) if issubclass(base, Settings) and "GROUP" in vars(base)]
    return tuple(
        Field(
            field.name,
            hints[field.name],
            field.default if field.default_factory is dataclasses.MISSING else field.default_factory(),
            field.metadata[Option],
            next(base.GROUP for base in bases if field.name in inspect.get_annotations(base)),
        )
        for field in dataclasses.fields(model)
        if Option in field.metadata
    )


def to_json(value: Any) -> Any:  # noqa: ANN401 - values of any option
    """A model or a value of one as JSON has it."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_json(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return to_json(value._asdict())
    if isinstance(value, enum.Enum | Path):
        return value.value if isinstance(value, enum.Enum) else str(value)
    if isinstance(value, Mapping):
        return {to_json(key): to_json(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(each) for each in value]
    return value


def suggestion(word: str, known: Iterable[str], *, or_all: bool = True) -> str:
    """A hint for a word that means nothing: the nearest that does, or all of them."""
    names = [str(name) for name in known]
    close = difflib.get_close_matches(word, names, 1)
    if close:
        return f"did you mean '{close[0]}'?"
    return f"there are {', '.join(names)}" if or_all else ""


def bounds(option: Option) -> str:
    """What a number must be, in words; empty where it may be any."""
    if option.least > -math.inf and option.most < math.inf:
        return f"in {option.least:g}..{option.most:g}"
    if option.above > -math.inf:
        return f"above {option.above:g}"
    if option.least > -math.inf:
        return f"{option.least:g} or more"
    return f"{option.most:g} or less" if option.most < math.inf else ""


def _within(value: float, option: Option) -> bool:
    return math.isfinite(value) and option.least <= value <= option.most and value > option.above


def _numbers(name: str, value: Any) -> list[tuple[str, float]]:  # noqa: ANN401 - values of any option
    """The numbers of an option's value with their names."""
    if isinstance(value, bool):
        return []
    if isinstance(value, int | float):
        return [(name, value)]
    plain = to_json(value)
    if isinstance(plain, dict):
        return [(f"{name}.{key}", each) for key, each in plain.items() if isinstance(each, int | float)]
    return []
