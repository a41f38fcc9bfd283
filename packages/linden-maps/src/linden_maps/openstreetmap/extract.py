"""An OpenStreetMap extract as frozen values: nodes, ways and relations of an ``.osm`` file, with their lines.

Source of the format: OpenStreetMap Wiki, "OSM XML", version 0.6. References to elements outside of the extract are
allowed there: every extract cuts ways and relations at its edge. Such references are left out and counted.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from linden.errors import UserError
from linden_maps.osm_xml import osm_root, tags_of

Tags = Mapping[str, str]

MOST_BYTES = 1 << 28
"""256 MiB: a large city. Streets of a whole country are no map to drive a shuttle on."""


class OsmNode(NamedTuple):
    """A place in degrees."""

    longitude_deg: float
    latitude_deg: float
    tags: Tags


class OsmWay(NamedTuple):
    """A line through nodes of the extract; ``line`` of the file."""

    id: int
    nodes: tuple[int, ...]
    tags: Tags
    line: int

    @property
    def is_closed(self) -> bool:
        """Whether it ends where it begins."""
        return len(self.nodes) > 3 and self.nodes[0] == self.nodes[-1]


class OsmMember(NamedTuple):
    """What a relation refers to."""

    kind: str
    ref: int
    role: str


class OsmRelation(NamedTuple):
    """Members with roles; ``line`` of the file."""

    id: int
    members: tuple[OsmMember, ...]
    tags: Tags
    line: int


class Extract(NamedTuple):
    """What an extract holds; ``dangling`` counts the references to nodes that the extract leaves out."""

    nodes: Mapping[int, OsmNode]
    ways: Mapping[int, OsmWay]
    relations: tuple[OsmRelation, ...]
    dangling: int


def read_extract(data: bytes, name: str) -> Extract:
    """Return the elements of an ``.osm`` file.

    Raises:
        UserError: the text is no OSM XML, or says something that cannot be; with the file and the line.
    """
    too_large = f"{name} has {len(data) >> 20} MiB; cut a part of at most {MOST_BYTES >> 20} MiB out of it"
    root = osm_root(data, name, kind="an OpenStreetMap extract", most_bytes=MOST_BYTES, too_large=too_large)
    reader = _ExtractReader(name)
    nodes: dict[int, OsmNode] = {}
    for element in _present(root, "node"):
        number = reader.fresh(element, nodes)
        longitude, latitude = reader.degrees(element, "lon", 180.0), reader.degrees(element, "lat", 90.0)
        nodes[number] = OsmNode(longitude, latitude, tags_of(element))
    ways: dict[int, OsmWay] = {}
    dangling = 0
    first_at = _first_at(nodes)
    for element in _present(root, "way"):
        number = reader.fresh(element, ways)
        refs = [reader.whole(child, "ref") for child in element.iterchildren("nd")]
        kept = tuple(first_at[nodes[ref][:2]] for ref in refs if ref in nodes)
        dangling += len(refs) - len(kept)
        ways[number] = OsmWay(number, _without_repeats(kept), tags_of(element), element.sourceline)
    relations = tuple(
        OsmRelation(
            reader.whole(element, "id"),
            tuple(
                OsmMember(child.get("type", ""), reader.whole(child, "ref"), child.get("role", ""))
                for child in element.iterchildren("member")
            ),
            tags_of(element),
            element.sourceline,
        )
        for element in _present(root, "relation")
    )
    if any(relation.tags.get("type") == "lanelet" for relation in relations):
        raise UserError(
            f"{name} is a Lanelet2 map, not an OpenStreetMap extract; `linden map convert {name} -o DIR` makes an "
            "Aisan map of it"
        )
    return Extract(nodes, ways, relations, dangling)


def _present(root: Any, tag: str) -> list[Any]:  # noqa: ANN401 - an element of lxml
    """Return the elements that the extract does not mark as deleted."""
    return [
        element
        for element in root.iterchildren(tag)
        if element.get("action") != "delete" and element.get("visible") != "false"
    ]


def _first_at(nodes: Mapping[int, OsmNode]) -> dict[tuple[float, float], int]:
    """Return the node that stands for all nodes of a place: one with tags if there is one, else the first."""
    found: dict[tuple[float, float], int] = {}
    for number, node in nodes.items():
        held = found.setdefault(node[:2], number)
        if node.tags and not nodes[held].tags:
            found[node[:2]] = number
    return found


def _without_repeats(nodes: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(node for place, node in enumerate(nodes) if place == 0 or node != nodes[place - 1])


class _ExtractReader:
    """Attributes with checks; each refusal names the file and the line."""

    def __init__(self, name: str) -> None:
        self._name = name

    def whole(self, element: Any, key: str) -> int:  # noqa: ANN401 - an element of lxml
        """Return a whole number of 64 bits."""
        text = element.get(key, "")
        try:
            value = int(text)
        except ValueError:
            value = 1 << 63
        if not -(1 << 63) <= value < 1 << 63:
            raise self._refuse(element, key, "a whole number of 64 bits")
        return value

    def fresh(self, element: Any, known: Mapping[int, object]) -> int:  # noqa: ANN401 - an element of lxml
        """Return the element's id, which no other element of its kind has."""
        number = self.whole(element, "id")
        if number in known:
            raise UserError(f"{self._name}, line {element.sourceline}: {element.tag} {number} stands twice")
        return number

    def degrees(self, element: Any, key: str, most: float) -> float:  # noqa: ANN401 - an element of lxml
        """Return an angle in degrees of at most ``most``."""
        to_number: Callable[[str], float] = float
        try:
            value = to_number(element.get(key, ""))
        except ValueError:
            value = float("nan")
        if not abs(value) <= most:
            raise self._refuse(element, key, f"degrees between {-most:g} and {most:g}")
        return value

    def _refuse(self, element: Any, key: str, wanted: str) -> UserError:  # noqa: ANN401 - an element of lxml
        found = element.get(key)
        shown = "is missing" if found is None else f"is {found[:40]!r}"
        return UserError(
            f"{self._name}, line {element.sourceline}: `{key}` of <{element.tag}> {shown}; it should be {wanted}"
        )
