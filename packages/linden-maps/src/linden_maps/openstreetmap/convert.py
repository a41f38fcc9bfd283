"""An OpenStreetMap extract to street facts: the GeoJSON document that maps are built from, and what was guessed."""

from collections import Counter
from typing import Any, NamedTuple

from linden.errors import UserError
from linden_maps.openstreetmap import surroundings
from linden_maps.openstreetmap.controls import JunctionControls, controls_of
from linden_maps.openstreetmap.extract import Extract, OsmWay, read_extract
from linden_maps.openstreetmap.graph import Segment, SegmentGraph, graph_of, mirrored
from linden_maps.openstreetmap.tags import TAGGED, is_street, speed_limit, street_class, unbuilt_cycleways
from linden_maps.streets.street_facts import Control

LICENCE = "Map data from OpenStreetMap, open database licence (ODbL) 1.0, openstreetmap.org/copyright"


class Imported(NamedTuple):
    """Street facts of an extract, and what a user should know of them.

    ``known`` and ``guessed`` count the values of each fact that a tag says and that none says; ``left_out`` counts
    what the extract has and the facts have not.
    """

    streets: dict[str, Any]
    known: Counter[str]
    guessed: Counter[str]
    left_out: Counter[str]


def convert(data: bytes, name: str) -> Imported:
    """Return the street facts of an ``.osm`` file (docs/reference/maps.md); equal bytes give equal facts.

    Raises:
        UserError: the file is no extract, or holds no street; with the file and the line.
    """
    extract = read_extract(data, name)
    drivable = [way for way in extract.ways.values() if len(way.nodes) > 1 and is_street(way.tags)]
    if not drivable:
        raise UserError(
            f"{name} holds no street that cars may drive on (a way with a tag such as highway=residential); "
            "take a larger extract"
        )
    metric = _is_metric(drivable)
    graph, origin = graph_of(extract, metric=metric)
    controls = controls_of(extract, graph, metric=metric)
    features = [
        *(_street(segment, graph) for segment in graph.segments),
        *(_intersection(node, graph, controls) for node in controls.at),
        *(_spot("crossing", spot) for spot in surroundings.crossings(extract, graph)),
        *(_building(footprint) for footprint in surroundings.buildings(extract)),
        *(_spot("furniture", spot) for spot in surroundings.furniture(extract)),
    ]
    known, guessed = _counted(features)
    metadata = {
        "name": name.rpartition("/")[2].removesuffix(".osm"),
        "origin": list(origin),
        "turning_circles": True,
        "simplify_roundabouts": True,
    }
    document = {
        "type": "FeatureCollection",
        "metadata": {**metadata, "licence": LICENCE, "ground": {"confidence": "guessed: level"}},
        "features": features,
    }
    return Imported(document, known, guessed, _left_out(extract, graph, controls))


def _is_metric(ways: list[OsmWay]) -> bool:
    """Return whether most limits of an extract are in km/h; an extract without any lies in the US if it lies there."""
    limits = [way.tags["maxspeed"] for way in ways if speed_limit(way.tags.get("maxspeed", "")) is not None]
    return 2 * sum("mph" in limit for limit in limits) < len(limits) or not limits


def _street(segment: Segment, graph: SegmentGraph) -> dict[str, Any]:
    """Return the feature of a segment, seen so that the larger part of what lies on one side is on its right."""
    across, nodes = segment.across, segment.nodes
    if _is_better_mirrored(segment):
        across, nodes = mirrored(across), nodes[::-1]
    parked = sum(across.parking)
    sources = dict(across.sources)
    if parked == 1 and across.parking[0]:
        sources["parking_confidence"] = "guessed: tagged on the left, built on the right"
    if sum(across.sidewalk) == 1 and across.sidewalk[0]:
        sources["sidewalk_confidence"] = "guessed: tagged on the left, built on the right"
    return {
        "type": "Feature",
        "geometry": {"type": "LineString", "coordinates": [list(graph.degrees[node]) for node in nodes]},
        "properties": {
            "feature": "street",
            "id": segment.id,
            "name": across.name,
            "osm_ways": list(segment.ways),
            "street_class": across.street_class,
            "lanes": across.forward + across.backward,
            "lanes_forward": across.forward,
            "width_m": across.width_m,
            f"speed_limit_{across.speed.unit.replace('/', '')}": across.speed.value,
            "oneway": "no" if across.backward else "forward",
            "parking": "both" if parked else "none",
            "sidewalk": ("none", "one", "both")[sum(across.sidewalk)],
            **({"level": across.level} if across.level else {}),
            "cycle_lanes": ("none", "right", "both")[sum(across.cycling)],
            **sources,
        },
    }


def _is_better_mirrored(segment: Segment) -> bool:
    """Return whether the street has to be turned about: its traffic opposes its nodes, or its only sidewalk is left."""
    across = segment.across
    if not across.forward or not across.backward:
        return not across.forward
    for left, right in (across.cycling, across.sidewalk, across.parking):
        if left != right:
            return left
    return False


def _intersection(node: int, graph: SegmentGraph, controls: JunctionControls) -> dict[str, Any]:
    governed = controls.at[node]
    names = dict.fromkeys(segment.across.name for segment in graph.at(node))
    properties: dict[str, Any] = {
        "feature": "intersection",
        "id": f"n{node}" if node >= 0 else f"ring{-node}",
        "name": " & ".join(names),
        "control": governed.control.value,
        "confidence": TAGGED,
        "control_confidence": governed.source,
    }
    if governed.waiting and governed.control is not Control.ALL_WAY_STOP:
        properties["stop_controlled_streets"] = list(governed.waiting)
    return _point(graph.degrees[node], properties)


def _spot(feature: str, spot: surroundings.Spot) -> dict[str, Any]:
    properties = {"feature": feature, "id": spot.id, "kind": spot.kind, "name": spot.name, "confidence": TAGGED}
    if spot.street:
        properties["street_id"] = spot.street
    return _point(spot.place, properties)


def _point(place: tuple[float, float], properties: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "Feature",
        "geometry": {"type": "Point", "coordinates": list(place)},
        "properties": properties,
    }


def _building(footprint: surroundings.Footprint) -> dict[str, Any]:
    return {
        "type": "Feature",
        "geometry": {"type": "Polygon", "coordinates": [[list(corner) for corner in footprint.ring]]},
        "properties": {
            "feature": "building",
            "id": footprint.id,
            "name": footprint.name,
            "kind": footprint.kind,
            "height_m": footprint.height_m,
            "height_confidence": footprint.source,
        },
    }


def _counted(features: list[dict[str, Any]]) -> tuple[Counter[str], Counter[str]]:
    """Return for each fact how often a tag says it, and how often it is guessed."""
    known: Counter[str] = Counter()
    guessed: Counter[str] = Counter()
    for feature in features:
        properties = feature["properties"]
        for key, source in properties.items():
            if key.endswith("_confidence"):
                fact = f"{properties['feature']} {key.removesuffix('_confidence').replace('_', ' ')}"
                (known if source == TAGGED else guessed)[fact] += 1
    return known, guessed


def _left_out(extract: Extract, graph: SegmentGraph, controls: JunctionControls) -> Counter[str]:
    """Return what the extract has and the facts have not."""
    found: Counter[str] = Counter()
    for way in extract.ways.values():
        if "highway" in way.tags and not is_street(way.tags):
            cars = street_class(way.tags) is not None
            kind = f"ways of highway={way.tags['highway']}, for other than cars"
            found["driveways, parking aisles, private roads" if cars else kind] += 1
        elif "highway" in way.tags:
            found["cycle lanes or tracks beside streets, against traffic or apart"] += unbuilt_cycleways(way.tags)
    for kind, count in controls.unplaced.items():
        found[f"{kind.replace('_', ' ')} nodes without a junction near them"] += count
    found["pieces of street that are mapped twice"] = graph.repeated
    if extract.dangling:
        found["references to nodes outside of the extract"] += extract.dangling
    return found
