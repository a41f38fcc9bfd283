"""XML files of untrusted origin as nodes: limits of size and depth, no entities, sentences with file and line."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from basu.errors import ScenarioError
from basu_openscenario.reading.expressions import ExpressionError, Scope

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

LARGEST_FILE_BYTES = 32 * 1024 * 1024
"""A file above this is refused: the largest public scenario has 2 MB, the largest road network of a town 20 MB."""
PLACED = re.compile(r"[^\n]*?:\d+: ")
"""The begin of a sentence with file and line."""
DEEPEST = 64
"""Levels of elements: OpenSCENARIO's schema nests fewer than 30."""


@dataclass(frozen=True, slots=True)
class Node:
    """An element of a file, with the parameters that its attributes may name."""

    element: etree._Element
    path: Path
    scope: Scope

    @property
    def tag(self) -> str:
        """The name of the element."""
        return str(etree.QName(self.element).localname)

    @property
    def line(self) -> str:
        """The file and the line of this element, as messages name them."""
        return f"{self.path}:{self.element.sourceline}"

    def fault(self, sentence: str) -> ScenarioError:
        """Return an error that begins with file and line of this element."""
        return ScenarioError(f"{self.line}: {sentence}")

    def within(self, scope: Scope) -> Node:
        """Return this element with other parameters."""
        return Node(self.element, self.path, scope)

    def children(self, *tags: str) -> Iterator[Node]:
        """Yield the elements inside this one, all or those with one of these names."""
        for child in self.element.iterchildren(etree.Element):
            node = Node(child, self.path, self.scope)
            if not tags or node.tag in tags:
                yield node

    def find(self, tag: str) -> Node | None:
        """Return the first element inside of this name; None where there is none."""
        return next(self.children(tag), None)

    def child(self, tag: str) -> Node:
        """Return the first element inside of this name.

        Raises:
            ScenarioError: there is none.
        """
        found = self.find(tag)
        if found is None:
            raise self.fault(f"<{self.tag}> has no <{tag}>; add one")
        return found

    def only(self, *but: str) -> Node:
        """Return the one element inside, not counting elements named in ``but``.

        Raises:
            ScenarioError: there is none, or several.
        """
        found = [node for node in self.children() if node.tag not in but]
        if len(found) != 1:
            names = ", ".join(f"<{node.tag}>" for node in found) or "nothing"
            raise self.fault(f"<{self.tag}> contains {names}; it must contain exactly one element")
        return found[0]

    def has(self, name: str) -> bool:
        """Return whether there is an attribute of this name that is not empty."""
        return bool(self.element.get(name))

    def text(self, name: str, default: str | None = None) -> str:
        """Return an attribute with its parameters resolved.

        Raises:
            ScenarioError: it is missing without a default, or names a parameter that is not declared.
        """
        raw = self.element.get(name)
        if raw is None:
            if default is None:
                raise self.fault(f"<{self.tag}> has no attribute '{name}'; add it")
            return default
        try:
            return self.scope.resolve(raw)
        except ExpressionError as error:
            raise self.fault(f'{name}="{raw}" of <{self.tag}> cannot be resolved: {error}') from error

    def number(self, name: str, default: float | None = None) -> float:
        """Return an attribute as a number; infinite if the file says so.

        Raises:
            ScenarioError: it is missing without a default, or no number.
        """
        if default is not None and not self.has(name):
            return default
        text = self.text(name)
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if math.isnan(value):
            raise self.fault(f'{name}="{text}" of <{self.tag}> is no number; write one such as 3.5')
        return value

    def integer(self, name: str, default: int | None = None) -> int:
        """Return an attribute as a whole number.

        Raises:
            ScenarioError: it is missing without a default, or no whole number.
        """
        value = self.number(name, None if default is None else float(default))
        if not value.is_integer():
            raise self.fault(f'{name}="{value:g}" of <{self.tag}> is no whole number; write one such as 3')
        return int(value)

    def boolean(self, name: str, *, default: bool | None = None) -> bool:
        """Return an attribute as a truth value.

        Raises:
            ScenarioError: it is missing without a default, or neither ``true`` nor ``false``.
        """
        if default is not None and not self.has(name):
            return default
        text = self.text(name)
        if text.lower() not in {"true", "false", "1", "0"}:
            raise self.fault(f'{name}="{text}" of <{self.tag}> is neither true nor false; write one of them')
        return text.lower() in {"true", "1"}

    def choice(self, name: str, options: Sequence[str], default: str | None = None) -> str:
        """Return an attribute that is one of ``options``.

        Raises:
            ScenarioError: it is missing without a default, or another word.
        """
        if default is not None and not self.has(name):
            return default
        text = self.text(name)
        if text not in options:
            raise self.fault(f'{name}="{text}" of <{self.tag}> is not supported; write one of {", ".join(options)}')
        return text


def at_line(line: str, error: ScenarioError) -> ScenarioError:
    """Return an error with the file and the line of an element, unless it names a place itself."""
    return error if PLACED.match(str(error)) else ScenarioError(f"{line}: {error}")


def read_xml(path: Path, root: str, scope: Scope | None = None) -> Node:
    """Return the root element of a file.

    Args:
        path: the file.
        root: the name that its root element must have.
        scope: parameters that its attributes may name.

    Raises:
        ScenarioError: it cannot be read, is too large or too deep, defines entities, or is not of this kind.
    """
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE_BYTES:
            most = LARGEST_FILE_BYTES // 2**20
            raise ScenarioError(f"{path} has {size / 2**20:.0f} MiB; files up to {most} MiB are read")
        data = path.read_bytes()
    except OSError as error:
        raise ScenarioError(f"{path} cannot be read ({error.strerror}); give the path of a file that exists") from error
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        element = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        line = error.lineno or 1
        raise ScenarioError(f"{path}:{line}: this is not well-formed XML ({error.msg}); repair it") from error
    node = Node(element, path, scope or Scope())
    tree = element.getroottree()
    if tree.docinfo.internalDTD is not None:
        raise node.fault("the file has a document type definition, which can hide endless entities; remove it")
    if node.tag != root:
        raise node.fault(f"the root element is <{node.tag}>; a file of this kind begins with <{root}>")
    _check_depth(node)
    return node


def _check_depth(node: Node) -> None:
    """Refuse a file with elements that nest deeper than any of the standard's."""
    depth = 0
    for event, element in etree.iterwalk(node.element, events=("start", "end")):
        depth += 1 if event == "start" else -1
        if depth > DEEPEST:
            raise Node(element, node.path, node.scope).fault(
                f"elements nest deeper than {DEEPEST} levels; flatten them"
            )
