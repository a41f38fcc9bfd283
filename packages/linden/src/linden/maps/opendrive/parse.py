"""OpenDRIVE text to a map. Hostile text is refused: no DTD, no entities, no network, numbers finite."""

import hashlib
import re
from collections.abc import Iterable, Iterator
from typing import Any, cast
from weakref import WeakValueDictionary

from lxml import etree

from linden.background import NotWantedError, checkpoint, young_collector
from linden.maps.opendrive.limits import LONGEST_TOTAL_M, MOST_ELEMENTS, MOST_SIGNALS, MapError, refuse_beyond
from linden.maps.opendrive.model import OpenDrive, Road
from linden.maps.opendrive.reading.attributes import line_of
from linden.maps.opendrive.reading.roads import read_junction, read_road
from linden.maps.opendrive.reading.roadside import read_controllers

_in_use: WeakValueDictionary[bytes, OpenDrive] = WeakValueDictionary()

_CDATA = re.compile(r"^\s*<!\[CDATA\[(.*?)\]\]>", re.DOTALL)


def parse(text: str | bytes) -> OpenDrive:
    """Return the map an OpenDRIVE text describes; the same object for the same text, as long as it is referenced.

    Raises:
        MapError: the text is no XML, no OpenDRIVE, or says something that cannot be; with the line.
    """
    digest = hashlib.sha256(text.encode() if isinstance(text, str) else text).digest()
    found = _in_use.get(digest)
    if found is None:
        with young_collector():
            found = _in_use[digest] = _read(_root(text))
    return found


def _read(root: etree._Element) -> OpenDrive:
    roads = _read_roads(root)
    junctions = tuple(read_junction(node) for node in root.iterchildren("junction"))
    _refuse_repeated("road", [(road.id, road.source_line) for road in roads])
    _refuse_repeated("junction", [(junction.id, junction.source_line) for junction in junctions])
    header = root.find("header")
    return OpenDrive(
        name="" if header is None else header.get("name", ""),
        geo_reference=_geo_reference(root),
        roads=roads,
        junctions=junctions,
        controllers=read_controllers(root),
    )


def _read_roads(root: etree._Element) -> tuple[Road, ...]:
    """Return the roads; where there are too many, those read so far are freed one by one, so that others may go on."""
    roads: list[Road] = []
    total_m, signals = 0.0, 0
    try:
        for node in _wanted(root.iterchildren("road")):
            road = read_road(node)
            if road is not None:
                roads.append(road)
                total_m, signals = total_m + road.length_m, signals + len(road.signals)
                refuse_beyond(total_m / 1000.0, LONGEST_TOTAL_M / 1000.0, "km of roads")
                refuse_beyond(signals, MOST_SIGNALS, "signals")
    except (MapError, NotWantedError):
        while roads:
            roads.pop()
        raise
    return tuple(roads)


def _wanted(nodes: Iterable[etree._Element]) -> Iterator[etree._Element]:
    """Yield nodes for as long as the map is wanted: a client may leave before its map is read."""
    for node in nodes:
        checkpoint()
        yield node


def _root(text: str | bytes) -> etree._Element:
    data = text.encode() if isinstance(text, str) else text
    refuse_beyond(data.count(b"<"), MOST_ELEMENTS, "elements")
    if isinstance(text, str):  # lxml must not be told twice which encoding it is
        data = re.sub(rb"^(\s*<\?xml[^>]*?)\s+encoding\s*=\s*(\"[^\"]*\"|'[^']*')", rb"\1", data, count=1)
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        huge_tree=False,
        load_dtd=False,
        strip_cdata=False,
        remove_comments=True,
    )
    try:
        root = etree.fromstring(data.lstrip(), parser)
    except etree.XMLSyntaxError as error:
        raise MapError(f"this is no well-formed XML: {error.msg}", error.lineno) from None
    if cast("Any", root.getroottree()).docinfo.doctype:  # the stubs do not know the attribute
        raise MapError("the text has a DOCTYPE; an OpenDRIVE map needs none, and it is not read for safety", 1)
    if root.tag != "OpenDRIVE":
        raise MapError(f"the outermost element is <{root.tag}>, not <OpenDRIVE>", line_of(root))
    return root


def _geo_reference(root: etree._Element) -> str:
    """Return the text as LibCarla's XML reader sees it: blanks before a CDATA block are dropped, others are kept."""
    node = root.find("header/geoReference")
    if node is None:
        return ""
    inner = etree.tostring(node, encoding="unicode", with_tail=False).partition(">")[2]
    block = _CDATA.match(inner)
    return block.group(1) if block else (node.text or "")


def _refuse_repeated(kind: str, ids: list[tuple[int, int]]) -> None:
    seen: dict[int, int] = {}
    for element_id, line in ids:
        if element_id in seen:
            raise MapError(f"{kind} {element_id} stands twice, first in line {seen[element_id]}", line)
        seen[element_id] = line
