"""Declared parameters and variables, and the values that replace their defaults."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from basu.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu_openscenario.reading.expressions import Scope
    from basu_openscenario.reading.xml_node import Node

WIDEST = 1e6
"""The range of a number without constraints, to both sides."""


@dataclass(frozen=True, slots=True)
class Declaration:
    """A declared parameter: its type, its default, and the range that its constraints leave to a number."""

    kind: str
    value: str
    low: float = -WIDEST
    high: float = WIDEST


def declarations(node: Node) -> dict[str, Declaration]:
    """Return the parameters that an element declares, by name."""
    block = node.find("ParameterDeclarations")
    found = {}
    for one in () if block is None else block.children("ParameterDeclaration"):
        low, high = -WIDEST, WIDEST
        for limit in (
            limit for group in one.children("ConstraintGroup") for limit in group.children("ValueConstraint")
        ):
            rule = limit.text("rule")
            if rule in {"greaterOrEqual", "greaterThan"}:
                low = max(low, limit.number("value"))
            elif rule in {"lessOrEqual", "lessThan"}:
                high = min(high, limit.number("value"))
        name = one.text("name")
        value = node.scope.values.get(name, one.text("value", ""))
        found[name] = Declaration(one.text("parameterType"), value, low, high)
    return found


TYPES = ("boolean", "dateTime", "double", "int", "integer", "string", "unsignedInt", "unsignedShort")


def declared(node: Node, given: Mapping[str, str] | None = None) -> Scope:
    """Return the parameters of ``node`` and the parameters that its ``ParameterDeclarations`` add.

    Args:
        node: the element that contains the declarations.
        given: values that replace defaults, by name; names that are not declared here are left alone.

    Raises:
        ScenarioError: a value does not fit its type or its constraints, or a name is declared twice.
    """
    scope = node.scope
    seen: dict[str, str] = {}
    block = node.find("ParameterDeclarations")
    for each in () if block is None else block.within(scope).children("ParameterDeclaration"):
        entry = each.within(scope)
        name = entry.text("name")
        if seen.setdefault(name, entry.text("value", "")) != entry.text("value", ""):
            raise entry.fault(f"the parameter '{name}' is declared twice with different values; name one otherwise")
        value = (given or {}).get(name)
        if value is None:
            value = entry.text("value", "")
        check_type(entry, name, value, entry.choice("parameterType", TYPES))
        _check_constraints(entry, name, value)
        scope = scope.with_values({name: value})
    return scope


def check_type(node: Node, name: str, value: str, kind: str) -> None:
    """Check that a value is of its declared type.

    Raises:
        ScenarioError: it is not.
    """
    if kind in {"string", "dateTime"}:
        return
    if kind == "boolean":
        good = value.lower() in {"true", "false", "1", "0"}
    else:
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        good = not math.isnan(number)
        if kind != "double":
            good = good and number.is_integer() and (number >= 0 or not kind.startswith("unsigned"))
    if not good:
        raise node.fault(f"'{value}' of '{name}' is no {kind}; give one")


def within_constraints(root: Node, runs: Sequence[Mapping[str, str]]) -> list[Mapping[str, str]]:
    """Return the runs with values that fulfil the constraints of the parameters that a scenario declares.

    Args:
        root: of the scenario.
        runs: values by name.
    """
    block = root.find("ParameterDeclarations")
    nodes = [] if block is None else list(block.children("ParameterDeclaration"))
    if not any(True for node in nodes for _ in node.children("ConstraintGroup")):
        return list(runs)
    return [run for run in runs if _allows(nodes, run)]


def _allows(nodes: Sequence[Node], run: Mapping[str, str]) -> bool:
    """Return whether declarations, which may name those before them, allow a run."""
    scope = nodes[0].scope
    for node in nodes:
        entry = node.within(scope)
        name = entry.text("name")
        value = run[name] if name in run else entry.text("value", "")
        if not _fulfils(entry, value):
            return False
        scope = scope.with_values({name: value})
    return True


def _check_constraints(node: Node, name: str, value: str) -> None:
    """Check that a value fulfils one of the groups of constraints, where there are any."""
    if not _fulfils(node, value):
        raise node.fault(f"'{value}' of '{name}' is outside its constraints; give a value inside")


def _fulfils(node: Node, value: str) -> bool:
    """Return whether a value fulfils one of the groups of constraints of a declaration, where there are any."""
    groups = list(node.children("ConstraintGroup"))
    return not groups or any(all(_holds(one, value) for one in group.children("ValueConstraint")) for group in groups)


def _holds(constraint: Node, value: str) -> bool:
    """Return whether a value fulfils one constraint."""
    return compared(value, constraint.text("rule"), constraint.text("value"), constraint)


def compared(left: str, rule: str, right: str, node: Node) -> bool:
    """Return whether ``left`` and ``right`` stand in the relation ``rule``: as numbers where both are numbers.

    Raises:
        ScenarioError: the rule is unknown.
    """
    try:
        a: float | str = float(left)
        b: float | str = float(right)
    except ValueError:
        a, b = left, right
    results = {
        "equalTo": a == b,
        "notEqualTo": a != b,
        "greaterThan": a > b,  # type: ignore[operator]
        "lessThan": a < b,  # type: ignore[operator]
        "greaterOrEqual": a >= b,  # type: ignore[operator]
        "lessOrEqual": a <= b,  # type: ignore[operator]
    }
    if rule not in results:
        raise node.fault(f"the rule '{rule}' is unknown; write one of {', '.join(results)}")
    return results[rule]


def check_given(given: Mapping[str, str], scope: Scope, path: object) -> None:
    """Check that every given parameter is declared by the file.

    Raises:
        ScenarioError: one is not; names the declared ones.
    """
    for name in given:
        if name not in scope.values:
            there = ", ".join(scope.values) or "none"
            raise ScenarioError(f"{path} declares no parameter '{name}'; it declares {there}")
