"""Railroads as objects: the bed as one strip for each line, and where it crosses a road, the crossing.

OpenDRIVE 1.4 has no railroads but those of trams on roads, so they are objects of the types ``railroad`` and
``railroadCrossing``. No train runs on them.
"""

from collections.abc import Iterator

from shapely import LineString, Polygon

from linden.authoring.streets.cross_section import view
from linden.authoring.streets.curves import Path, Pose, length, moved, pose_at, sampled, seen_from
from linden.authoring.streets.document import Object
from linden.authoring.streets.network import Network
from linden.authoring.streets.street_facts import Facts, Railroad

BED_HALF_M = 2.6  # as wide as the scenery's bed of gravel; a single track, estimated


def rails(facts: Facts, network: Network) -> tuple[tuple[int, Object], ...]:
    """Return the objects (numbered 0) with the edge that each belongs to: every line, and every crossing of a road."""
    roads = [(edge, LineString([pose[:2] for pose in sampled(road, 1.0)])) for edge, road in _roads(network)]
    found: list[tuple[int, Object]] = []
    for railroad in facts.railroads:
        line = LineString(railroad.points)
        bed = line.buffer(BED_HALF_M, cap_style="flat", join_style="mitre")
        nearest = min(roads, key=lambda one: (line.interpolate(0.5, normalized=True).distance(one[1]), one[0]))
        found.append(_object(network, nearest, bed, ("railroad", railroad)))
        for edge, road in roads:
            kerbs = view(network.edges[edge].section, along=True)
            half_m = max(abs(kerbs.kerb_m(right=side)) for side in (False, True))
            ground = bed.intersection(road.buffer(half_m, cap_style="flat"))
            if isinstance(ground, Polygon) and not ground.is_empty and line.intersects(road):
                found.append(_object(network, (edge, road), ground, ("railroadCrossing", railroad)))
    return tuple(found)


def _roads(network: Network) -> Iterator[tuple[int, Path]]:
    return ((edge, road) for edge, road in enumerate(network.roads) if road is not None)


def _object(
    network: Network, at: tuple[int, LineString], ground: Polygon, kind: tuple[str, Railroad]
) -> tuple[int, Object]:
    """Return an object over a piece of ground, its outline in the frame of the road there."""
    edge, line = at
    road = network.roads[edge]
    assert road is not None, "only roads that are there are asked"
    simple = ground.simplify(0.05)
    middle = simple.representative_point()
    s_m = round(min(float(line.project(middle)), length(road)), 3)
    beside = pose_at(road, s_m)
    t_m = round(seen_from(beside, (middle.x, middle.y))[1], 3)
    origin: Pose = moved(beside, left_m=t_m)
    corners = [(x, y) for x, y in simple.exterior.coords]
    if not simple.exterior.is_ccw:
        corners.reverse()
    outline = tuple((round(u, 3), round(v, 3)) for u, v in (seen_from(origin, corner) for corner in corners))
    name = "Railroad" if kind[0] == "railroad" else f"Railroad, {network.edges[edge].street.name}"
    return edge, Object(0, name, kind[0], s_m, t_m, 0.0, outline, kind[1].confidence)
