"""Parameters of a scenario: numbers with units and ranges, and choices; declared by the class, set by a case."""

from __future__ import annotations

import difflib
import math
from typing import TYPE_CHECKING, NamedTuple

from basu.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

Value = float | str


class Number(NamedTuple):
    """A parameter that is a number."""

    name: str
    default: float
    low: float
    high: float
    unit: str  # m, m/s, s, %; "" for a share
    about: str  # what it is, in half a line

    @property
    def unsaid(self) -> float:
        """The value where a case gives none; a default may be written as a whole number."""
        return float(self.default)

    def read(self, text: str) -> float:
        """The value of a text.

        Raises:
            ScenarioError: it is no number, or out of range.
        """
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not self.low <= value <= self.high:
            raise ScenarioError(
                f"the parameter '{self.name}' is '{text}'; it must be a number from {self.low:g} to {self.high:g} "
                f"{self.unit}".rstrip()
            )
        return value


class Choice(NamedTuple):
    """A parameter that is one of some words; the first is the default."""

    name: str
    options: tuple[str, ...]
    about: str
    unit: str = ""

    @property
    def default(self) -> str:
        """The first."""
        return self.options[0]

    @property
    def unsaid(self) -> str:
        """The value where a case gives none."""
        return self.default

    def read(self, text: str) -> str:
        """The value of a text.

        Raises:
            ScenarioError: it is none of the options.
        """
        if text not in self.options:
            raise ScenarioError(f"the parameter '{self.name}' is '{text}'; it must be one of {', '.join(self.options)}")
        return text


Parameter = Number | Choice


def narrowed(parameters: Sequence[Parameter], given: Mapping[str, str]) -> tuple[tuple[Parameter, ...], dict[str, str]]:
    """The parameters as a case narrows them for its place, and the values that it gives besides.

    ``<ahead value="30" low="25" high="38"/>`` leaves a number a part of its range, ``<side among="left opposite"/>`` a
    choice some of its options.

    Raises:
        ScenarioError: nothing is left, or what is left is more than was declared or lacks the value.
    """
    values, taken = dict(given), {parameter.name for parameter in parameters}
    left: list[Parameter] = []
    for parameter in parameters:
        ends = ("low", "high") if isinstance(parameter, Number) else ("among",)
        keys = {end: f"{parameter.name}_{end}" for end in ends}
        texts = {end: values.pop(key) for end, key in keys.items() if key in values and key not in taken}
        left.append(_narrowed(parameter, texts, said=parameter.name in values) if texts else parameter)
    return tuple(left), values


def _narrowed(parameter: Parameter, texts: Mapping[str, str], *, said: bool) -> Parameter:
    """One of them."""
    name = parameter.name
    if isinstance(parameter, Choice):
        wanted = [parameter.read(text) for text in texts["among"].split()]
        if not wanted:
            raise ScenarioError(f"'{name}' is left nothing; it may be among {' '.join(parameter.options)}")
        return parameter._replace(options=tuple(option for option in parameter.options if option in wanted))
    low, high = (parameter.read(texts.get(end, repr(getattr(parameter, end)))) for end in ("low", "high"))
    if not low < high:
        raise ScenarioError(f"'{name}' is to be from {low:g} to {high:g}; low must be below high")
    if not said and not low <= parameter.default <= high:
        raise ScenarioError(
            f"'{name}' is to be from {low:g} to {high:g}, and is {parameter.default:g} unless the case says otherwise; "
            f'write <{name} value="…"/>'
        )
    return parameter._replace(low=low, high=high)


def read_values(parameters: Sequence[Parameter], given: Mapping[str, str]) -> dict[str, Value]:
    """A value for every parameter: what a case gives, and the defaults for the rest, in the order of declaration.

    Raises:
        ScenarioError: a name that no parameter has, or a value that its parameter cannot take.
    """
    names = [parameter.name for parameter in parameters]
    for name in given:
        if name not in names:
            close = difflib.get_close_matches(name, names, 1)
            hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(names) or 'none'}"
            raise ScenarioError(f"it has no parameter '{name}'; {hint}")
    return {p.name: p.read(given[p.name]) if p.name in given else p.unsaid for p in parameters}
