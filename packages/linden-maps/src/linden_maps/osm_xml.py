"""The XML of OpenStreetMap, which extracts and Lanelet2 maps have in common: the checked root, and tags."""

from typing import Any

from lxml import etree

from linden.errors import UserError


def osm_root(data: bytes, name: str, *, kind: str, most_bytes: int, too_large: str, huge: bool = False) -> Any:  # noqa: ANN401 - an element of lxml
    """Return the outermost element of an ``.osm`` file.

    ``kind`` is what the file should be, and ``too_large`` the sentence about more than ``most_bytes``. ``huge`` lifts
    the parser's own limits.

    Raises:
        UserError: the file is empty or too large, or its text is no OSM XML; with the file and the line.
    """
    if not data.strip():
        raise UserError(f"{name}, line 1: the file is empty; name {kind} (.osm)")
    if len(data) > most_bytes:
        raise UserError(too_large)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=huge, load_dtd=False)
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        raise UserError(f"{name}, line {error.lineno}: this is no well-formed XML: {error.msg}") from None
    if root.tag != "osm":
        raise UserError(f"{name}, line {root.sourceline}: the outermost element is <{root.tag}>, not <osm>")
    return root


def tags_of(element: Any) -> dict[str, str]:  # noqa: ANN401 - an element of lxml
    """Return the tags of a node, way or relation."""
    return {tag.get("k", ""): tag.get("v", "") for tag in element.iterchildren("tag")}
