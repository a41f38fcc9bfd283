"""Readers of global actions: what happens to the world."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu_openscenario.reading.actions import (
    AddEntityAction,
    DeleteEntityAction,
    EnvironmentAction,
    GlobalAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from basu_openscenario.reading.catalogs import referred
from basu_openscenario.reading.position_reading import read_position
from basu_openscenario.reading.traffic_reading import read_traffic_action

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_openscenario.reading.catalogs import Catalogs
    from basu_openscenario.reading.xml_node import Node

GROUPS = ("InfrastructureAction", "TrafficSignalAction", "UserDefinedAction")
"""Elements that only contain an action."""


def read_global_action(holder: Node, catalogs: Catalogs) -> GlobalAction:
    """Return the action inside a ``GlobalAction``.

    Raises:
        ScenarioError: it is not supported, or incomplete.
    """
    node = holder.only()
    while node.tag in GROUPS:
        node = node.only()
    if node.tag not in GLOBAL_ACTIONS:
        raise node.fault(f"<{node.tag}> is not supported as a global action; use one of {', '.join(GLOBAL_ACTIONS)}")
    return GLOBAL_ACTIONS[node.tag](node, catalogs)


def _environment(node: Node, catalogs: Catalogs) -> GlobalAction:
    """Return an ``EnvironmentAction``: all attributes below it, by the path of their element."""
    environment = referred(node, "Environment", catalogs)
    values: dict[str, str] = {}

    def gather(inside: Node, path: str) -> None:
        for name in (str(each) for each in inside.element.attrib):
            values[f"{path}{inside.tag}.{name}"] = inside.text(name)
        for child in inside.children():
            gather(child, f"{path}{inside.tag}/" if inside.tag != "Environment" else "")

    gather(environment, "")
    return EnvironmentAction(values)


def _entity(node: Node, catalogs: Catalogs) -> GlobalAction:
    """Return an ``EntityAction``: an entity is added or deleted."""
    name, inside = node.text("entityRef"), node.only()
    if inside.tag == "AddEntityAction":
        return AddEntityAction(name, read_position(inside.child("Position"), catalogs))
    if inside.tag == "DeleteEntityAction":
        return DeleteEntityAction(name)
    raise inside.fault(f"<{inside.tag}> is no action on an entity; use AddEntityAction or DeleteEntityAction")


def _variable(node: Node, _: Catalogs) -> GlobalAction:
    """Return a ``VariableAction`` or a ``ParameterAction``."""
    name = node.text("variableRef" if node.tag == "VariableAction" else "parameterRef").lstrip("$")
    inside = node.only()
    if inside.tag == "SetAction":
        return SetVariableAction(name, inside.text("value"))
    if inside.tag == "ModifyAction":
        rule = inside.child("Rule").only()
        if rule.tag == "AddValue":
            return ModifyVariableAction(name, "add", rule.number("value"))
        if rule.tag == "MultiplyByValue":
            return ModifyVariableAction(name, "multiply", rule.number("value"))
        inside = rule
    raise inside.fault(f"<{inside.tag}> is no change of a value; use SetAction, AddValue or MultiplyByValue")


def _signal(node: Node, _: Catalogs) -> GlobalAction:
    """Return a ``TrafficSignalStateAction``."""
    return TrafficSignalStateAction(node.text("name"), node.text("state"))


def _signal_controller(node: Node, _: Catalogs) -> GlobalAction:
    """Return a ``TrafficSignalControllerAction``."""
    return TrafficSignalControllerAction(node.text("trafficSignalControllerRef"), node.text("phase"))


GLOBAL_ACTIONS: dict[str, Callable[[Node, Catalogs], GlobalAction]] = {
    "EnvironmentAction": _environment,
    "EntityAction": _entity,
    "VariableAction": _variable,
    "ParameterAction": _variable,
    "TrafficSignalStateAction": _signal,
    "TrafficSignalControllerAction": _signal_controller,
    "TrafficAction": read_traffic_action,
}
"""The reader of each global action, by its element."""
