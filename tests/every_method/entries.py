"""Rows of the tables that are alike: constants of enums, fields of values, equality and printing."""

from collections.abc import Callable, Mapping
from typing import Any

import carla
import pytest

from every_method.call import Call, Defect
from every_method.stage import Stage


def constants(enum: str, **numbers: int) -> dict[str, Call]:
    """Return a row for each constant of an enum, with its number on the wire, and for ``names`` and ``values``."""

    def is_number(name: str, number: int) -> Call:
        return lambda _: int(getattr(getattr(carla, enum), name)) == number

    rows: dict[str, Call] = {f"{enum}.{name}": is_number(name, number) for name, number in numbers.items()}
    rows[f"{enum}.names"] = lambda _: {n: int(v) for n, v in getattr(carla, enum).names.items()} == numbers
    rows[f"{enum}.values"] = lambda _: {int(n) for n in getattr(carla, enum).values} == set(numbers.values())
    return rows


def fields(owner: str, of: Callable[[Stage], Any], **expected: Any) -> dict[str, Call]:
    """Return a row for each field of a value: it reads as expected and, where the client lets it be set, as set.

    Args:
        owner: class of which the fields are.
        of: makes or finds such a value.
        expected: what each field reads, or a function that says whether what it reads is plausible.
    """

    def reads(name: str, value: Any) -> Call:
        def call(stage: Stage) -> bool:
            held = of(stage)
            before = getattr(held, name)
            descriptor = getattr(type(held), name)
            if isinstance(descriptor, property) and descriptor.fset:
                setattr(held, name, before)
            return is_as_expected(before, value) and _same(getattr(held, name), before)

        return call

    return {f"{owner}.{name}": reads(name, value) for name, value in expected.items()}


def is_as_expected(got: Any, expected: Any) -> bool:
    """Whether a value is the expected one to the precision of a float of 32 bits, or passes the expected function."""
    if callable(expected):
        return bool(expected(got))
    if isinstance(expected, float):
        return bool(got == pytest.approx(expected, rel=1e-6, abs=1e-9))
    return bool(got == expected)


def _same(first: Any, second: Any) -> bool:
    """Whether two reads of one field are alike; values that cannot be compared are of one type at least."""
    return bool(first == second) or type(first) is type(second)


def comparisons(owner: str, one: Callable[[], Any], other: Callable[[], Any]) -> dict[str, Call]:
    """Return the rows of ``==``, ``!=`` and ``str`` of a value."""
    return {
        f"{owner}.__eq__": lambda _: one() == one() and not one() == other(),  # noqa: SIM201 - each operator by itself
        f"{owner}.__ne__": lambda _: one() != other() and not one() != one(),  # noqa: SIM202 - likewise
        f"{owner}.__str__": lambda _: len(str(one())) > 0,
    }


def vector(owner: str, make: Callable[[Stage], Any], element: Callable[[], Any]) -> dict[str, Call]:
    """Return the rows of one of the client's list classes."""

    def full(stage: Stage) -> Any:
        found = make(stage)
        found.append(element())
        return found

    def extended(stage: Stage) -> bool:
        found = make(stage)
        before = len(found)
        found.extend([element(), element()])
        return len(found) == before + 2

    def replaced(stage: Stage) -> bool:
        found = full(stage)
        found[0] = element()
        return len(found[0:1]) == 1

    def shortened(stage: Stage) -> bool:
        found = full(stage)
        before = len(found)
        del found[0]
        return len(found) == before - 1

    return {
        f"{owner}.__init__": lambda s: len(make(s)) == 0,
        f"{owner}.append": lambda s: len(full(s)) > 0,
        f"{owner}.extend": extended,
        f"{owner}.__len__": lambda s: len(full(s)) > 0,
        f"{owner}.__iter__": lambda s: len(list(full(s))) > 0,
        f"{owner}.__getitem__": lambda s: type(full(s)[0]) is type(element()),
        f"{owner}.__setitem__": replaced,
        f"{owner}.__delitem__": shortened,
        f"{owner}.__contains__": lambda s: isinstance(element() in full(s), bool),
        f"{owner}.__str__": lambda s: len(str(full(s))) > 0,
    }


def missing(owner: str, names: Mapping[str, str]) -> dict[str, Call]:
    """Return rows for names that only the stub has; each with what to call instead."""

    def lacks(name: str, instead: str) -> Call:
        return Defect(lambda _: getattr(_owner(owner), name), "AttributeError", f"only the stub has it; {instead}")

    return {f"{owner}.{name}": lacks(name, instead) for name, instead in names.items()}


def _owner(name: str) -> Any:
    found: Any = carla
    for part in name.split("."):
        found = getattr(found, part)
    return found
