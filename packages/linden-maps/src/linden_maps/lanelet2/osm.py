"""Lanelet2's file format: OSM XML, written and read."""

import math
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from linden.errors import UserError
from linden_maps.lanelet2.model import DIGITS, LaneletMap, LaneletPoint, LaneletWay, Member, Relation
from linden_maps.lanelet2.projection import NOWHERE, Projection, projection_of
from linden_maps.osm_xml import osm_root, tags_of

_LARGEST_ID = 2**63 - 1
_MOST_BYTES = 1 << 30


def osm_bytes(lanelet_map: LaneletMap) -> bytes:
    """Return the text of a map's ``.osm`` file; the same for the same map."""
    projection = projection_of(lanelet_map.geo_reference) or NOWHERE
    places = np.array([node[:3] for node in lanelet_map.nodes.values()]).reshape(-1, 3)
    latitude, longitude = (column.tolist() for column in projection.degrees(places[:, 0], places[:, 1]))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<osm version="0.6" generator="linden map convert">',
        f'  <MetaInfo format_version="{lanelet_map.format_version}" map_version="1"/>',
    ]
    for (number, node), lat, lon in zip(lanelet_map.nodes.items(), latitude, longitude, strict=True):
        lines.append(f'  <node id="{number}" lat="{lat:.11f}" lon="{lon:.11f}">')
        x, y, z = (f"{round(value, DIGITS) + 0.0:.{DIGITS}f}" for value in node[:3])  # no negative zeros
        lines.append(f'    <tag k="ele" v="{z}"/><tag k="local_x" v="{x}"/><tag k="local_y" v="{y}"/>')
        lines += [f"    <tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in node.tags.items()]
        lines.append("  </node>")
    for number, way in lanelet_map.ways.items():
        lines.append(f'  <way id="{number}">')
        lines += [f'    <nd ref="{node}"/>' for node in way.nodes]
        lines += [f"    <tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in way.tags.items()]
        lines.append("  </way>")
    for number, relation in lanelet_map.relations.items():
        lines.append(f'  <relation id="{number}">')
        lines += [f'    <member type="{kind}" ref="{ref}" role="{role}"/>' for kind, ref, role in relation.members]
        lines += [f"    <tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in relation.tags.items()]
        lines.append("  </relation>")
    lines.append("</osm>\n")
    return "\n".join(lines).encode()


def projector_info(lanelet_map: LaneletMap, *, transverse_mercator: bool = False) -> bytes:
    """Return ``map_projector_info.yaml``: Local, which lies on the point cloud for any georeference; or the map's own.

    Raises:
        UserError: Autoware's TransverseMercator is requested, and the map's projection has another origin than (0, 0).
    """
    if not transverse_mercator:
        return b"projector_type: Local\n"
    projection = projection_of(lanelet_map.geo_reference)
    if projection is None:
        raise UserError("the map has no <geoReference>, so it has no TransverseMercator; leave the projector out")
    if (projection.false_easting_m, projection.false_northing_m) != (0.0, 0.0):
        raise UserError("the map's projection has +x_0 or +y_0, which Autoware's lacks; leave the projector out")
    return (
        "projector_type: TransverseMercator\nvertical_datum: WGS84\nmap_origin:\n"
        f"  latitude: {projection.latitude_deg:.9f}\n  longitude: {projection.longitude_deg:.9f}\n  altitude: 0.0\n"
        f"scale_factor: {projection.scale:g}\n"
    ).encode()


class _LaneletReader:
    """Reads one file; complaints name it and the line."""

    def __init__(self, name: str) -> None:
        self.name = name

    def refuse(self, node: Any, what: str) -> UserError:  # noqa: ANN401 - an element of lxml
        """Return the error for an element."""
        return UserError(f"{self.name}, line {node.sourceline}: {what}")

    def number(self, node: Any, attribute: str) -> int:  # noqa: ANN401 - an element of lxml
        """Return an id of 64 bits; JOSM's new elements have negative ones."""
        try:
            value = int(node.get(attribute, ""))
        except ValueError:
            value = _LARGEST_ID + 1
        if not -_LARGEST_ID <= value <= _LARGEST_ID or value == 0:
            text = (node.get(attribute) or "")[:40]
            raise self.refuse(node, f"{attribute}={text!r} of <{node.tag}> is no whole number of 64 bits other than 0")
        return value

    def real(self, node: Any, text: str | None, what: str) -> float:  # noqa: ANN401 - an element of lxml
        """Return a finite number."""
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.refuse(node, f"{what} is {text!r}; it should be a number")
        return value


def read_osm(data: bytes, name: str, geo_reference: str = "") -> LaneletMap:
    """Return the map of an ``.osm`` file; places are local_x, local_y and ele, else projected.

    ``geo_reference`` is the projection for files without local_x and local_y; without one, their first node is the
    origin of a transverse Mercator projection.

    Raises:
        UserError: the text is no OSM XML, or says something that cannot be; with the file and the line.
    """
    too_large = f"{name} has more than 1 GiB; such maps are not read"
    root = osm_root(data, name, kind="a Lanelet2 map", most_bytes=_MOST_BYTES, too_large=too_large, huge=True)
    reader = _LaneletReader(name)
    found = LaneletMap(geo_reference=geo_reference)
    nodes = [node for node in root.iterchildren("node") if node.get("action") != "delete"]
    projection = projection_of(geo_reference) or _first_place(reader, nodes)
    for node in nodes:
        number, tags = reader.number(node, "id"), tags_of(node)
        ele = reader.real(node, tags.pop("ele", "0"), "ele")
        found.nodes[_fresh(reader, node, number, found.nodes)] = LaneletPoint(
            *_place(reader, node, tags, projection), ele, tags
        )
    for node in root.iterchildren("way"):
        if node.get("action") == "delete":
            continue
        number = _fresh(reader, node, reader.number(node, "id"), found.ways)
        refs = tuple(reader.number(child, "ref") for child in node.iterchildren("nd"))
        missing = next((ref for ref in refs if ref not in found.nodes), None)
        if missing is not None or not refs:
            what = f"names node {missing}, which is not there" if refs else "has no node"
            raise reader.refuse(node, f"way {number} {what}")
        found.ways[number] = LaneletWay(refs, tags_of(node))
    for node in root.iterchildren("relation"):
        if node.get("action") == "delete":
            continue
        number = _fresh(reader, node, reader.number(node, "id"), found.relations)
        members = tuple(
            Member(child.get("type", ""), reader.number(child, "ref"), child.get("role", ""))
            for child in node.iterchildren("member")
        )
        found.relations[number] = Relation(members, tags_of(node))
    _check_lanelets(reader, root, found)
    return found


def _fresh(reader: _LaneletReader, node: Any, number: int, known: dict[int, Any]) -> int:  # noqa: ANN401 - an element of lxml
    if number in known:
        raise reader.refuse(node, f"{node.tag} {number} stands twice")
    return number


def _first_place(reader: _LaneletReader, nodes: list[Any]) -> Projection:
    for node in nodes:
        if node.find("tag[@k='local_x']") is None:
            return Projection(*_degrees(reader, node), 1.0, 0.0, 0.0)
    return NOWHERE


def _place(reader: _LaneletReader, node: Any, tags: dict[str, str], projection: Projection) -> tuple[float, float]:  # noqa: ANN401
    if "local_x" in tags and "local_y" in tags:
        return reader.real(node, tags.pop("local_x"), "local_x"), reader.real(node, tags.pop("local_y"), "local_y")
    x_m, y_m = projection.metres(*_degrees(reader, node))
    if not (math.isfinite(x_m) and math.isfinite(y_m)):
        raise reader.refuse(node, "its latitude and longitude lie too far from the map's origin")
    return x_m, y_m


def _degrees(reader: _LaneletReader, node: Any) -> tuple[float, float]:  # noqa: ANN401 - an element of lxml
    latitude, longitude = (reader.real(node, node.get(key), key) for key in ("lat", "lon"))
    if abs(latitude) > 90.0 or abs(longitude) > 180.0:
        raise reader.refuse(node, f"latitude {latitude:g} and longitude {longitude:g} are no place on Earth")
    return latitude, longitude


def _check_lanelets(reader: _LaneletReader, root: Any, found: LaneletMap) -> None:  # noqa: ANN401 - an element of lxml
    """Raise UserError where a lanelet lacks a side."""
    elements = {int(node.get("id")): node for node in root.iterchildren("relation")}
    for number, lanelet in found.lanelets():
        for role in ("left", "right"):
            refs = lanelet.refs(role)
            if len(refs) != 1 or refs[0] not in found.ways:
                found_ways = f"way {refs[0]}, which is not there," if len(refs) == 1 else f"{len(refs)} ways"
                raise reader.refuse(elements[number], f"lanelet {number} has {found_ways} as its {role} bound")
