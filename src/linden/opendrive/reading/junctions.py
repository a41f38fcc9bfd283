"""Reads <junction>: connections, lane links, controllers and priorities."""

from lxml.etree import _Element as Element

from linden.opendrive.model import Connection, Junction
from linden.opendrive.reading.attributes import line_of, reject, user_data, whole


def read_junction(node: Element) -> Junction:
    """Return one junction."""
    junction_id = whole(node, "id")
    if junction_id < 0:
        reject(node, "id", "0 or more")
    return Junction(
        id=junction_id,
        name=node.get("name", ""),
        connections=tuple(
            _connection(child) for child in node.iterchildren("connection") if child.get("connectingRoad") is not None
        ),
        controllers=tuple(child.get("id", "") for child in node.iterchildren("controller")),
        priorities=tuple((whole(child, "high"), whole(child, "low")) for child in node.iterchildren("priority")),
        user_data=user_data(node),
        source_line=line_of(node),
    )


def _connection(node: Element) -> Connection:
    return Connection(
        id=node.get("id", ""),
        incoming_road=whole(node, "incomingRoad"),
        connecting_road=whole(node, "connectingRoad"),
        contact=node.get("contactPoint"),
        lane_links=tuple((whole(link, "from"), whole(link, "to")) for link in node.iterchildren("laneLink")),
    )
