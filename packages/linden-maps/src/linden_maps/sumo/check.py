"""Compares a SUMO network with its OpenDRIVE map: lanes, lengths, speeds, controls, connections."""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import networkx as nx

from linden.maps.navigation.areas import crosswalk_outlines
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType
from linden_maps.sumo.net import Net
from linden_maps.sumo.network import ConvertedNetwork

LENGTH_SHARE = 0.02  # of the whole length that netconvert may cut off or add at joints of lanes
SPEED_MPS = 0.05  # SUMO writes two decimals
AT_JUNCTION_M = 20.0  # from a crosswalk to the end of a street; one farther away crosses within the street
CROSSWALK_M = 12.0  # from a crosswalk to its crossing: netconvert puts crossings to the edge of the junction
SHORT_M = 0.5  # netconvert drops shorter sections


class Compared(NamedTuple):
    """What was compared, in lines of a table, and what does not fit, a sentence each."""

    table: tuple[tuple[str, str, str], ...]  # what, in the map, in the network
    misfits: tuple[str, ...]


def compare(converted: ConvertedNetwork) -> Compared:
    """Compare the network with its map."""
    net, opendrive = converted.net, converted.opendrive
    lanes = {kind: list(_lanes(opendrive, kind)) for kind in (LaneType.DRIVING, LaneType.SIDEWALK)}
    car_km, walk_km = (sum(length_m for _, length_m, _ in lanes[kind]) / 1000.0 for kind in lanes)
    net_car_km = sum(lane.length_m for edge in net.edges.values() for lane in edge.car_lanes) / 1000.0
    net_walk_km = sum(lane.length_m for e in net.edges.values() for lane in e.lanes if lane.for_people) / 1000.0
    found, signs, parts = _found(converted), _signs(converted), _parts(net)
    people = _people(converted)
    table = (
        ("lanes for cars outside junctions, km", f"{car_km:.1f}", f"{net_car_km:.1f}"),
        ("pavements outside junctions, km", f"{walk_km:.1f}", f"{net_walk_km:.1f}"),
        *((name, str(wanted), str(kept)) for name, wanted, kept in signs),
        ("parts that cannot reach each other by car", "1", str(parts)),
        *people.table,
    )
    misfits = [
        *(f"lane {origin}: the network has no edge of it" for origin in found.missing),
        *found.speeds,
        *(f"{name}: {kept} of {wanted} are kept" for name, wanted, kept in signs if kept != wanted),
        *(
            f"signal {signal.signal_id} (type {signal.type}, road {signal.road_id}): it lies on no edge"
            for signal in converted.controls.lost
        ),
    ]
    for name, in_map, in_net in (("cars", car_km, net_car_km), ("people", walk_km, net_walk_km)):
        if in_map and abs(in_net / in_map - 1.0) > LENGTH_SHARE:
            misfits.append(f"lanes for {name}: {in_net:.1f} km in the network, {in_map:.1f} km in the map")
    if parts > 1:
        misfits.append(f"the network falls into {parts} parts that cannot reach each other by car")
    return Compared(table, (*misfits, *people.misfits))


def _people(converted: ConvertedNetwork) -> Compared:
    """Compare what people walk on: crosswalks with crossings, and whether the pavements hang together.

    A network without crossings was made for cars alone.
    """
    net = converted.net
    outlines = [outline_m for _, outline_m in crosswalk_outlines(converted.opendrive)]
    middles = [(sum(x for x, _ in each) / len(each), sum(y for _, y in each) / len(each)) for each in outlines]
    places = [(x_m + net.offset_m[0], y_m + net.offset_m[1]) for x_m, y_m in middles]
    marked = [place for place in places if _nearest_m(place, net.ends) < AT_JUNCTION_M]
    crossed, parts = sum(_nearest_m(place, net.crossing_middles) < CROSSWALK_M for place in marked), walkable(net)
    table = (
        ("crosswalks at junctions", str(len(marked)), str(crossed)),
        ("crosswalks within streets: SUMO has none", str(len(places) - len(marked)), "0"),
        ("crossings in all", "", str(len(net.crossed))),
        ("parts that cannot reach each other on foot", "1" if parts else "0", str(parts)),
    )
    misfits = []
    if parts > 1 and net.crossed:
        misfits.append(f"the pavements fall into {parts} parts that cannot reach each other on foot")
    if crossed < len(marked) and net.crossed:
        without = f"{len(marked) - crossed} of {len(marked)} at junctions"
        misfits.append(f"crosswalks: {without} have no crossing within {CROSSWALK_M:g} m")
    return Compared(table, tuple(misfits))


class _Found(NamedTuple):
    missing: list[str]
    speeds: list[str]


def _found(converted: ConvertedNetwork) -> _Found:
    """Return the lanes of the map that the network lacks, and the lanes with other speeds."""
    net, missing, speeds = converted.net, [], []
    for origin, length_m, limit_mps in _lanes(converted.opendrive, LaneType.DRIVING):
        edges = net.edges_of_origin.get(origin, [])
        if not edges and length_m > SHORT_M:
            missing.append(origin)
        for edge in edges:
            lane = next(lane for lane in edge.lanes if origin in lane.origins)
            if limit_mps is not None and lane.origins == (origin,) and abs(lane.speed_mps - limit_mps) > SPEED_MPS:
                speeds.append(f"lane {origin}: {lane.speed_mps:.2f} m/s in the network, {limit_mps:.2f} in the map")
    return _Found(missing, list(dict.fromkeys(speeds)))


def _lanes(opendrive: OpenDrive, kind: LaneType) -> Iterator[tuple[str, float, float | None]]:
    """Yield the lanes of a kind outside junctions, a section each: "ROAD_LANE", length along the road, limit."""
    for road in opendrive.roads:
        if road.is_in_junction:
            continue
        for section in road.sections:
            for lane in section.lanes:
                if lane.type is kind and lane.id != 0:
                    posted = [each.limit_mps for each in lane.speeds] or [
                        each.limit_mps for each in road.types if each.has_speed and each.s_m <= section.s_m
                    ][-1:]
                    limit = posted[0] if len(set(posted)) == 1 else None
                    yield f"{road.id}_{lane.id}", section.end_m - section.s_m, limit


def _signs(converted: ConvertedNetwork) -> list[tuple[str, int, int]]:
    """Return what the map's signs and lights come to: name, number in the map, number with links that act as signed.

    A link's state is ``s`` or ``w`` at a stop, ``m`` where it yields, ``o`` or ``O`` at a light.
    """
    controls, net = converted.controls, converted.net
    states: dict[str, set[str]] = {}
    for connection in net.connections:
        edge = net.edges.get(connection.start)
        if edge is not None and edge.lanes[connection.start_lane].for_cars:
            states.setdefault(connection.start, set()).add(connection.state)
    rows = []
    kinds = (
        ("stop signs", controls.stops, "sw"),
        ("yield signs", controls.yields, "m"),
        ("lights", controls.lights, "oO"),
    )
    for name, signals, wanted in kinds:
        ids = {signal.signal_id for signal in signals.values()}
        kept = {signal.signal_id for edge, signal in signals.items() if states.get(edge, set()) & set(wanted)}
        lost = sum(_is_of(name, signal.type, is_light=signal.is_light) for signal in controls.lost)
        rows.append((name, len(ids) + lost, len(kept)))
    return rows


def _is_of(name: str, kind: str, *, is_light: bool) -> bool:
    return is_light if name == "lights" else {"stop signs": "206", "yield signs": "205"}[name] == kind


def _nearest_m(place_m: tuple[float, float], others_m: Iterable[tuple[float, ...]]) -> float:
    """Return how far the nearest of other places lies."""
    return min((math.dist(place_m, other_m) for other_m in others_m), default=math.inf)


def walkable(net: Net) -> int:
    """Return how many groups of pavements there are within which people reach every other."""
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(edge.id for edge in net.edges.values() if edge.pavements)
    for connection in net.connections:
        ends = ((connection.start, connection.start_lane), (connection.end, connection.end_lane))
        if all(_is_for_people(net, edge, lane) for edge, lane in ends):
            graph.add_edge(connection.start, connection.end)
    return nx.number_connected_components(graph)


def _is_for_people(net: Net, edge: str, lane: int) -> bool:
    if edge.startswith(":"):  # an edge within a junction: walking areas end with w and a number, crossings with c
        return edge.rpartition("_")[2][:1] in ("w", "c")
    return net.edges[edge].lanes[lane].for_people


def _parts(net: Net) -> int:
    """Return how many groups of edges there are within which every edge reaches every other by car."""
    graph: nx.DiGraph[str] = nx.DiGraph()
    graph.add_nodes_from(edge.id for edge in net.car_edges())
    for connection in net.connections:
        if connection.start in graph and connection.end in graph:
            start, end = net.edges[connection.start], net.edges[connection.end]
            if start.lanes[connection.start_lane].for_cars and end.lanes[connection.end_lane].for_cars:
                graph.add_edge(connection.start, connection.end)
    return nx.number_strongly_connected_components(graph)
