"""SUMO traffic control from OpenDRIVE's signs and lights: node types, edge priorities and light programs."""

from collections import defaultdict
from typing import NamedTuple

from lxml import etree

from linden.maps.opendrive.model import OpenDrive
from linden.maps.opendrive.roadside import STOP_SIGN_TYPE, YIELD_SIGN_TYPE
from linden.maps.records import AffectedLane, PlacedSignal
from linden_maps.sumo.net import Net, NetConnection

MINOR_PRIORITY, MAJOR_PRIORITY = 1, 3
"""Priorities of edges with and without a stop or yield sign. Without them netconvert stops 25 other approaches."""


class SumoSignals(NamedTuple):
    """The signals by the edge that they govern; ``lost`` are signals on no edge."""

    stops: dict[str, PlacedSignal]
    yields: dict[str, PlacedSignal]
    lights: dict[str, PlacedSignal]
    lost: tuple[PlacedSignal, ...]


def controls_of(net: Net, placed: tuple[PlacedSignal, ...], opendrive: OpenDrive) -> SumoSignals:
    """Find the edge of each stop sign, yield sign and light."""
    found = SumoSignals({}, {}, {}, ())
    lost = []
    for signal in placed:
        kind = {STOP_SIGN_TYPE: found.stops, YIELD_SIGN_TYPE: found.yields}.get(signal.type)
        if signal.is_light:
            kind = found.lights
        if kind is None:
            continue
        edges = _edges(net, signal, opendrive)
        kind.update(dict.fromkeys(edges, signal))
        if not edges:
            lost.append(signal)
    return found._replace(lost=tuple(lost))


def _edges(net: Net, signal: PlacedSignal, opendrive: OpenDrive) -> list[str]:
    """Return the edges made of a signal's lanes: of several, the edges into the junction that the signal controls."""
    found: dict[str, None] = {}
    for lane in signal.lanes:
        origin, junction = _approach(opendrive, lane, signal.junction_id)
        edges = {edge.id: edge for edge in net.edges_of_origin[origin] if edge.car_lanes}
        into = [edge.id for edge in edges.values() if edge.end == str(junction)]
        found.update(dict.fromkeys(into or (list(edges) if len(edges) == 1 else [])))
    return list(found)


def _approach(opendrive: OpenDrive, lane: AffectedLane, junction: int) -> tuple[str, int]:
    """Return the lane before the junction as "ROAD_LANE", and the junction.

    CARLA's towns put references to a light on the connecting roads; their approach is the road that those come from.
    """
    road = opendrive.road_by_id[lane.road_id]
    if not road.is_in_junction:
        return f"{lane.road_id}_{lane.lane_id}", junction
    along = (lane.lane_id < 0) == road.is_right_hand
    before = road.predecessor if along else road.successor
    own = road.sections[0 if along else -1].lane(lane.lane_id)
    linked = None if own is None else own.predecessor if along else own.successor
    if before is None or before.is_junction or linked is None:
        return f"{lane.road_id}_{lane.lane_id}", junction
    return f"{before.id}_{linked}", road.junction_id


def node_types(net: Net, controls: SumoSignals) -> dict[str, str]:
    """Return the type of each node with signs: ``allway_stop``, ``priority_stop`` or ``priority``.

    ``rightOfWay="edgePriority"`` would turn every stop into a yield, so only the node's type makes traffic stop.
    """
    types = {}
    for node, edges in net.incoming.items():
        if node in net.lights:
            continue
        stopped = [edge.id in controls.stops for edge in edges]
        if all(stopped) and len(stopped) > 1:
            types[node] = "allway_stop"
        elif any(stopped):
            types[node] = "priority_stop"
        elif any(edge.id in controls.yields for edge in edges):
            types[node] = "priority"
    return types


def node_patch(types: dict[str, str]) -> bytes:
    """Return the file of node types for netconvert."""
    root = etree.Element("nodes")
    for node, kind in types.items():
        etree.SubElement(root, "node", {"id": node, "type": kind})
    return etree.tostring(root, pretty_print=True)


def edge_patch(net: Net, controls: SumoSignals) -> bytes:
    """Return the file of edge priorities for netconvert."""
    root = etree.Element("edges")
    for edge in net.car_edges():
        minor = edge.id in controls.stops or edge.id in controls.yields
        etree.SubElement(root, "edge", {"id": edge.id, "priority": str(MINOR_PRIORITY if minor else MAJOR_PRIORITY)})
    return etree.tostring(root, pretty_print=True)


class _Links(NamedTuple):
    """The links of one light, by their index."""

    heads: dict[int, PlacedSignal]  # what governs each
    ways: dict[int, NetConnection]
    crossed: dict[int, tuple[str, ...]]  # the edges that a crossing leads over


def light_programs(
    net: Net, controls: SumoSignals, order: dict[str, int], times_s: tuple[float, float, float]
) -> dict[str, "etree._Element"]:
    """The server's own program for each light: one controller after the other is green, yellow, then all are red.

    Each link names the signal that governs it (``linkSignalID``), so that a client can pair it with the server's head.
    ``order`` ranks the controllers in the order of their turns. ``times_s`` are of red, yellow and green.
    """
    lights: dict[str, _Links] = defaultdict(lambda: _Links({}, {}, {}))
    for connection in net.connections:
        if connection.light is None:
            continue
        links = lights[connection.light]
        links.ways[connection.link] = connection
        if connection.end in net.crossed:
            links.crossed[connection.link] = net.crossed[connection.end]
        elif connection.start in controls.lights:
            links.heads[connection.link] = controls.lights[connection.start]
    return {light: _program(light, lights[light], order, times_s) for light in sorted(lights)}


def _program(light: str, links: _Links, order: dict[str, int], times_s: tuple[float, float, float]) -> "etree._Element":
    red_s, yellow_s, green_s = times_s
    root = etree.Element("tlLogic", {"id": light, "type": "static", "programID": "server", "offset": "0"})
    controllers = sorted({_controller(head) for head in links.heads.values()}, key=lambda name: order.get(name, 0))
    count = max(links.ways) + 1
    for controller in controllers:
        turn = {link for link, head in links.heads.items() if _controller(head) == controller}
        yellow = "".join("y" if link in turn else "r" for link in range(count))
        for duration_s, state in ((green_s, _green(links, turn, count)), (yellow_s, yellow), (red_s, "r" * count)):
            etree.SubElement(root, "phase", {"duration": f"{duration_s:g}", "state": state})
    for link, head in sorted(links.heads.items()):
        etree.SubElement(root, "param", {"key": f"linkSignalID:{link}", "value": head.signal_id})
    return root


def _green(links: _Links, turn: set[int], count: int) -> str:
    """Return the state while the links of ``turn`` are green.

    People cross the approaches that are red. Traffic that turns into such a street gives way (``g``), and so does
    traffic that turns left where two heads are green at once.
    """
    state = ["r"] * count
    approaches = {links.ways[link].start for link in turn}
    walked = {link: edges for link, edges in links.crossed.items() if approaches.isdisjoint(edges)}
    for link in walked:
        state[link] = "G"
    occupied = {edge for edges in walked.values() for edge in edges}
    several = len({links.heads[link].signal_id for link in turn}) > 1
    for link in turn:
        way = links.ways[link]
        gives_way = way.end in occupied or (several and way.direction in "lLt")
        state[link] = "g" if gives_way else "G"
    return "".join(state)


def _controller(signal: PlacedSignal) -> str:
    """Return the controller that switches a light; a light without one is alone."""
    return signal.controllers[0] if signal.controllers else f"light {signal.signal_id}"
