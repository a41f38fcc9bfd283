"""What of a scenario may vary: numbers with units and ranges, and choices; declared by the class, set by a case."""

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
