"""Catalogs: the folders that a scenario names, and the entries that it refers to."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from basu_openscenario.reading.parameters import declared
from basu_openscenario.reading.xml_node import Node, read_xml

if TYPE_CHECKING:
    from basu_openscenario.reading.expressions import Scope

DEEPEST_REFERENCES = 16
"""Entries that refer to entries: a chain longer than this is a circle."""


@dataclass(slots=True)
class Catalogs:
    """The catalogs of a scenario, read when a reference names them."""

    folders: list[Path] = field(default_factory=list)
    found: dict[str, Node] = field(default_factory=dict)

    def entry(self, reference: Node) -> Node:
        """Return the entry that a ``CatalogReference`` names, with its parameters assigned.

        Raises:
            ScenarioError: there is no such catalog or entry, or its parameters do not fit.
        """
        catalog_name, entry_name = reference.text("catalogName"), reference.text("entryName")
        catalog = self._catalog(reference, catalog_name)
        entries = {node.element.get("name"): node for node in catalog.children()}
        if entry_name not in entries:
            there = ", ".join(sorted(str(name) for name in entries))
            raise reference.fault(f"the catalog '{catalog_name}' has no entry '{entry_name}'; it has {there}")
        given: dict[str, str] = {}
        assignments = reference.find("ParameterAssignments")
        for one in () if assignments is None else assignments.children("ParameterAssignment"):
            given[str(one.element.get("parameterRef", "")).lstrip("$")] = one.text("value")
        entry = entries[entry_name]
        own = declared(entry, given)
        for name in given:
            if name not in own.values:
                raise reference.fault(f"the entry '{entry_name}' declares no parameter '{name}'; leave it out")
        return entry.within(reference.scope.with_values(own.values))  # files in use name the scenario's own as well

    def _catalog(self, reference: Node, name: str) -> Node:
        """Return a catalog by its name: files of its folders are read until one has it."""
        if name in self.found:
            return self.found[name]
        if not self.folders:
            raise reference.fault(f"the catalog '{name}' is named, but <CatalogLocations> has no folder; add one")
        for folder in self.folders:
            for file in sorted(folder.glob("*.xosc")):
                root = read_xml(file, "OpenSCENARIO")
                catalog = root.find("Catalog")
                if catalog is not None:
                    self.found.setdefault(catalog.text("name"), catalog)
                    self.found.setdefault(file.stem, catalog)  # files in use name the file, not the catalog
            if name in self.found:
                return self.found[name]
        there = ", ".join(str(one) if one.is_dir() else f"{one} (which does not exist)" for one in self.folders)
        raise reference.fault(f"no catalog '{name}' is in {there}; add its file or correct the name")


def catalogs_of(root: Node, scope: Scope) -> Catalogs:
    """Return the catalogs of the folders that a scenario names; none is read yet."""
    catalogs = Catalogs()
    block = root.find("CatalogLocations")
    for location in () if block is None else block.within(scope).children():
        catalogs.folders.append((root.path.parent / location.child("Directory").text("path")).resolve())
    return catalogs


def resolved(node: Node, catalogs: Catalogs) -> Node:
    """Return the element, or the entry that it refers to through references of references, with its own parameters.

    Raises:
        ScenarioError: references go in a circle, or lead nowhere.
    """
    if node.tag != "CatalogReference":
        return node.within(declared(node))
    steps = 0
    while node.tag == "CatalogReference":
        steps += 1
        if steps > DEEPEST_REFERENCES:
            raise node.fault("catalog references go in a circle; let one of them name an entry that is no reference")
        node = catalogs.entry(node)
    return node


def referred(parent: Node, tag: str, catalogs: Catalogs) -> Node:
    """Return the element ``tag`` inside ``parent``, written out or by reference.

    Raises:
        ScenarioError: there is neither.
    """
    reference = parent.find("CatalogReference")
    node = resolved(parent.child(tag) if reference is None else reference, catalogs)
    if node.tag != tag:
        raise parent.fault(f"<{parent.tag}> refers to a <{node.tag}>; it needs a <{tag}>")
    return node
