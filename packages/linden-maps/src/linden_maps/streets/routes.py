"""Routes over a built map: from a line along streets to the lanes driven, and to ScenarioRunner's route file.

A route feature's points are points of streets. Its roads, turns and lanes are looked up in the built map, so the
positions lie in lane centres. Everything given out is in CARLA's frame.
"""

import itertools
import math
from typing import NamedTuple

from lxml import etree

from linden.errors import UserError
from linden.geometry import from_opendrive
from linden.protocol.values.space import Transform
from linden_maps.streets.build import Built
from linden_maps.streets.cross_section import view
from linden_maps.streets.curves import Pose, length, moved, pose_at, turned_back, wrapped
from linden_maps.streets.document import RoadRecord, value
from linden_maps.streets.network import End, nearest_road
from linden_maps.streets.street_facts import Route, Stop

STEP_M = 1.0  # between the samples of a lane's centre
SPACING_M = 40.0  # between positions on a road; each turn gives one more just after it
OPEN_END_M = 10.0  # an open route begins and ends this far from the junctions at its ends


class Sample(NamedTuple):
    """A point of the route: a lane's centre in OpenDRIVE's frame, its height, and the distance driven so far."""

    pose: Pose
    z_m: float
    driven_m: float
    road: int
    in_junction: bool


class ReachedStop(NamedTuple):
    """A shuttle stop as the route reaches it."""

    stop: Stop
    at: Sample


class DrivenRoute(NamedTuple):
    """A route lane by lane."""

    samples: tuple[Sample, ...]
    stops: tuple[ReachedStop, ...]

    @property
    def length_m(self) -> float:
        """Length driven along lane centres."""
        return self.samples[-1].driven_m - self.samples[0].driven_m


class _Strand(NamedTuple):
    """A stretch of one lane: the road, the lane, from and to along the road (falling where driven against it)."""

    record: RoadRecord
    lane: int
    from_m: float
    to_m: float


def drive(built: Built, route: Route) -> DrivenRoute:
    """Return the lanes of a route. A closed route begins and ends at its first stop.

    Raises:
        UserError: the route leaves the streets, turns where turning is not allowed, or misses a stop.
    """
    samples = _samples(_strands(built, route, _edges(built, route)))
    known = {stop.id: stop for stop in built.facts.stops}
    missing = [stop_id for stop_id in route.stops if stop_id not in known]
    if missing:
        raise UserError(f"route {route.id}: no shuttle stop has the id {missing[0]!r}")
    wanted = [known[stop_id] for stop_id in route.stops]
    if route.closed and wanted:
        first = _called(built, samples, wanted[0]).at
        samples = _from(samples, samples.index(first))
    elif not route.closed:
        last_m = samples[-1].driven_m - OPEN_END_M
        samples = tuple(sample for sample in samples if OPEN_END_M <= sample.driven_m <= last_m)
    return DrivenRoute(samples, tuple(_called(built, samples, stop) for stop in wanted))


def xml(built: Built, route: Route, number: int) -> bytes:
    """Return the route as a ScenarioRunner route file with one route, and its shuttle stops."""
    driven = drive(built, route)
    root = etree.Element("routes")
    element = etree.SubElement(root, "route", id=str(number), town=built.facts.name, name=route.id)
    if route.timetable:
        element.set("timetable", route.timetable)
    waypoints = etree.SubElement(element, "waypoints")
    for sample in positions(driven):
        at = _in_carla(sample).location
        etree.SubElement(waypoints, "position", x=_fixed(at.x), y=_fixed(at.y), z=_fixed(at.z))
    etree.SubElement(element, "scenarios")
    stops = etree.SubElement(element, "stops")
    for called in driven.stops:
        at, turn = _in_carla(called.at)
        etree.SubElement(
            stops,
            "stop",
            id=called.stop.id,
            name=called.stop.name,
            x=_fixed(at.x),
            y=_fixed(at.y),
            z=_fixed(at.z),
            yaw=_fixed(turn.yaw),
            confidence=called.stop.confidence,
        )
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)


def positions(driven: DrivenRoute) -> list[Sample]:
    """Return the samples that make the route unambiguous.

    They lie on roads outside junctions, where no two lanes overlap: just after a road's start, every ``SPACING_M`` and
    just before its end; and at the route's own ends.
    """
    found = [driven.samples[0]]
    for (_, in_junction), group in itertools.groupby(
        driven.samples, key=lambda sample: (sample.road, sample.in_junction)
    ):
        stretch = list(group)
        if in_junction or len(stretch) < 4:
            continue
        inner = stretch[2:-2] or [stretch[len(stretch) // 2]]
        steps = max(1, math.ceil((inner[-1].driven_m - inner[0].driven_m) / SPACING_M))
        found += [inner[(len(inner) - 1) * i // steps] for i in range(steps + 1)]
    found.append(driven.samples[-1])
    spaced = [found[0]]
    for sample in found[1:]:
        if sample.driven_m - spaced[-1].driven_m > 1.5:
            spaced.append(sample)
    return spaced


def _edges(built: Built, route: Route) -> list[tuple[int, bool]]:
    """Return the edges of a route's line with the way each is driven; edges inside a junction are left out."""
    nodes = {node.point for node in built.network.nodes}
    by_points = {}
    for number, edge in enumerate(built.network.edges):
        by_points[edge.points] = (number, True)
        by_points[edge.points[::-1]] = (number, False)
    cuts = [i for i, point in enumerate(route.points) if point in nodes]
    if len(cuts) < 2 or cuts[0] != 0 or cuts[-1] != len(route.points) - 1:
        raise UserError(f"route {route.id}: it must begin and end where streets meet, at the very point")
    found = []
    for a, b in itertools.pairwise(cuts):
        part = route.points[a : b + 1]
        if part not in by_points:
            raise UserError(f"route {route.id}: no street runs through its points {a + 1} to {b + 1}")
        found.append(by_points[part])
    return [(edge, forward) for edge, forward in found if built.roads[edge] is not None]


def _strands(built: Built, route: Route, edges: list[tuple[int, bool]]) -> list[_Strand]:
    """Return the lanes of a route in order, turns and bends between the roads included."""
    lane = view(built.network.edges[edges[0][0]].section, along=edges[0][1]).driving(right=True)[-1]
    found = []
    for (edge, forward), onward in itertools.zip_longest(edges, [*edges[1:], edges[0]] if route.closed else edges[1:]):
        record = built.roads[edge]
        assert record is not None, "edges inside junctions are left out"
        total_m = length(record.path)
        found.append(_Strand(record, lane, 0.0, total_m) if forward else _Strand(record, lane, total_m, 0.0))
        if onward is not None:
            link, lane = _link(built, route, (End(edge, forward), lane), End(onward[0], not onward[1]))
            found.append(link)
    return found


def _link(built: Built, route: Route, come: tuple[End, int], go: End) -> tuple[_Strand, int]:
    """Return the connecting road or bend from a lane's end to another road's end, and the lane it leads to."""
    end, lane = come
    for way in built.ways:
        total_m = length(way.record.path)
        if (way.come, way.go) == (end, go):
            for one in way.record.right:
                if one.kind == "driving" and one.predecessor == lane and one.successor is not None:
                    return _Strand(way.record, one.id, 0.0, total_m), one.successor
        if (way.come, way.go) == (go, end):
            for one in way.record.left:
                if one.kind == "driving" and one.successor == lane and one.predecessor is not None:
                    return _Strand(way.record, one.id, total_m, 0.0), one.predecessor
    street, after = built.network.edges[end.edge].street, built.network.edges[go.edge].street
    raise UserError(
        f"route {route.id}: turning from {street.name} into {after.name} is not allowed; choose another street"
    )


def _samples(strands: list[_Strand]) -> tuple[Sample, ...]:
    """Return the lane centres of the strands about every ``STEP_M``."""
    found: list[Sample] = []
    for strand in strands:
        steps = max(1, math.ceil(abs(strand.to_m - strand.from_m) / STEP_M))
        for i in range(steps + 1):
            pose, z_m = _centre(strand, strand.from_m + (strand.to_m - strand.from_m) * i / steps)
            step_m = math.dist(pose[:2], found[-1].pose[:2]) if found else 0.0
            if found and step_m < 1e-3:
                continue
            driven_m = found[-1].driven_m + step_m if found else 0.0
            found.append(Sample(pose, z_m, driven_m, strand.record.id, strand.record.junction != -1))
    return tuple(found)


def _centre(strand: _Strand, s_m: float) -> tuple[Pose, float]:
    """Return the middle of a strand's lane, looking along the drive, and its height."""
    record = strand.record
    side = record.right if strand.lane < 0 else record.left
    inner_m = sum(value(lane.widths, s_m) for lane in side if abs(lane.id) < abs(strand.lane))
    width_m = next(value(lane.widths, s_m) for lane in side if lane.id == strand.lane)
    sign = -1 if strand.lane < 0 else 1
    pose = moved(pose_at(record.path, s_m), left_m=value(record.axis, s_m) + sign * (inner_m + width_m / 2))
    return pose if strand.to_m > strand.from_m else turned_back(pose), value(record.elevation, s_m)


def _called(built: Built, samples: tuple[Sample, ...], stop: Stop) -> ReachedStop:
    """Return where a route passes a stop in the stop's own direction."""
    edge, s_m = nearest_road(built.network, stop.street_id, stop.point)
    record = built.roads[edge]
    assert record is not None, "a stop's nearest road is one"
    at = pose_at(record.path, s_m)
    heading = at if stop.forward else turned_back(at)
    ours = [
        sample
        for sample in samples
        if sample.road == record.id and abs(wrapped(sample.pose.heading_rad - heading.heading_rad)) < math.pi / 2
    ]
    if not ours:
        raise UserError(f"stop {stop.id}: the route does not pass it in its direction; look at its `forward`")
    return ReachedStop(stop, min(ours, key=lambda sample: math.dist(sample.pose[:2], at[:2])))


def _from(samples: tuple[Sample, ...], first: int) -> tuple[Sample, ...]:
    """Return a closed drive begun at another of its samples, which also ends it."""
    before_m = samples[first].driven_m
    total_m = samples[-1].driven_m + math.dist(samples[-1].pose[:2], samples[0].pose[:2])
    ahead = [sample._replace(driven_m=sample.driven_m - before_m) for sample in samples[first:]]
    again = [sample._replace(driven_m=sample.driven_m - before_m + total_m) for sample in samples[1 : first + 1]]
    return (*ahead, *again)


def _in_carla(sample: Sample) -> Transform:
    return from_opendrive(sample.pose.x_m, sample.pose.y_m, sample.z_m, sample.pose.heading_rad)


def _fixed(value: float) -> str:
    return f"{value:.3f}"
