"""Buildings, crossings and street furniture read from an OpenStreetMap extract.

Sources: OpenStreetMap Wiki, "Simple 3D Buildings" (``height``, ``building:levels``), "Tag:highway=crossing".
"""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from shapely import LineString, Point

from linden_maps.openstreetmap.extract import Extract, OsmRelation, Tags
from linden_maps.openstreetmap.graph import SegmentGraph
from linden_maps.openstreetmap.tags import TAGGED, metres

LEVEL_M = 3.0  # of a storey, as the Wiki's page on building:levels reckons
ROOF_M = 1.0
HEIGHT_M = {"garage": 3.0, "garages": 3.0, "shed": 2.5, "carport": 2.5, "roof": 4.0, "church": 12.0, "school": 9.0,
            "apartments": 10.0, "retail": 5.0, "commercial": 7.0, "industrial": 8.0, "warehouse": 8.0}  # fmt: skip
USUAL_HEIGHT_M = 6.5
"""Guessed heights where no tag says one: two storeys and a roof, or what such buildings usually have."""

_FURNITURE = {
    ("amenity", "bench"): "bench",
    ("amenity", "waste_basket"): "bin",
    ("amenity", "post_box"): "mailbox",
}
_UNPAINTED = frozenset({"unmarked", "informal", "no"})


class Footprint(NamedTuple):
    """A building: its ring of (longitude, latitude), closed, and its height."""

    id: str
    name: str
    kind: str
    ring: tuple[tuple[float, float], ...]
    height_m: float
    source: str


class Spot(NamedTuple):
    """A thing at a place in degrees; ``street`` is the id of the street that a crossing crosses, else empty."""

    id: str
    kind: str
    name: str
    place: tuple[float, float]
    street: str = ""


def buildings(extract: Extract) -> Iterator[Footprint]:
    """Yield the buildings with their whole outline in the extract, in the order of their ids."""
    outlines = {way.id: (way.nodes, way.tags) for way in extract.ways.values() if way.is_closed}
    for number, (nodes, tags) in sorted(outlines.items()):
        if _is_building(tags):
            yield _footprint(f"w{number}", nodes, tags, extract)
    for relation in sorted(extract.relations, key=lambda relation: relation.id):
        if relation.tags.get("type") == "multipolygon" and _is_building(relation.tags):
            for member in _outer(relation):
                nodes, tags = outlines.get(member, ((), {}))
                if nodes and not _is_building(tags):
                    yield _footprint(f"r{relation.id}.{member}", nodes, relation.tags, extract)


def height_of(tags: Tags) -> tuple[float, str]:
    """Return the height of a building in m and where it is known from."""
    given_m = metres(tags.get("height", tags.get("building:height", "")))
    if given_m is not None and 0.0 < given_m < 1000.0:
        return round(given_m, 2), TAGGED
    try:
        levels = float(tags.get("building:levels", ""))
    except ValueError:
        levels = 0.0
    if 0.0 < levels < 200.0:
        return round(levels * LEVEL_M + ROOF_M, 2), f"guessed from building:levels, {LEVEL_M:g} m each"
    kind = tags.get("building", "yes")
    return HEIGHT_M.get(kind, USUAL_HEIGHT_M), f"guessed from building={kind}"


def crossings(extract: Extract, graph: SegmentGraph) -> Iterator[Spot]:
    """Yield the painted crossings on streets."""
    street_of: dict[int, str] = {}
    for segment in graph.segments:
        for way in segment.ways:
            for node in extract.ways[way].nodes:
                street_of.setdefault(node, segment.id)
    for node, street in sorted(street_of.items()):
        tags = extract.nodes[node].tags
        if tags.get("highway") != "crossing" or tags.get("crossing") in _UNPAINTED:
            continue
        if tags.get("crossing:markings") == "no":
            continue
        place = extract.nodes[node][0], extract.nodes[node][1]
        yield Spot(str(node), "crossing", tags.get("name", ""), place, _nearest(graph, extract, node) or street)


def furniture(extract: Extract) -> Iterator[Spot]:
    """Yield benches, bins and mailboxes."""
    for number, node in sorted(extract.nodes.items()):
        for (key, value), kind in _FURNITURE.items():
            if node.tags.get(key) == value:
                yield Spot(str(number), kind, node.tags.get("name", ""), (node[0], node[1]))


def _nearest(graph: SegmentGraph, extract: Extract, node: int) -> str | None:
    """Return the id of the street that passes a node, None where none of its way's pieces does."""
    point = Point(graph.metres[node])
    best: tuple[float, str] | None = None
    for segment in graph.segments:
        if any(node in extract.ways[way].nodes for way in segment.ways):
            far_m = LineString([graph.metres[each] for each in segment.nodes]).distance(point)
            best = min(best, (far_m, segment.id)) if best else (far_m, segment.id)
    return best[1] if best else None


def _outer(relation: OsmRelation) -> list[int]:
    return [member.ref for member in relation.members if member.kind == "way" and member.role in {"outer", ""}]


def _is_building(tags: Tags) -> bool:
    return tags.get("building", "no") != "no" and tags.get("location") != "underground"


def _footprint(identity: str, nodes: tuple[int, ...], tags: Mapping[str, Any], extract: Extract) -> Footprint:
    ring = tuple((extract.nodes[node][0], extract.nodes[node][1]) for node in nodes)
    height_m, source = height_of(tags)
    name = tags.get("name") or " ".join(
        part for part in (tags.get("addr:housenumber"), tags.get("addr:street")) if part
    )
    return Footprint(identity, name, tags.get("building", "yes"), ring, height_m, source)
