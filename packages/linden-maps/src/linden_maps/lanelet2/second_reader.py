"""A Lanelet2 map as Lanelet2's own library reads it: load errors, and which lanelets lead into which.

The library is the wheel ``lanelet2``. It knows Lanelet2's own regulatory elements and refuses Autoware's, with every
lanelet that refers to them; so a copy without those is read.
"""

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from linden.errors import UserError
from linden_maps.lanelet2.model import LaneletMap, Relation
from linden_maps.lanelet2.osm import osm_bytes
from linden_maps.lanelet2.projection import NOWHERE, projection_of

KNOWN_ELEMENTS = frozenset({"traffic_light", "traffic_sign", "speed_limit", "right_of_way", "all_way_stop"})
_LOCATION = "de"  # the only one with traffic rules in the library; they are those of the tags, not of a country


class Routes(NamedTuple):
    """What Lanelet2's library made of a map."""

    errors: tuple[str, ...]
    lanelets: int
    passable: frozenset[int]  # lanelets that a vehicle may use
    following: frozenset[tuple[int, int]]
    lane_changes: frozenset[tuple[int, int]]
    complaints: tuple[str, ...]  # of the routing graph


def routes_of(lanelet_map: LaneletMap) -> Routes:
    """Return what Lanelet2's library makes of a map.

    Raises:
        UserError: the library is not installed.
    """
    try:
        import lanelet2  # noqa: PLC0415 - an optional part
        from lanelet2 import io, projection, routing, traffic_rules  # noqa: PLC0415 - see above
    except ModuleNotFoundError:
        raise UserError(
            "reading a map back needs the package lanelet2; install it with: pip install 'linden-maps[autoware]'"
        ) from None
    origin = projection_of(lanelet_map.geo_reference) or NOWHERE
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "map.osm"
        path.write_bytes(osm_bytes(without_autoware(lanelet_map)))
        projector = projection.LocalCartesianProjector(io.Origin(origin.latitude_deg, origin.longitude_deg, 0.0))
        loaded, errors = io.loadRobust(str(path), projector)
    rules = traffic_rules.create(_LOCATION, lanelet2.traffic_rules.Participants.Vehicle)
    graph = routing.RoutingGraph(loaded, rules)
    passable: set[int] = set()
    following: set[tuple[int, int]] = set()
    changes: set[tuple[int, int]] = set()
    for lanelet in loaded.laneletLayer:
        if not rules.canPass(lanelet):
            continue
        passable.add(lanelet.id)
        following.update((lanelet.id, after.id) for after in graph.following(lanelet))
        changes.update((lanelet.id, side.id) for side in (graph.left(lanelet), graph.right(lanelet)) if side)
    return Routes(
        tuple(errors),
        len(loaded.laneletLayer),
        frozenset(passable),
        frozenset(following),
        frozenset(changes),
        _complaints(graph),
    )


def _complaints(graph: Any) -> tuple[str, ...]:  # noqa: ANN401 - the stubs of this library are wrong
    """Return what the routing graph finds wrong with itself."""
    return tuple(graph.checkValidity(False) or ())


def without_autoware(lanelet_map: LaneletMap) -> LaneletMap:
    """Return a copy without the regulatory elements that only Autoware knows."""
    elements = lanelet_map.elements()
    dropped = {number for number, relation in elements if relation.tags.get("subtype") not in KNOWN_ELEMENTS}
    kept = {
        number: Relation(tuple(member for member in relation.members if member.ref not in dropped), relation.tags)
        for number, relation in lanelet_map.relations.items()
        if number not in dropped
    }
    return replace(lanelet_map, relations=kept)
