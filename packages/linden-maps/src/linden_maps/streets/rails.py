"""Railroads as objects: the bed as one strip for each line, and where it crosses a road, the crossing.

OpenDRIVE 1.4 has no railroads but those of trams on roads, so they are objects of the types ``railroad`` and
``railroadCrossing``. No train runs on them.
"""

from collections.abc import Iterator

from shapely import LineString, MultiLineString, Polygon

from linden_maps.streets.cross_section import view
from linden_maps.streets.curves import Path, Pose, length, moved, pose_at, sampled, seen_from
from linden_maps.streets.document import Object
from linden_maps.streets.network import Network
from linden_maps.streets.street_facts import Facts, Railroad

BED_HALF_M = 2.6  # as wide as the scenery's bed of gravel; a single track, estimated


def rails(facts: Facts, network: Network) -> tuple[tuple[int, Object], ...]:
    """Return the objects (numbered 0) with the edge that each belongs to: every line, and every crossing of a road."""
    roads = [(edge, LineString([pose[:2] for pose in sampled(road, 1.0)])) for edge, road in _roads(network)]
    found: list[tuple[int, Object]] = []
    for railroad in facts.railroads:
        line = LineString(railroad.points)
        bed = line.buffer(BED_HALF_M, cap_style="flat", join_style="mitre")
        nearest = min(roads, key=lambda one: (line.interpolate(0.5, normalized=True).distance(one[1]), one[0]))
        found.append(_object(network, nearest, bed, ("", railroad)))
        for edge in network.edges:
            street = LineString(edge.points)  # from node to node: the crossing may lie in a junction
            kerbs = view(edge.section, along=True)
            half_m = max(abs(kerbs.kerb_m(right=side)) for side in (False, True))
            ground = bed.intersection(street.buffer(half_m, cap_style="flat"))
            goes_on = isinstance(street.difference(bed), MultiLineString)  # a street that ends at the track has none
            if goes_on and isinstance(ground, Polygon):
                beside = min(roads, key=lambda one: (ground.distance(one[1]), one[0]))
                found.append(_object(network, beside, ground, (edge.street.name, railroad)))
    return tuple(found)


def _roads(network: Network) -> Iterator[tuple[int, Path]]:
    return ((edge, road) for edge, road in enumerate(network.roads) if road is not None)


def _object(
    network: Network, at: tuple[int, LineString], ground: Polygon, what: tuple[str, Railroad]
) -> tuple[int, Object]:
    """Return an object over a piece of ground, its outline in the frame of a road; a crossing has its street's name."""
    edge, line = at
    road = network.roads[edge]
    assert road is not None, "the search is among the roads that are there"
    simple = ground.simplify(0.05)
    assert isinstance(simple, Polygon), "a polygon stays one"
    middle = simple.representative_point()
    s_m = round(min(float(line.project(middle)), length(road) - 0.01), 3)
    beside = pose_at(road, s_m)
    t_m = round(seen_from(beside, (middle.x, middle.y))[1], 3)
    origin: Pose = moved(beside, left_m=t_m)
    corners = [(x, y) for x, y in simple.exterior.coords]
    if not simple.exterior.is_ccw:
        corners.reverse()
    outline = tuple((round(u, 3), round(v, 3)) for u, v in (seen_from(origin, corner) for corner in corners))
    street, railroad = what
    name, kind = (f"Railroad, {street}", "railroadCrossing") if street else ("Railroad", "railroad")
    return edge, Object(0, name, kind, s_m, t_m, 0.0, outline, railroad.confidence)
