"""A suite: the requirements of a standard, each with the cases that test it and the check that answers it.

A suite is a TOML file beside this module. Its cases are cases of the library with values, so each of them can be played
alone by its id. A value that begins with "$" is a parameter of the suite, which a file of the user can replace.
"""

from __future__ import annotations

import difflib
import itertools
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from basu.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

HERE = Path(__file__).parent
Numbers = tuple[float, ...]


class SuiteParameter(NamedTuple):
    """A parameter of a suite: one or several numbers."""

    name: str
    values: Numbers
    unit: str
    about: str
    origin: str  # of the figure: BASU, or the user's file


class Requirement(NamedTuple):
    """What a standard asks, and how it is tested."""

    id: str
    clause: str  # where the standard has it
    demand: str
    figures: str  # their origin
    test: str
    check: Mapping[str, Any]  # its kind, and what that needs; empty where it is not tested
    cases: tuple[str, ...]  # ids; empty where it is not tested
    untested: str  # the reason why it is not tested

    def document(self) -> dict[str, Any]:
        """Return it as plain values."""
        return {**self._asdict(), "check": dict(self.check), "cases": list(self.cases)}


class Suite(NamedTuple):
    """The requirements of a standard."""

    name: str
    title: str
    source: str
    about: tuple[str, ...]  # sentences: what it holds and what not
    parameters: tuple[SuiteParameter, ...]
    requirements: tuple[Requirement, ...]

    def document(self) -> dict[str, Any]:
        """Return it as plain values."""
        return {
            "name": self.name,
            "title": self.title,
            "source": self.source,
            "about": list(self.about),
            "parameters": [{**each._asdict(), "values": list(each.values)} for each in self.parameters],
            "requirements": [each.document() for each in self.requirements],
        }


def suite_names() -> tuple[str, ...]:
    """Return the names of all suites."""
    return tuple(sorted(path.stem for path in HERE.glob("*.toml")))


def read_suite(name: str, own: Mapping[str, Numbers] | None = None) -> Suite:
    """Return a suite; ``own`` has the user's values by parameter.

    Raises:
        ScenarioError: the suite has no such parameter.
    """
    document = tomllib.loads((HERE / f"{name}.toml").read_text(encoding="utf-8"))
    own = own or {}
    parameters = tuple(
        SuiteParameter(
            key,
            own.get(key, tuple(map(float, given["values"]))),
            given.get("unit", ""),
            given["about"],
            "your file" if key in own else "BASU",
        )
        for key, given in document.get("parameters", {}).items()
    )
    for key in own:
        if key not in document.get("parameters", {}):
            raise ScenarioError(
                f"the suite {name} has no parameter '{key}'; {_meant(key, [p.name for p in parameters])}"
            )
    values = {parameter.name: parameter.values for parameter in parameters}
    return Suite(
        name,
        document["title"],
        document["source"],
        tuple(document["about"]),
        parameters,
        tuple(_requirement(each, values, document.get("sets", {})) for each in document["requirement"]),
    )


def read_own_values(path: Path) -> dict[str, Numbers]:
    """Return the values of a user's parameter file: ``name = number`` or ``name = [numbers]`` in TOML.

    Raises:
        ScenarioError: it cannot be read, is no TOML, or has a value that is not a number.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"the parameters {path} cannot be read: {error.strerror}; name a TOML file") from error
    except ValueError as error:
        raise ScenarioError(f"the parameters {path} are no TOML: {error}; write lines such as `speed = 2.5`") from error
    return {name: _numbers(value, f"{path}: {name}") for name, value in document.items()}


def _numbers(value: object, place: str) -> Numbers:
    """Return a number or a list of numbers.

    Raises:
        ScenarioError: it is neither.
    """
    several: list[Any] = value if isinstance(value, list) else [value]
    if not several or any(isinstance(each, bool) or not isinstance(each, int | float) for each in several):
        raise ScenarioError(f"{place} is {value!r}; write a number, or several in brackets such as [0.8, 1.4]")
    return tuple(float(each) for each in several)


def _requirement(
    given: Mapping[str, Any], parameters: Mapping[str, Numbers], sets: Mapping[str, Sequence[Mapping[str, Any]]]
) -> Requirement:
    """Return a requirement with all its cases, of the sets that it names, and with the parameters in its check."""
    check = {
        key: parameters[value[1:]][0] if isinstance(value, str) and value.startswith("$") else value
        for key, value in given.get("check", {}).items()
    }
    ids = itertools.chain.from_iterable(_ids(each, parameters) for name in given.get("sets", ()) for each in sets[name])
    return Requirement(
        id=given["id"],
        clause=given["clause"],
        demand=given["demand"],
        figures=given["figures"],
        test=given.get("test", ""),
        check=check,
        cases=tuple(dict.fromkeys(ids)),
        untested=given.get("untested", ""),
    )


def _ids(given: Mapping[str, Any], parameters: Mapping[str, Numbers]) -> Iterator[str]:
    """Yield the ids of the cases: each of ``of`` with each combination of ``values``."""
    names = list(given.get("values", {}))
    columns = [_column(given["values"][name], parameters) for name in names]
    for case in given["of"]:
        for row in itertools.product(*columns):
            values = ",".join(f"{name}={value}" for name, value in zip(names, row, strict=True))
            yield f"{case}:{values}" if values else case


def _column(values: Any, parameters: Mapping[str, Numbers]) -> Sequence[str]:  # noqa: ANN401 - a value of TOML
    """Return the values of one parameter of a case as text."""
    if isinstance(values, str):
        values = parameters[values[1:]]
    return [value if isinstance(value, str) else f"{value:g}" for value in values]


def _meant(name: str, known: Sequence[str]) -> str:
    """Return a hint for a wrong name."""
    close = difflib.get_close_matches(name, known, 1)
    return f"did you mean '{close[0]}'?" if close else f"it has {', '.join(known) or 'none'}"
