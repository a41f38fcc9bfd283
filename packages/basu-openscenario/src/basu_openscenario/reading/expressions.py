"""Parameters and expressions of OpenSCENARIO: ``$name`` and ``${$name * 2}``, by a parser of its own."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|\$(?P<name>\w+)|(?P<word>[A-Za-z_]\w*)|(?P<mark>[-+*/%(),]))"
)
_NAME = re.compile(r"\$(\w+)")
_DEEPEST = 50  # brackets inside brackets

_FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "abs": (1, abs),
    "acos": (1, math.acos),
    "asin": (1, math.asin),
    "atan": (1, math.atan),
    "ceil": (1, math.ceil),
    "cos": (1, math.cos),
    "floor": (1, math.floor),
    "max": (2, max),
    "min": (2, min),
    "pow": (2, math.pow),
    "round": (1, lambda value: math.floor(value + 0.5)),
    "sign": (1, lambda value: math.copysign(1.0, value) if value else 0.0),
    "sin": (1, math.sin),
    "sqrt": (1, math.sqrt),
    "tan": (1, math.tan),
}
_CONSTANTS = {"pi": math.pi, "e": math.e}


class ExpressionError(Exception):
    """A parameter or an expression cannot be resolved; the text says why."""


@dataclass(frozen=True, slots=True)
class Scope:
    """The parameters that attributes of an element may name, with their values as text."""

    values: Mapping[str, str] = field(default_factory=dict)

    def with_values(self, more: Mapping[str, str]) -> Scope:
        """Return a scope with further parameters, which hide outer parameters of their names."""
        return Scope({**self.values, **more})

    def value_of(self, name: str) -> str:
        """Return the value of a parameter.

        Raises:
            ExpressionError: it is not declared.
        """
        if name not in self.values:
            raise ExpressionError(f"the parameter '{name}' is not declared here; declare it or correct the name")
        return self.values[name]

    def resolve(self, raw: str) -> str:
        """Return the text of an attribute, after parameters and expressions in it are replaced.

        Raises:
            ExpressionError: a parameter is not declared, or an expression has no value.
        """
        if raw.startswith("${") and raw.endswith("}"):
            inner = raw[2:-1].strip()
            return _plain(evaluated(inner, self))
        if raw.startswith("$") and _NAME.fullmatch(raw):
            return self.value_of(raw[1:])
        return raw


def _plain(value: float | str) -> str:
    """Return a value as an attribute has it, with all digits of a number."""
    if isinstance(value, str):
        return value
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def evaluated(text: str, scope: Scope) -> float | str:
    """Return the value of an expression; a text where it concatenates words.

    Raises:
        ExpressionError: it is no expression, or divides by zero.
    """
    try:
        return _Parser(text, scope).value()
    except (ValueError, OverflowError, ZeroDivisionError) as error:
        raise ExpressionError(f"'{text}' has no value ({error})") from error


class _Parser:
    """Recursive descent over the tokens of an expression: sums of products of signed factors."""

    def __init__(self, text: str, scope: Scope) -> None:
        """Split the text into tokens."""
        self.text, self.scope = text, scope
        self.tokens: list[tuple[str, str]] = []
        at = 0
        while at < len(text.rstrip()):
            match = _TOKEN.match(text, at)
            if match is None:
                raise ExpressionError(f"'{text[at:].strip()}' in '{text}' is not understood")
            kind = match.lastgroup
            assert kind is not None, "a match has one group"
            self.tokens.append((kind, match[kind]))
            at = match.end()
        self.at = 0

    def value(self) -> float | str:
        """Return the value of the whole text."""
        if any(kind == "word" and word not in _FUNCTIONS and word not in _CONSTANTS for kind, word in self.tokens):
            return self._joined()
        value = self._sum(0)
        if self.at < len(self.tokens):
            raise ExpressionError(f"'{self.text}' goes on behind its end with '{self.tokens[self.at][1]}'")
        return value

    def _joined(self) -> str:
        """Return words and parameters that ``+`` concatenates: esmini's files build names like this."""
        parts, expects_word = [], True
        for kind, word in self.tokens:
            if expects_word == (word == "+" and kind == "mark"):
                raise ExpressionError(f"'{self.text}' is neither arithmetic nor words that '+' joins")
            if expects_word:
                parts.append(self.scope.value_of(word) if kind == "name" else word)
            expects_word = not expects_word
        return "".join(parts)

    def _next(self) -> tuple[str, str]:
        """Return the token at hand; ("end", "") behind the last."""
        return self.tokens[self.at] if self.at < len(self.tokens) else ("end", "")

    def _takes(self, marks: str) -> str:
        """Return the mark at hand and pass it, where it is one of ``marks``; otherwise an empty text."""
        kind, word = self._next()
        if kind == "mark" and word in marks:
            self.at += 1
            return word
        return ""

    def _sum(self, depth: int) -> float:
        """Return the value of terms with plus and minus."""
        value = self._product(depth)
        while mark := self._takes("+-"):
            term = self._product(depth)
            value = value + term if mark == "+" else value - term
        return value

    def _product(self, depth: int) -> float:
        """Return the value of factors with times, divided by and modulo."""
        value = self._factor(depth)
        while mark := self._takes("*/%"):
            factor = self._factor(depth)
            value = value * factor if mark == "*" else value / factor if mark == "/" else math.fmod(value, factor)
        return value

    def _factor(self, depth: int) -> float:
        """Return the value of a number, a parameter, a function or a bracket, with its signs."""
        if depth > _DEEPEST:
            raise ExpressionError(f"'{self.text}' nests more than {_DEEPEST} brackets or signs")
        if mark := self._takes("+-"):
            value = self._factor(depth + 1)
            return -value if mark == "-" else value
        if self._takes("("):
            value = self._sum(depth + 1)
            self._closes()
            return value
        kind, word = self._next()
        self.at += 1
        if kind == "number":
            return float(word)
        if kind == "name":
            return self._number(word)
        if kind == "word" and word in _CONSTANTS:
            return _CONSTANTS[word]
        if kind == "word":
            return self._call(word, depth)
        raise ExpressionError(f"'{self.text}' lacks a value before '{word}'" if word else f"'{self.text}' ends early")

    def _number(self, name: str) -> float:
        """Return the value of a parameter as a number; true counts as 1."""
        text = self.scope.value_of(name)
        if text in {"true", "false"}:
            return float(text == "true")
        try:
            return float(text)
        except ValueError as error:
            raise ExpressionError(f"the parameter '{name}' is '{text}', which is no number") from error

    def _call(self, word: str, depth: int) -> float:
        """Return the value of a function."""
        takes, function = _FUNCTIONS[word]
        if not self._takes("("):
            raise ExpressionError(f"'{word}' in '{self.text}' needs brackets")
        values = [self._sum(depth + 1)]
        while self._takes(","):
            values.append(self._sum(depth + 1))
        self._closes()
        if len(values) != takes:
            raise ExpressionError(f"'{word}' in '{self.text}' has {len(values)} arguments; it takes {takes}")
        return float(function(*values))

    def _closes(self) -> None:
        """Pass a closing bracket."""
        if not self._takes(")"):
            raise ExpressionError(f"'{self.text}' lacks a closing bracket")
