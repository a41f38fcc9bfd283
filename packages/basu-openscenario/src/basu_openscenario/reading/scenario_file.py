"""A scenario file as a whole: version, parameters, variables, entities, road network and storyboard."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from basu_openscenario.reading.catalogs import catalogs_of
from basu_openscenario.reading.entities import Entity
from basu_openscenario.reading.parameters import TYPES, Declaration, check_given, check_type, declarations, declared
from basu_openscenario.reading.references import check_references
from basu_openscenario.reading.storyboard import Storyboard, read_storyboard
from basu_openscenario.reading.trailers import read_entities
from basu_openscenario.reading.xml_node import read_xml

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu_openscenario.reading.xml_node import Node

VERSIONS = ("1.0", "1.1", "1.2", "1.3")
"""The versions of OpenSCENARIO XML that are read."""


@dataclass(frozen=True, slots=True)
class SignalPhase:
    """A phase of a controller of signals: its length in s and the state of each signal."""

    name: str
    duration_s: float
    states: dict[str, str]


@dataclass(frozen=True, slots=True)
class SignalController:
    """A controller of signals: phases one after the other, again and again; s after a reference's begin."""

    name: str
    phases: tuple[SignalPhase, ...]
    delay_s: float
    reference: str | None


@dataclass(frozen=True, slots=True)
class ScenarioFile:
    """A scenario as its file has it."""

    path: Path
    version: str
    description: str
    parameters: dict[str, str]
    declarations: dict[str, Declaration]
    variables: dict[str, str]
    road_file: Path | None
    signal_controllers: tuple[SignalController, ...]
    entities: dict[str, Entity]
    selections: dict[str, tuple[str, ...]]
    storyboard: Storyboard


def read_scenario(path: Path, given: Mapping[str, str] | None = None) -> ScenarioFile:
    """Return the scenario of a file.

    Args:
        path: the file.
        given: values of declared parameters, in the place of their defaults.

    Raises:
        ScenarioError: the file is broken, of an unknown version, or contains what is not supported.
    """
    root = read_xml(path, "OpenSCENARIO")
    version = _version(root)
    for tag in ("Catalog", "ParameterValueDistribution"):
        if root.find(tag) is not None:
            raise root.fault(f"the file contains a <{tag}>, no storyboard; give a file with a <Storyboard>")
    scope = declared(root, given)
    check_given(given or {}, scope, path)
    root = root.within(scope)
    catalogs = catalogs_of(root, scope)
    entities, selections = read_entities(root, catalogs)
    storyboard = read_storyboard(root.child("Storyboard"), catalogs)
    network = root.find("RoadNetwork")
    scenario = ScenarioFile(
        path,
        version,
        root.child("FileHeader").text("description", ""),
        dict(scope.values),
        declarations(root),
        _variables(root),
        None if network is None else _road_file(network),
        () if network is None else _signal_controllers(network),
        entities,
        selections,
        storyboard,
    )
    check_references(scenario)
    return scenario


def _version(root: Node) -> str:
    """Return the version of the file.

    Raises:
        ScenarioError: it is not one that is read.
    """
    header = root.child("FileHeader")
    version = f"{header.integer('revMajor')}.{header.integer('revMinor')}"
    if version not in VERSIONS:
        raise header.fault(f"version {version} is unknown; versions {', '.join(VERSIONS)} are read")
    return version


def _variables(root: Node) -> dict[str, str]:
    """Return the declared variables with their first values."""
    found: dict[str, str] = {}
    block = root.find("VariableDeclarations")
    for one in () if block is None else block.children("VariableDeclaration"):
        name, value = one.text("name"), one.text("value")
        check_type(one, name, value, one.choice("variableType", TYPES))
        found[name] = value
    return found


def _road_file(network: Node) -> Path | None:
    """Return the file of the road network; None where the scenario has no road."""
    logic = network.find("LogicFile")
    if logic is None or not logic.has("filepath"):
        return None
    path = (logic.path.parent / logic.text("filepath")).resolve()
    if not path.is_file():
        raise logic.fault(f"the road network {path} does not exist; correct its path")
    return path


def _signal_controllers(network: Node) -> tuple[SignalController, ...]:
    """Return the controllers of signals.

    Raises:
        ScenarioError: one has no phase with a duration, or refers to none or in a circle.
    """
    found = []
    block = network.find("TrafficSignals")
    nodes = [] if block is None else list(block.children("TrafficSignalController"))
    references = {one.text("name"): one.text("reference", "") for one in nodes}
    for node in nodes:
        _check_reference(node, references)
        phases = tuple(
            SignalPhase(
                one.text("name"),
                one.number("duration"),
                {state.text("trafficSignalId"): state.text("state") for state in one.children("TrafficSignalState")},
            )
            for one in node.children("Phase")
        )
        if not phases or sum(phase.duration_s for phase in phases) <= 0.0:
            raise node.fault(f"the controller '{node.text('name')}' has no phase with a duration; add one")
        reference = node.text("reference") if node.has("reference") else None
        found.append(SignalController(node.text("name"), phases, node.number("delay", 0.0), reference))
    return tuple(found)


def _check_reference(node: Node, references: dict[str, str]) -> None:
    """Refuse a controller of signals if its references lead to none, or in a circle."""
    name = node.text("name")
    seen = [name]
    while reference := references[seen[-1]]:
        if reference not in references:
            raise node.fault(f"the controller '{name}' refers to '{reference}', which does not exist; correct the name")
        if reference in seen:
            raise node.fault(f"the references of the controller '{name}' go in a circle; remove one of them")
        seen.append(reference)
